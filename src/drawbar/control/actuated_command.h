/* The command of a body whose steering is a state that a rate moves. Included after struct component. */
#ifndef DRAWBAR_ACTUATED_COMMAND_H
#define DRAWBAR_ACTUATED_COMMAND_H

static double body_command(struct component *component)
{
    double *z = component->rti.z;
    return actuator_follow(&component->actuator, STATE(z, 0)[X_STEERING], &INPUT(z, 0)[U_STEERING_RATE]);
}

static double body_hold(const struct component *component, double steering)
{
    return actuator_hold(&component->actuator, steering);
}

#endif

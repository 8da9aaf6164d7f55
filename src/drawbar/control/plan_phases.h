/* Plan phases: preparation, skipped samples and actuation of every controller that plans; the same for one body and for both.
 *
 * Included at the end of subsystem_phases.h and centralised_phases.h, which define PLANNER, the member of struct component
 * with `iteration` and `predicts`, and repeat_plan.
 */
#ifndef DRAWBAR_PLAN_PHASES_H
#define DRAWBAR_PLAN_PHASES_H

/* Prepare the next sample's problem. */
int UNIT(ready)(struct component *component)
{
    return iteration_ready(&component->PLANNER.iteration, &component->rti);
}

/* Skip samples that were left out: the plan goes on, but the state that its model reaches is unknown. */
COLD int UNIT(skip)(struct component *component, int samples)
{
    component->PLANNER.predicts = 0;
    for (int i = 0; i < samples; ++i)
        repeat_plan(&component->PLANNER);
    for (int i = 1; i < samples; ++i)
        rti_shift(&component->rti);
    return UNIT(ready)(component);
}

/* Plan with what is known of the actuators. */
int UNIT(actuation)(struct component *component, const struct drawbar_actuation *known)
{
    allow_rates(component, known);
    return 0;
}

#endif

/* Tricycle phases: what both bodies of the paper's controllers make of a plan; the steering itself is the input.
 * Included after struct component and fill, in the place of subsystem_phases.h. */
#ifndef DRAWBAR_TRICYCLE_PHASES_H
#define DRAWBAR_TRICYCLE_PHASES_H

static double body_command(struct component *component)
{
    return INPUT(component->rti.z, 0)[U_STEERING];
}

static double body_hold(const struct component *component, double steering)
{
    (void)component;
    return steering;
}

static void body_plan(struct component *component)
{
    pose_plan(&component->subsystem, &component->rti);
}

/* The steering itself is the input: no rate is bounded. */
static void allow_rates(struct component *component, const struct drawbar_actuation *known)
{
    (void)component, (void)known;
}

#include "subsystem_phases.h"

#endif

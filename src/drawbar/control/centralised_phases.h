/* The phases of a centralised controller, around those of its solver; see centralised.h. */
#ifndef DRAWBAR_CENTRALISED_PHASES_H
#define DRAWBAR_CENTRALISED_PHASES_H

#include "centralised.h"

/* Take in the estimate and both bodies' references. */
static void take_in(struct component *component, const struct drawbar_estimate *estimate,
                    const struct drawbar_body_reference *tractor_reference,
                    const struct drawbar_body_reference *trailer_reference)
{
    struct centralised *both = &component->centralised;
    double *estimated = component->rti.initial;

    vehicle_state(estimate, estimated);
    vehicle_deviation(both, estimated, both->foretells ? both->predicted : estimated, tractor_reference,
                      trailer_reference);
    fill(component, estimate, tractor_reference, trailer_reference);
    iteration_enter(&both->iteration, &component->rti);
}

/* Go on along the last plans that were solved: what they planned for the next sample is now; their ends are repeated. */
static void live_on(struct centralised *both)
{
    memmove(both->tractor_poses[0], both->tractor_poses[1], N * sizeof both->tractor_poses[0]);
    memmove(both->trailer_poses[0], both->trailer_poses[1], N * sizeof both->trailer_poses[0]);
    memmove(&both->tractor_steerings[0], &both->tractor_steerings[1], (N - 1) * sizeof both->tractor_steerings[0]);
    memmove(&both->trailer_steerings[0], &both->trailer_steerings[1], (N - 1) * sizeof both->trailer_steerings[0]);
    memset(both->tractor_deviation, 0, sizeof both->tractor_deviation);
    memset(both->trailer_deviation, 0, sizeof both->trailer_deviation);
}

/* Both bodies' plans, of one solution and with one status; where the solver failed, the last ones that were solved. */
int UNIT(feedback)(struct component *component, const struct drawbar_estimate *estimate,
                   const struct drawbar_body_reference *tractor_reference,
                   const struct drawbar_body_reference *trailer_reference, struct drawbar_body_plan *tractor,
                   struct drawbar_body_plan *trailer, struct lent *lent)
{
    struct centralised *both = &component->centralised;
    double commands[2];

    take_in(component, estimate, tractor_reference, trailer_reference);
    WATCHED(WATCHED_FEEDBACK, rti_feedback(&component->rti, lent));
    const int status = iteration_leave(&both->iteration, &component->rti);
    both->foretells = status == SOLVED;
    both->solved |= both->foretells;
    if (both->foretells || !both->solved) {
        vehicle_command(component, commands);
        if (both->foretells)
            memcpy(both->predicted, iteration_successor(&component->rti), sizeof both->predicted);
        vehicle_plan(component);
    } else {
        live_on(both);
        vehicle_hold(component, both->tractor_steerings[0], both->trailer_steerings[0], commands);
    }
    *tractor = (struct drawbar_body_plan){
        .steering = commands[0], .poses = (const double (*)[3])both->tractor_poses,
        .steerings = both->tractor_steerings, .deviation = both->tractor_deviation,
        .status = status, .deviations = TRACTOR_DEVIATIONS
    };
    *trailer = (struct drawbar_body_plan){
        .steering = commands[1], .poses = (const double (*)[3])both->trailer_poses,
        .steerings = both->trailer_steerings, .deviation = both->trailer_deviation,
        .status = status, .deviations = TRAILER_DEVIATIONS
    };
    return status;
}

/* Make the next sample's problem. */
int UNIT(ready)(struct component *component)
{
    return iteration_ready(&component->centralised.iteration, &component->rti);
}

/* Let samples pass that were left out: the plan goes on, but where the model gets is not known. */
int UNIT(skip)(struct component *component, int samples)
{
    component->centralised.foretells = 0;
    for (int i = 0; i < samples; ++i)
        live_on(&component->centralised);
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

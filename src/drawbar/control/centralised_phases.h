/* The phases of a centralised controller, around those of its solver; see centralised.h. */
#ifndef DRAWBAR_CENTRALISED_PHASES_H
#define DRAWBAR_CENTRALISED_PHASES_H

#include "centralised.h"

/* Fill the problem with the estimate and both bodies' references. */
static void take_in(struct component *component, const struct drawbar_estimate *estimate,
                    const struct drawbar_body_reference *tractor_reference,
                    const struct drawbar_body_reference *trailer_reference)
{
    struct centralised *both = &component->centralised;
    double *estimated = component->rti.initial;

    vehicle_state(estimate, estimated);
    vehicle_deviation(both, estimated, both->predicts ? both->predicted : estimated, tractor_reference,
                      trailer_reference);
    fill(component, estimate, tractor_reference, trailer_reference);
    iteration_enter(&both->iteration, &component->rti);
}

/* Repeat the last plans that were solved, shifted by one sample; their last values are held. */
static void repeat_plan(struct centralised *both)
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
                   struct drawbar_body_plan *trailer, struct solver_resources *resources)
{
    struct centralised *both = &component->centralised;
    double commands[2];

    take_in(component, estimate, tractor_reference, trailer_reference);
    WATCHED(WATCHED_FEEDBACK, rti_feedback(&component->rti, resources));
    const int status = iteration_leave(&both->iteration, &component->rti);
    both->predicts = status == SOLVED;
    both->solved |= both->predicts;
    if (both->predicts || !both->solved) {
        vehicle_command(component, commands);
        if (both->predicts)
            memcpy(both->predicted, iteration_successor(&component->rti), sizeof both->predicted);
        vehicle_plan(component);
    } else {
        repeat_plan(both);
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

#define PLANNER centralised
#include "plan_phases.h"

#endif

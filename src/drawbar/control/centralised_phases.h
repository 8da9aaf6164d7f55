/* The phases of a centralised controller, around those of its solver; see centralised.h. */
#ifndef DRAWBAR_CENTRALISED_PHASES_H
#define DRAWBAR_CENTRALISED_PHASES_H

#include "centralised.h"

/* The feedback phase before its solver's: take in the estimate and both bodies' references. */
int UNIT(enter)(struct component *component, const struct drawbar_estimate *estimate,
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
    return SOLVED;
}

/* The feedback phase after its solver's: make both bodies' plans of the solution; they share one status. */
int UNIT(leave)(struct component *component, struct drawbar_body_plan *tractor, struct drawbar_body_plan *trailer)
{
    struct centralised *both = &component->centralised;
    const int status = iteration_leave(&both->iteration, &component->rti);
    double commands[2];

    vehicle_command(component, commands);
    both->foretells = status == SOLVED;
    if (both->foretells)
        memcpy(both->predicted, iteration_successor(&component->rti), sizeof both->predicted);
    vehicle_plan(component);
    *tractor = (struct drawbar_body_plan){
        commands[0], (const double (*)[3])both->tractor_poses, both->tractor_steerings, both->tractor_deviation,
        TRACTOR_DEVIATIONS, status
    };
    *trailer = (struct drawbar_body_plan){
        commands[1], (const double (*)[3])both->trailer_poses, both->trailer_steerings, both->trailer_deviation,
        TRAILER_DEVIATIONS, status
    };
    return status;
}

/* The preparation phase after its solver's. */
int UNIT(judge)(struct component *component)
{
    iteration_judge(&component->centralised.iteration, &component->rti);
    return SOLVED;
}

#ifdef EXPORTED
int UNIT(feedback)(struct component *component, const struct drawbar_estimate *estimate,
                   const struct drawbar_body_reference *tractor_reference,
                   const struct drawbar_body_reference *trailer_reference, struct drawbar_body_plan *tractor,
                   struct drawbar_body_plan *trailer, void *work)
{
    UNIT(enter)(component, estimate, tractor_reference, trailer_reference);
    rti_feedback(&component->rti, work);
    return UNIT(leave)(component, tractor, trailer);
}

int UNIT(ready)(struct component *component)
{
    rti_shift(&component->rti);
    rti_prepare(&component->rti);
    return UNIT(judge)(component);
}
#endif

#endif

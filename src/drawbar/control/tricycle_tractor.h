/* Tricycle tractor, the paper's nominal controller f_1; the steering reference is the last measured angle. */
#ifndef DRAWBAR_TRICYCLE_TRACTOR_H
#define DRAWBAR_TRICYCLE_TRACTOR_H

#include "tricycle_body.h"

struct component {
    struct rti rti;
    struct subsystem subsystem;
};

#define COMPONENT_FIELDS SUBSYSTEM_FIELDS

static void body_state(const struct drawbar_estimate *estimate, double *state)
{
    pose_state(&estimate->tractor, state);
}

static void fill(struct component *component, const struct drawbar_estimate *estimate,
                 const struct drawbar_body_reference *reference, const struct drawbar_neighbour *neighbour)
{
    (void)neighbour;
    for (int k = 0; k <= N; ++k) {
        double *p = component->rti.p[k];

        p[P_LONGITUDINAL_SLIP] = estimate->longitudinal_slip;
        p[P_TRACTOR_SLIP] = estimate->tractor_slip;
        p[P_SPEED] = estimate->speed;
    }
    fill_references(&component->rti, reference, estimate->tractor_steering);
}

#include "tricycle_phases.h"

#endif

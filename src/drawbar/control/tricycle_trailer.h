/* Tricycle trailer, the paper's nominal controller f_2, with g_2 by the coupling. */
#ifndef DRAWBAR_TRICYCLE_TRAILER_H
#define DRAWBAR_TRICYCLE_TRAILER_H

#include "tricycle_body.h"

struct component {
    struct rti rti;
    struct subsystem subsystem;
    int32_t coupling;                      /* enum coupling */
    double leverage;                       /* l / L_t */
};

#define COMPONENT_FIELDS SUBSYSTEM_FIELDS SETTING(component, coupling, 1, 1, 0, 0) SETTING(component, leverage, 0, 1, 0, 0)

static void body_state(const struct drawbar_estimate *estimate, double *state)
{
    pose_state(&estimate->trailer, state);
}

/* l/L_t tan(kappa delta_t) over the horizon, by the coupling. */
static void fill_pull(struct component *component, const struct drawbar_estimate *estimate,
                      const struct drawbar_neighbour *tractor)
{
    const int planned = component->coupling == PLANNED && tractor;

    for (int k = 0; k <= N; ++k) {
        const double steering = planned ? tractor->plan->steerings[k < N ? k : N - 1] : estimate->tractor_steering;
        const double pull = component->leverage * tan(estimate->tractor_slip * steering);
        component->rti.p[k][P_COUPLING] = component->coupling == NEGLECTED ? 0.0 : pull;
    }
}

static void fill(struct component *component, const struct drawbar_estimate *estimate,
                 const struct drawbar_body_reference *reference, const struct drawbar_neighbour *neighbour)
{
    for (int k = 0; k <= N; ++k) {
        double *p = component->rti.p[k];

        p[P_LONGITUDINAL_SLIP] = estimate->longitudinal_slip;
        p[P_TRAILER_SLIP] = estimate->trailer_slip;
        p[P_HITCH_ANGLE] = estimate->hitch_angle;
        p[P_SPEED] = estimate->speed;
    }
    fill_pull(component, estimate, neighbour);
    fill_references(&component->rti, reference, estimate->trailer_steering);
}

#include "tricycle_phases.h"

#endif

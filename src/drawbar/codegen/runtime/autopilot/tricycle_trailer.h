/* The paper's nominal controller of the trailer, f_2, with g_2 as the coupling says. */
#ifndef DRAWBAR_TRICYCLE_TRAILER_H
#define DRAWBAR_TRICYCLE_TRAILER_H

#include "tricycle_body.h"

struct part {
    struct rti rti;
    struct subsystem subsystem;
    int32_t coupling;                      /* enum coupling */
    double leverage;                       /* l / L_t */
};

#define PART_FIELDS SUBSYSTEM_FIELDS SETTING(part, coupling, 1, 1, 0, 0) SETTING(part, leverage, 0, 1, 0, 0)

static void body_state(const struct drawbar_estimate *estimate, double *state)
{
    pose_state(&estimate->trailer, state);
}

/* l/L_t tan(kappa delta_t) over the horizon, as far as this controller knows it. */
static void fill_pull(struct part *part, const struct drawbar_estimate *estimate,
                      const struct drawbar_body_plan *tractor)
{
    const int planned = part->coupling == PLANNED && tractor;

    for (int k = 0; k <= N; ++k) {
        const double steering = planned ? tractor->steerings[k < N ? k : N - 1] : estimate->tractor_steering;
        const double pull = part->leverage * tan(estimate->tractor_slip * steering);
        part->rti.p[k][4] = part->coupling == NEGLECTED ? 0.0 : pull;
    }
}

static void fill(struct part *part, const struct drawbar_estimate *estimate,
                 const struct drawbar_body_reference *reference, const struct drawbar_body_plan *neighbour)
{
    const double known[4] = {estimate->longitudinal_slip, estimate->trailer_slip, estimate->hitch_angle,
                             estimate->speed};

    for (int k = 0; k <= N; ++k)
        memcpy(part->rti.p[k], known, sizeof known);
    fill_pull(part, estimate, neighbour);
    fill_references(&part->rti, reference, estimate->trailer_steering);
}

static double body_command(struct part *part)
{
    return INPUT(part->rti.z, 0)[0];
}

static void body_plan(struct part *part)
{
    pose_plan(&part->subsystem, &part->rti);
}

#include "subsystem_phases.h"

#endif

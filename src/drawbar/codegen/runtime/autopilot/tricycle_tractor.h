/* The paper's nominal controller of the tractor, f_1; the steering reference is the last measured angle. */
#ifndef DRAWBAR_TRICYCLE_TRACTOR_H
#define DRAWBAR_TRICYCLE_TRACTOR_H

#include "tricycle_body.h"

struct part {
    struct rti rti;
    struct subsystem subsystem;
};

#define PART_FIELDS SUBSYSTEM_FIELDS

static void body_state(const struct drawbar_estimate *estimate, double *state)
{
    pose_state(&estimate->tractor, state);
}

static void fill(struct part *part, const struct drawbar_estimate *estimate,
                 const struct drawbar_body_reference *reference, const struct drawbar_body_plan *neighbour)
{
    const double known[3] = {estimate->longitudinal_slip, estimate->tractor_slip, estimate->speed};

    (void)neighbour;
    for (int k = 0; k <= N; ++k)
        memcpy(part->rti.p[k], known, sizeof known);
    fill_references(&part->rti, reference, estimate->tractor_steering);
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

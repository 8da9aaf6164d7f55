/* The paper's centralised controller (CeNMPC): both positions tracked on the whole tricycle model.
 *
 * Costs Q, R, S of both bodies; steering references are the last measured angles, as in the decentralised pair.
 */
#ifndef DRAWBAR_CENTRALISED_TRICYCLE_H
#define DRAWBAR_CENTRALISED_TRICYCLE_H

#define TRACTOR_DEVIATIONS 2               /* lateral, heading */
#define TRAILER_DEVIATIONS 2

#include "centralised.h"

struct component {
    struct rti rti;                        /* states: both poses, the tractor's first; inputs: both steering angles */
    struct centralised centralised;
};

#define COMPONENT_FIELDS

static void vehicle_state(const struct drawbar_estimate *estimate, double *x)
{
    x[0] = estimate->tractor.x;
    x[1] = estimate->tractor.y;
    x[2] = estimate->tractor.yaw;
    x[3] = estimate->trailer.x;
    x[4] = estimate->trailer.y;
    x[5] = estimate->trailer.yaw;
}

static void body_deviation(const double *estimated, const double *predicted, const double *closest, double *deviation)
{
    double nominal[] = {predicted[0], predicted[1], predicted[2]};

    move_beside(nominal, closest);
    pose_deviation(estimated, nominal, 3, deviation);
}

static void vehicle_deviation(struct centralised *both, const double *estimated, const double *predicted,
                              const struct drawbar_body_reference *tractor,
                              const struct drawbar_body_reference *trailer)
{
    body_deviation(estimated, predicted, tractor->closest, both->tractor_deviation);
    body_deviation(estimated + 3, predicted + 3, trailer->closest, both->trailer_deviation);
}

static void fill(struct component *component, const struct drawbar_estimate *estimate,
                 const struct drawbar_body_reference *tractor, const struct drawbar_body_reference *trailer)
{
    for (int k = 0; k <= N; ++k) {
        double *p = component->rti.p[k], *y = component->rti.y[k];
        p[0] = estimate->longitudinal_slip;
        p[1] = estimate->tractor_slip;
        p[2] = estimate->trailer_slip;
        p[3] = estimate->hitch_angle;
        p[4] = estimate->speed;
        memcpy(y, tractor->samples[k], 2 * sizeof *y);
        memcpy(y + 2, trailer->samples[k], 2 * sizeof *y);
        y[6] = estimate->tractor_steering;
        y[7] = estimate->trailer_steering;
    }
}

/* Linearise along standing still. */
static void guess(struct rti *solver)
{
    iteration_rest(solver);
}

static void vehicle_command(struct component *component, double *commands)
{
    memcpy(commands, INPUT(component->rti.z, 0), 2 * sizeof *commands);
}

static void vehicle_hold(const struct component *component, double tractor, double trailer, double *commands)
{
    (void)component;
    commands[0] = tractor;
    commands[1] = trailer;
}

static void vehicle_plan(struct component *component)
{
    struct centralised *both = &component->centralised;

    for (int k = 0; k <= N; ++k) {
        const double *x = STATE(component->rti.z, k);
        memcpy(both->tractor_poses[k], x, sizeof both->tractor_poses[k]);
        memcpy(both->trailer_poses[k], x + 3, sizeof both->trailer_poses[k]);
    }
    for (int k = 0; k < N; ++k) {
        both->tractor_steerings[k] = INPUT(component->rti.z, k)[0];
        both->trailer_steerings[k] = INPUT(component->rti.z, k)[1];
    }
}

#include "centralised_phases.h"

#endif

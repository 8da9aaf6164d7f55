/* The product's nominal controller of the tractor: slip, crab and a steering of limited rate, held near the path's own
 * curvature. States x, y, yaw, steering; input: steering rate; outputs: lateral and heading error, steering, rate. */
#ifndef DRAWBAR_ARTICULATED_TRACTOR_H
#define DRAWBAR_ARTICULATED_TRACTOR_H

#define POSE_STATES 1

#include "actuator.h"
#include "chain.h"
#include "off_tracking.h"
#include "subsystem.h"

struct component {
    struct rti rti;
    struct subsystem subsystem;
    struct chain chain;
    struct actuator actuator;
    struct shared_error shared;
};

#define COMPONENT_FIELDS SUBSYSTEM_FIELDS CHAIN_FIELDS(chain) ACTUATOR_FIELDS(actuator) SHARED_ERROR_FIELDS(shared)

static void body_state(const struct drawbar_estimate *estimate, double *state)
{
    state[0] = estimate->tractor.x;
    state[1] = estimate->tractor.y;
    state[2] = estimate->tractor.yaw;
    state[3] = estimate->tractor_steering;
}

static void fill(struct component *component, const struct drawbar_estimate *estimate,
                 const struct drawbar_body_reference *reference, const struct drawbar_body_plan *neighbour)
{
    struct rti *solver = &component->rti;
    const double known[5] = {estimate->longitudinal_slip, estimate->tractor_slip, estimate->steering_offset,
                             estimate->tractor_crab, estimate->speed};

    (void)neighbour;
    for (int k = 0; k <= N; ++k) {
        memcpy(&solver->p[k][0], known, sizeof known);
        memcpy(&solver->p[k][5], reference->samples[k], 3 * sizeof(double));
        solver->y[k][2] = curvature_steering(&component->chain, estimate, reference->samples[k][3]);
    }
    shared_targets(&component->shared, estimate, reference->samples, N + 1, &solver->y[0][0], NY);
}

/* Linearise along the path itself, steered as its curvature asks. */
static void guess(struct rti *solver)
{
    for (int k = 0; k <= N; ++k) {
        memcpy(STATE(solver->z, k), &solver->p[k][5], 3 * sizeof(double));
        STATE(solver->z, k)[3] = solver->y[k][2];
    }
    memset(INPUT(solver->z, 0), 0, N * NU * sizeof(double));
    memcpy(STATE(solver->z, 0), iteration_begin(solver), NX * sizeof(double));
    rti_prepare(solver);
}

static double body_command(struct component *component)
{
    double *z = component->rti.z;
    return actuator_follow(&component->actuator, STATE(z, 0)[3], INPUT(z, 0));
}

static double body_hold(const struct component *component, double steering)
{
    return actuator_hold(&component->actuator, steering);
}

static void body_plan(struct component *component)
{
    for (int k = 0; k <= N; ++k)
        memcpy(component->subsystem.poses[k], STATE(component->rti.z, k), sizeof component->subsystem.poses[k]);
    for (int k = 0; k < N; ++k)
        component->subsystem.steerings[k] = STATE(component->rti.z, k + 1)[3];
}

#include "subsystem_phases.h"

#endif

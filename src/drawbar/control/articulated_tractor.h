/* Articulated tractor, the product's nominal controller: slip, crab and a steering of limited rate, held near the
 * path's own curvature. Its model is `articulated_tractor` of vehicle/articulated.py. */
#ifndef DRAWBAR_ARTICULATED_TRACTOR_H
#define DRAWBAR_ARTICULATED_TRACTOR_H

#define POSE_STATES 1

#include "actuator.h"
#include "chain.h"
#include "off_tracking.h"
#include "rate_bounds.h"
#include "rate_weight.h"
#include "side_slip.h"
#include "subsystem.h"

struct component {
    struct rti rti;
    struct subsystem subsystem;
    struct chain chain;
    struct actuator actuator;
    struct shared_error shared;
    double rate_weight;                    /* weight on the steering rate up to 1 m/s */
};

#define COMPONENT_FIELDS                                                                                         \
    SUBSYSTEM_FIELDS CHAIN_FIELDS(component, chain) ACTUATOR_FIELDS(actuator) SHARED_ERROR_FIELDS(shared)        \
    SETTING(component, rate_weight, 0, 1, 0, 0)

static void body_state(const struct drawbar_estimate *estimate, double *state)
{
    state[X_X] = estimate->tractor.x;
    state[X_Y] = estimate->tractor.y;
    state[X_YAW] = estimate->tractor.yaw;
    state[X_STEERING] = estimate->tractor_steering;
}

static void fill(struct component *component, const struct drawbar_estimate *estimate,
                 const struct drawbar_body_reference *reference, const struct drawbar_neighbour *neighbour)
{
    struct rti *solver = &component->rti;
    double changes[N + 1], cosines[N + 1], sines[N + 1], targets[N + 1], slopes[N + 1];

    (void)neighbour;
    side_slip_changes(estimate, reference->samples, N + 1, changes, cosines, sines);
    shared_targets(&component->shared, estimate, reference->samples, N + 1, targets, slopes);
    weigh_rate(solver, Y_STEERING_RATE, component->rate_weight, estimate->speed);
    for (int k = 0; k <= N; ++k) {
        const double *sample = reference->samples[k];
        double *p = solver->p[k];

        p[P_LONGITUDINAL_SLIP] = estimate->longitudinal_slip;
        p[P_TRACTOR_SLIP] = estimate->tractor_slip;
        p[P_STEERING_OFFSET] = estimate->steering_offset + changes[k];
        p[P_TRACTOR_CRAB] = estimate->tractor_crab + changes[k];
        p[P_SPEED] = estimate->speed;
        p[P_REFERENCE_X] = sample[AT_X];
        p[P_REFERENCE_Y] = sample[AT_Y];
        p[P_REFERENCE_YAW] = sample[AT_YAW];
        solver->y[k][Y_STEERING] = curvature_steering(&component->chain, estimate, sample[AT_CURVATURE]);
        solver->y[k][Y_LATERAL_ERROR] = targets[k];
    }
}

/* Linearise along the path itself, steered as its curvature asks. */
static void guess(struct rti *solver)
{
    for (int k = 0; k <= N; ++k) {
        double *state = STATE(solver->z, k);

        state[X_X] = solver->p[k][P_REFERENCE_X];
        state[X_Y] = solver->p[k][P_REFERENCE_Y];
        state[X_YAW] = solver->p[k][P_REFERENCE_YAW];
        state[X_STEERING] = solver->y[k][Y_STEERING];
    }
    memset(INPUT(solver->z, 0), 0, N * NU * sizeof(double));
    memcpy(STATE(solver->z, 0), iteration_begin(solver), NX * sizeof(double));
    rti_prepare(solver);
}

static void allow_rates(struct component *component, const struct drawbar_actuation *known)
{
    bound_rate(&component->rti, U_STEERING_RATE, component->actuator.rate_share * known->tractor_rate);
}

#include "actuated_command.h"

static void body_plan(struct component *component)
{
    for (int k = 0; k <= N; ++k)
        memcpy(component->subsystem.poses[k], STATE(component->rti.z, k), sizeof component->subsystem.poses[k]);
    for (int k = 0; k < N; ++k)
        component->subsystem.steerings[k] = STATE(component->rti.z, k + 1)[X_STEERING];
}

#include "subsystem_phases.h"

#endif

/* The product's centralised controller: lateral errors of both antennas on the whole chain.
 *
 * Costs, feed-forward and bounds of both decentralised controllers in one problem. No target is shifted here: where the
 * trailer's steering is exhausted, the cost itself divides the error between both bodies.
 */
#ifndef DRAWBAR_CENTRALISED_ARTICULATED_H
#define DRAWBAR_CENTRALISED_ARTICULATED_H

#include "actuator.h"
#include "chain.h"

#define TRACTOR_DEVIATIONS 3               /* lateral, heading, delta_t */
#define TRAILER_DEVIATIONS 2               /* theta - psi, delta_i */

#include "centralised.h"
#include "rate_bounds.h"
#include "rate_weight.h"
#include "side_slip.h"

struct component {
    struct rti rti;
    struct centralised centralised;
    struct chain chain;
    struct actuator tractor_actuator, trailer_actuator;
    double rate_weight;                    /* weight on the tractor's steering rate up to 1 m/s */
};

#define COMPONENT_FIELDS                                                                                     \
    CHAIN_FIELDS(component, chain) ACTUATOR_FIELDS(tractor_actuator) ACTUATOR_FIELDS(trailer_actuator)       \
    SETTING(component, rate_weight, 0, 1, 0, 0)

static void vehicle_state(const struct drawbar_estimate *estimate, double *x)
{
    x[X_TRACTOR_X] = estimate->tractor.x;
    x[X_TRACTOR_Y] = estimate->tractor.y;
    x[X_TRACTOR_YAW] = estimate->tractor.yaw;
    x[X_TRAILER_YAW] = estimate->trailer.yaw;
    x[X_TRACTOR_STEERING] = estimate->tractor_steering;
    x[X_TRAILER_STEERING] = estimate->trailer_steering;
}

static void vehicle_deviation(struct centralised *both, const double *estimated, const double *predicted,
                              const struct drawbar_body_reference *tractor,
                              const struct drawbar_body_reference *trailer)
{
    const double front[] = {estimated[X_TRACTOR_X], estimated[X_TRACTOR_Y], estimated[X_TRACTOR_YAW],
                            estimated[X_TRACTOR_STEERING]};
    double front_nominal[] = {predicted[X_TRACTOR_X], predicted[X_TRACTOR_Y], predicted[X_TRACTOR_YAW],
                              predicted[X_TRACTOR_STEERING]};
    const double rear[] = {estimated[X_TRACTOR_YAW] - estimated[X_TRAILER_YAW], estimated[X_TRAILER_STEERING]};
    const double rear_nominal[] = {predicted[X_TRACTOR_YAW] - predicted[X_TRAILER_YAW],
                                   predicted[X_TRAILER_STEERING]};

    (void)trailer;                         /* the trailer's own states are angles of the body itself */
    move_beside(front_nominal, tractor->closest);
    pose_deviation(front, front_nominal, 4, both->tractor_deviation);
    plain_deviation(rear, rear_nominal, 2, both->trailer_deviation);
}

static void fill(struct component *component, const struct drawbar_estimate *estimate,
                 const struct drawbar_body_reference *tractor, const struct drawbar_body_reference *trailer)
{
    double changes[2][N + 1], cosines[N + 1], sines[N + 1];

    side_slip_changes(estimate, tractor->samples, N + 1, changes[0], cosines, sines);
    side_slip_changes(estimate, trailer->samples, N + 1, changes[1], cosines, sines);
    weigh_rate(&component->rti, Y_TRACTOR_STEERING_RATE, component->rate_weight, estimate->speed);
    for (int k = 0; k <= N; ++k) {
        const double *front = tractor->samples[k], *rear = trailer->samples[k];
        double *p = component->rti.p[k];

        p[P_LONGITUDINAL_SLIP] = estimate->longitudinal_slip;
        p[P_TRACTOR_SLIP] = estimate->tractor_slip;
        p[P_STEERING_OFFSET] = estimate->steering_offset + changes[0][k];
        p[P_TRAILER_CRAB] = estimate->trailer_crab + changes[1][k];
        p[P_SPEED] = estimate->speed;
        p[P_TRACTOR_CRAB] = estimate->tractor_crab + changes[0][k];
        p[P_TRACTOR_REFERENCE_X] = front[AT_X];
        p[P_TRACTOR_REFERENCE_Y] = front[AT_Y];
        p[P_TRACTOR_REFERENCE_YAW] = front[AT_YAW];
        p[P_TRAILER_REFERENCE_X] = rear[AT_X];
        p[P_TRAILER_REFERENCE_Y] = rear[AT_Y];
        p[P_TRAILER_REFERENCE_YAW] = rear[AT_YAW];
        component->rti.y[k][Y_TRACTOR_STEERING]
            = curvature_steering(&component->chain, estimate, front[AT_CURVATURE]);
    }
}

/* Linearise along the path itself, the tractor steered as its curvature asks, the trailer straight. */
static void guess(struct rti *solver)
{
    memcpy(STATE(solver->z, 0), solver->initial, sizeof solver->initial);
    for (int k = 1; k <= N; ++k) {
        const double *p = solver->p[k];
        double *x = STATE(solver->z, k);

        x[X_TRACTOR_X] = p[P_TRACTOR_REFERENCE_X];
        x[X_TRACTOR_Y] = p[P_TRACTOR_REFERENCE_Y];
        x[X_TRACTOR_YAW] = p[P_TRACTOR_REFERENCE_YAW];
        x[X_TRAILER_YAW] = p[P_TRAILER_REFERENCE_YAW];
        x[X_TRACTOR_STEERING] = solver->y[k][Y_TRACTOR_STEERING];
        x[X_TRAILER_STEERING] = 0.0;
    }
    memset(INPUT(solver->z, 0), 0, N * NU * sizeof(double));
    rti_prepare(solver);
}

static void vehicle_command(struct component *component, double *commands)
{
    const double *x = STATE(component->rti.z, 0);
    double *rates = INPUT(component->rti.z, 0);

    commands[0] = actuator_follow(&component->tractor_actuator, x[X_TRACTOR_STEERING],
                                  &rates[U_TRACTOR_STEERING_RATE]);
    commands[1] = actuator_follow(&component->trailer_actuator, x[X_TRAILER_STEERING],
                                  &rates[U_TRAILER_STEERING_RATE]);
}

static void allow_rates(struct component *component, const struct drawbar_actuation *known)
{
    const double front = component->tractor_actuator.rate_share * known->tractor_rate;

    bound_rate(&component->rti, U_TRACTOR_STEERING_RATE, front);
    bound_rate(&component->rti, U_TRAILER_STEERING_RATE, component->trailer_actuator.rate_share * known->trailer_rate);
}

static void vehicle_hold(const struct component *component, double tractor, double trailer, double *commands)
{
    commands[0] = actuator_hold(&component->tractor_actuator, tractor);
    commands[1] = actuator_hold(&component->trailer_actuator, trailer);
}

static void vehicle_plan(struct component *component)
{
    struct centralised *both = &component->centralised;
    double angles[N + 1][3], cosines[3 * (N + 1)], sines[3 * (N + 1)];

    for (int k = 0; k <= N; ++k) {
        const double *x = STATE(component->rti.z, k);
        const double theta = x[X_TRACTOR_YAW], psi = x[X_TRAILER_YAW];
        double *front = both->tractor_poses[k], *rear = both->trailer_poses[k];

        front[AT_X] = x[X_TRACTOR_X];
        front[AT_Y] = x[X_TRACTOR_Y];
        front[AT_YAW] = theta;
        memcpy(rear, front, 2 * sizeof *rear);
        rear[AT_YAW] = angles[k][2] = psi;
        angles[k][0] = theta;
        angles[k][1] = psi + x[X_TRAILER_STEERING];
    }
    trailer_antennas(&component->chain, N + 1, (const double (*)[3])angles, cosines, sines, both->trailer_poses);
    for (int k = 0; k < N; ++k) {
        both->tractor_steerings[k] = STATE(component->rti.z, k + 1)[X_TRACTOR_STEERING];
        both->trailer_steerings[k] = STATE(component->rti.z, k + 1)[X_TRAILER_STEERING];
    }
}

#include "centralised_phases.h"

#endif

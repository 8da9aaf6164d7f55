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

enum { X, Y, THETA, PSI, DELTA_T, DELTA_I };   /* the states; the inputs are the rates of both steering angles */

struct component {
    struct rti rti;
    struct centralised centralised;
    struct chain chain;
    struct actuator tractor_actuator, trailer_actuator;
};

#define COMPONENT_FIELDS CHAIN_FIELDS(chain) ACTUATOR_FIELDS(tractor_actuator) ACTUATOR_FIELDS(trailer_actuator)

static void vehicle_state(const struct drawbar_estimate *estimate, double *x)
{
    x[X] = estimate->tractor.x;
    x[Y] = estimate->tractor.y;
    x[THETA] = estimate->tractor.yaw;
    x[PSI] = estimate->trailer.yaw;
    x[DELTA_T] = estimate->tractor_steering;
    x[DELTA_I] = estimate->trailer_steering;
}

static void vehicle_deviation(struct centralised *both, const double *estimated, const double *predicted,
                              const struct drawbar_body_reference *tractor,
                              const struct drawbar_body_reference *trailer)
{
    const double front[] = {estimated[X], estimated[Y], estimated[THETA], estimated[DELTA_T]};
    double front_nominal[] = {predicted[X], predicted[Y], predicted[THETA], predicted[DELTA_T]};
    const double rear[] = {estimated[THETA] - estimated[PSI], estimated[DELTA_I]};
    const double rear_nominal[] = {predicted[THETA] - predicted[PSI], predicted[DELTA_I]};

    (void)trailer;                         /* the trailer's own states are angles of the body itself */
    move_beside(front_nominal, tractor->closest);
    pose_deviation(front, front_nominal, 4, both->tractor_deviation);
    plain_deviation(rear, rear_nominal, 2, both->trailer_deviation);
}

static void fill(struct component *component, const struct drawbar_estimate *estimate,
                 const struct drawbar_body_reference *tractor, const struct drawbar_body_reference *trailer)
{
    for (int k = 0; k <= N; ++k) {
        double *p = component->rti.p[k];
        p[0] = estimate->longitudinal_slip;
        p[1] = estimate->tractor_slip;
        p[2] = estimate->steering_offset;
        p[3] = estimate->trailer_crab;
        p[4] = estimate->speed;
        p[5] = estimate->tractor_crab;
        memcpy(p + 6, tractor->samples[k], 3 * sizeof *p);
        memcpy(p + 9, trailer->samples[k], 3 * sizeof *p);
        component->rti.y[k][2] = curvature_steering(&component->chain, estimate, tractor->samples[k][3]);
    }
}

/* Linearise along the path itself, the tractor steered as its curvature asks, the trailer straight. */
static void guess(struct rti *solver)
{
    memcpy(STATE(solver->z, 0), solver->initial, sizeof solver->initial);
    for (int k = 1; k <= N; ++k) {
        double *x = STATE(solver->z, k);
        memcpy(x, solver->p[k] + 6, 3 * sizeof *x);
        x[PSI] = solver->p[k][11];
        x[DELTA_T] = solver->y[k][2];
        x[DELTA_I] = 0.0;
    }
    memset(INPUT(solver->z, 0), 0, N * NU * sizeof(double));
    rti_prepare(solver);
}

static void vehicle_command(struct component *component, double *commands)
{
    const double *x = STATE(component->rti.z, 0);
    double *rates = INPUT(component->rti.z, 0);

    commands[0] = actuator_follow(&component->tractor_actuator, x[DELTA_T], &rates[0]);
    commands[1] = actuator_follow(&component->trailer_actuator, x[DELTA_I], &rates[1]);
}

static void vehicle_hold(const struct component *component, double tractor, double trailer, double *commands)
{
    commands[0] = actuator_hold(&component->tractor_actuator, tractor);
    commands[1] = actuator_hold(&component->trailer_actuator, trailer);
}

static void vehicle_plan(struct component *component)
{
    struct centralised *both = &component->centralised;

    for (int k = 0; k <= N; ++k) {
        const double *x = STATE(component->rti.z, k);
        memcpy(both->tractor_poses[k], x, sizeof both->tractor_poses[k]);
        trailer_antenna(&component->chain, x[X], x[Y], x[THETA], x[PSI] + x[DELTA_I], x[PSI], both->trailer_poses[k]);
        both->trailer_poses[k][2] = x[PSI];
    }
    for (int k = 0; k < N; ++k) {
        both->tractor_steerings[k] = STATE(component->rti.z, k + 1)[DELTA_T];
        both->trailer_steerings[k] = STATE(component->rti.z, k + 1)[DELTA_I];
    }
}

#include "centralised_phases.h"

#endif

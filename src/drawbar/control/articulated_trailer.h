/* Articulated trailer, the product's nominal controller, on the chain behind a tractor whose motion is given by the
 * coupling. Its model is `articulated_trailer` of vehicle/articulated.py. */
#ifndef DRAWBAR_ARTICULATED_TRAILER_H
#define DRAWBAR_ARTICULATED_TRAILER_H

#define POSE_STATES 0

#include "actuator.h"
#include "chain.h"
#include "off_tracking.h"
#include "rate_bounds.h"
#include "side_slip.h"
#include "subsystem.h"
#include "yaw_rate.h"

#define STEEPEST 1.2                       /* angle to its line at which the tractor comes back, rad */

struct component {
    struct rti rti;
    struct subsystem subsystem;
    struct chain chain;
    struct actuator actuator;
    struct shared_error shared;
    int32_t coupling;                      /* enum coupling */
    double interval;                       /* between stages, s */
    double smoothing;                      /* weight of one sample of the tractor's yaw rate */
    double return_length;                  /* l, within which the tractor returns to its targets, m */

    double yaw_rate;                       /* of the tractor, smoothed, rad/s */
};

#define COMPONENT_FIELDS                                                                                         \
    SUBSYSTEM_FIELDS CHAIN_FIELDS(component, chain) ACTUATOR_FIELDS(actuator) SHARED_ERROR_FIELDS(shared)        \
    SETTING(component, coupling, 1, 1, 0, 0)                                                                    \
    SETTING(component, interval, 0, 1, 0, 0) SETTING(component, smoothing, 0, 1, 0, 0) SETTING(component, return_length, 0, 1, 0, 0)

static void body_state(const struct drawbar_estimate *estimate, double *state)
{
    state[X_ARTICULATION] = estimate->tractor.yaw - estimate->trailer.yaw;
    state[X_STEERING] = estimate->trailer_steering;
}

/* Set the tractor's predicted yaw rate (rad/s) and pose (m, rad) at a stage. */
static inline void place_tractor(double *p, double yaw_rate, double x, double y, double yaw)
{
    p[P_TRACTOR_YAW_RATE] = yaw_rate;
    p[P_TRACTOR_X] = x;
    p[P_TRACTOR_Y] = y;
    p[P_TRACTOR_YAW] = yaw;
}

/* Predict the tractor by its own plan. */
static void follow_plan(struct component *component, const struct drawbar_body_plan *tractor)
{
    for (int k = 0; k <= N; ++k) {
        const int interval = k < N ? k : N - 1;
        const double *pose = tractor->poses[k];
        const double turn = tractor->poses[interval + 1][AT_YAW] - tractor->poses[interval][AT_YAW];

        place_tractor(component->rti.p[k], turn / component->interval, pose[AT_X], pose[AT_Y], pose[AT_YAW]);
    }
}

/* The tractor's lateral targets beside its line at each stage, m, and their slopes, rad; cosines and sines of the line's yaws. */
struct line_targets {
    double lateral[N + 1], slopes[N + 1];
    const double *forward, *left;
};

/* Predict a tractor that returns to its targets as a critically damped oscillator: after a distance s its offset is
 * (e + (e' + e / l) s) exp(-s / l), with the present offset e and slope e' against the target. Its heading approaches that of
 * the targets within l as well. Returns 0 where the line is not finite. */
static int follow_targets(struct component *component, const struct drawbar_estimate *estimate,
                          const struct drawbar_body_reference *tractor, const struct line_targets *targets)
{
    const double *const slopes = targets->slopes, *const forward = targets->forward, *const left = targets->left;
    const double *closest = tractor->samples[0], crab = estimate->tractor_crab;
    const double along = forward[0], across = left[0];
    const double dx = estimate->tractor.x - closest[AT_X], dy = estimate->tractor.y - closest[AT_Y];
    const double ahead = along * dx + across * dy, left_of = along * dy - across * dx;
    const double steep = tan(clipped(wrapped(estimate->tractor.yaw + crab - closest[AT_YAW]), STEEPEST));
    const double offset = left_of - targets->lateral[0], bend = steep - slopes[0] + offset / component->return_length;
    const double step = estimate->longitudinal_slip * estimate->speed * component->interval;
    const double fades = exp(-step / component->return_length);
    double share = 1.0, aims = slopes[0], last = 0.0, sum = 0.0;

    for (int k = 0; k <= N; ++k) {
        const double *sample = tractor->samples[k];
        const double back = (offset + bend * k * step) * share, beside = targets->lateral[k] + back;
        const double away = bend * share - back / component->return_length;
        const double yaw = sample[AT_YAW] + lane_atan(aims + away) - component->rti.p[k][P_TRACTOR_CRAB];
        double *p = component->rti.p[k];

        place_tractor(p, 0.0, sample[AT_X] + ahead * forward[k] - beside * left[k],
                      sample[AT_Y] + ahead * left[k] + beside * forward[k], yaw);
        if (k > 0)
            component->rti.p[k - 1][P_TRACTOR_YAW_RATE] = p[P_TRACTOR_YAW_RATE] = (yaw - last) / component->interval;
        last = yaw;
        share *= fades;
        aims += (1.0 - fades) * (slopes[k] - aims);
        sum += p[P_TRACTOR_X] + p[P_TRACTOR_Y] + yaw;
    }
    return isfinite(sum);
}

/* Predict a tractor that returns to the lateral targets of its own controller. */
static int follow_line(struct component *component, const struct drawbar_estimate *estimate,
                       const struct drawbar_body_reference *tractor, const double *forward, const double *left)
{
    struct line_targets targets = {.forward = forward, .left = left};

    shared_targets(&component->shared, estimate, tractor->samples, N + 1, targets.lateral, targets.slopes);
    return follow_targets(component, estimate, tractor, &targets);
}

/* The tractor's smoothed present yaw rate, rad/s; one that is not finite leaves the filter as it was. */
static double smoothed_yaw_rate(struct component *component, const struct drawbar_estimate *estimate, double speed)
{
    const double measured = tractor_yaw_rate(estimate, speed, component->chain.wheelbase);
    const double smoothed = component->yaw_rate + component->smoothing * (measured - component->yaw_rate);

    if (isfinite(smoothed))
        component->yaw_rate = smoothed;
    return smoothed;
}

/* Predict a tractor of constant, smoothed yaw rate (measured coupling), or one that drives straight (neglected). */
static void assume_tractor(struct component *component, const struct drawbar_estimate *estimate)
{
    const struct drawbar_pose *pose = &estimate->tractor;
    const double speed = estimate->longitudinal_slip * estimate->speed;
    const double omega = component->coupling == NEGLECTED ? 0.0 : smoothed_yaw_rate(component, estimate, speed);
    const double turn = omega * component->interval, half = 0.5 * turn;
    /* every sample covers the same chord, turned by one angle more */
    const double chord = speed / cos(estimate->tractor_crab) * component->interval * (half != 0.0 ? sin(half) / half : 1.0);
    double x = pose->x, y = pose->y;

    for (int k = 0; k <= N; ++k) {
        const double yaw = pose->yaw + k * turn, course = yaw + estimate->tractor_crab + half;

        place_tractor(component->rti.p[k], omega, x, y, yaw);
        x += chord * cos(course);
        y += chord * sin(course);
    }
}

static void fill(struct component *component, const struct drawbar_estimate *estimate,
                 const struct drawbar_body_reference *reference, const struct drawbar_neighbour *neighbour)
{
    double front[N + 1] = {0.0}, rear[N + 1], forward[N + 1], left[N + 1], cosines[N + 1], sines[N + 1];

    if (neighbour)
        side_slip_changes(estimate, neighbour->reference->samples, N + 1, front, forward, left);
    side_slip_changes(estimate, reference->samples, N + 1, rear, cosines, sines);
    for (int k = 0; k <= N; ++k) {
        const double *sample = reference->samples[k];
        double *p = component->rti.p[k];

        p[P_LONGITUDINAL_SLIP] = estimate->longitudinal_slip;
        p[P_TRACTOR_CRAB] = estimate->tractor_crab + front[k];
        p[P_TRAILER_CRAB] = estimate->trailer_crab + rear[k];
        p[P_SPEED] = estimate->speed;
        p[P_REFERENCE_X] = sample[AT_X];
        p[P_REFERENCE_Y] = sample[AT_Y];
        p[P_REFERENCE_YAW] = sample[AT_YAW];
    }
    if (component->coupling == PLANNED && neighbour)
        follow_plan(component, neighbour->plan);
    else if (!(component->coupling == FOLLOWING && neighbour
               && follow_line(component, estimate, neighbour->reference, forward, left)))
        assume_tractor(component, estimate);
}

/* Linearise along standing still. */
static void guess(struct rti *solver)
{
    iteration_rest(solver);
}

static void allow_rates(struct component *component, const struct drawbar_actuation *known)
{
    bound_rate(&component->rti, U_STEERING_RATE, component->actuator.rate_share * known->trailer_rate);
}

#include "actuated_command.h"

static void body_plan(struct component *component)
{
    double angles[N + 1][3], cosines[3 * (N + 1)], sines[3 * (N + 1)];

    for (int k = 0; k <= N; ++k) {
        const double *p = component->rti.p[k], *state = STATE(component->rti.z, k);
        const double psi = p[P_TRACTOR_YAW] - state[X_ARTICULATION];
        double *pose = component->subsystem.poses[k];

        pose[AT_X] = p[P_TRACTOR_X];
        pose[AT_Y] = p[P_TRACTOR_Y];
        pose[AT_YAW] = angles[k][2] = psi;
        angles[k][0] = p[P_TRACTOR_YAW];
        angles[k][1] = psi + state[X_STEERING];
    }
    trailer_antennas(&component->chain, N + 1, (const double (*)[3])angles, cosines, sines, component->subsystem.poses);
    for (int k = 0; k < N; ++k)
        component->subsystem.steerings[k] = STATE(component->rti.z, k + 1)[X_STEERING];
}

#include "subsystem_phases.h"

#endif

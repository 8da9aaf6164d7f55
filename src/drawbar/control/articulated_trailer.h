/* The product's nominal controller of the trailer, on the chain behind a tractor whose motion is given by the coupling.
 * States articulation, steering; input: steering rate; outputs: lateral error, steering, rate. */
#ifndef DRAWBAR_ARTICULATED_TRAILER_H
#define DRAWBAR_ARTICULATED_TRAILER_H

#define POSE_STATES 0

#include "actuator.h"
#include "chain.h"
#include "subsystem.h"

struct component {
    struct rti rti;
    struct subsystem subsystem;
    struct chain chain;
    struct actuator actuator;
    int32_t coupling;                      /* enum coupling */
    double interval;                       /* between stages, s */
    double smoothing;                      /* what one sample of the tractor's yaw rate counts */

    double yaw_rate;                       /* of the tractor, smoothed, rad/s */
};

#define COMPONENT_FIELDS                                                                                         \
    SUBSYSTEM_FIELDS CHAIN_FIELDS(chain) ACTUATOR_FIELDS(actuator) SETTING(component, coupling, 1, 1, 0, 0)      \
    SETTING(component, interval, 0, 1, 0, 0) SETTING(component, smoothing, 0, 1, 0, 0)

static void body_state(const struct drawbar_estimate *estimate, double *state)
{
    state[0] = estimate->tractor.yaw - estimate->trailer.yaw;
    state[1] = estimate->trailer_steering;
}

/* Let the tractor do what it plans. */
static void follow_plan(struct component *component, const struct drawbar_body_plan *tractor)
{
    for (int k = 0; k <= N; ++k) {
        const int interval = k < N ? k : N - 1;
        double *p = component->rti.p[k];

        p[4] = (tractor->poses[interval + 1][2] - tractor->poses[interval][2]) / component->interval;
        memcpy(&p[5], tractor->poses[k], 3 * sizeof(double));
    }
}

/* The tractor's smoothed present yaw rate, rad/s; one that is not finite is none to go on from. */
static double smoothed_yaw_rate(struct component *component, const struct drawbar_estimate *estimate, double speed)
{
    const double angle = estimate->tractor_slip * estimate->tractor_steering + estimate->steering_offset;
    const double measured = speed * (tan(angle) - tan(estimate->tractor_crab)) / component->chain.wheelbase;
    const double smoothed = component->yaw_rate + component->smoothing * (measured - component->yaw_rate);

    if (isfinite(smoothed))
        component->yaw_rate = smoothed;
    return smoothed;
}

/* Let the tractor keep its smoothed present yaw rate (measured coupling), or go straight (neglected). */
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
        const double motion[4] = {omega, x, y, yaw};

        memcpy(&component->rti.p[k][4], motion, sizeof motion);
        x += chord * cos(course);
        y += chord * sin(course);
    }
}

static void fill(struct component *component, const struct drawbar_estimate *estimate,
                 const struct drawbar_body_reference *reference, const struct drawbar_body_plan *neighbour)
{
    const double known[4] = {estimate->longitudinal_slip, estimate->tractor_crab, estimate->trailer_crab,
                             estimate->speed};

    for (int k = 0; k <= N; ++k) {
        memcpy(&component->rti.p[k][0], known, sizeof known);
        memcpy(&component->rti.p[k][8], reference->samples[k], 3 * sizeof(double));
    }
    if (component->coupling == PLANNED && neighbour)
        follow_plan(component, neighbour);
    else
        assume_tractor(component, estimate);
}

/* Linearise along standing still. */
static void guess(struct rti *solver)
{
    iteration_rest(solver);
}

static double body_command(struct component *component)
{
    double *z = component->rti.z;
    return actuator_follow(&component->actuator, STATE(z, 0)[1], INPUT(z, 0));
}

static double body_hold(const struct component *component, double steering)
{
    return actuator_hold(&component->actuator, steering);
}

static void body_plan(struct component *component)
{
    for (int k = 0; k <= N; ++k) {
        const double *p = component->rti.p[k], *state = STATE(component->rti.z, k);
        double *pose = component->subsystem.poses[k];

        pose[2] = p[7] - state[0];
        trailer_antenna(&component->chain, p[5], p[6], p[7], pose[2] + state[1], pose[2], pose);
    }
    for (int k = 0; k < N; ++k)
        component->subsystem.steerings[k] = STATE(component->rti.z, k + 1)[1];
}

#include "subsystem_phases.h"

#endif

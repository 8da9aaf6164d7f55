/* The product's nominal controller of the trailer, on the chain behind a tractor whose motion is given by the coupling.
 * States articulation, steering; input: steering rate; outputs: lateral error, steering, rate. */
#ifndef DRAWBAR_ARTICULATED_TRAILER_H
#define DRAWBAR_ARTICULATED_TRAILER_H

#define POSE_STATES 0

#include "actuator.h"
#include "chain.h"
#include "subsystem.h"

struct part {
    struct rti rti;
    struct subsystem subsystem;
    struct chain chain;
    struct actuator actuator;
    int32_t coupling;                      /* enum coupling */
    double interval;                       /* between stages, s */
    double smoothing;                      /* what one sample of the tractor's yaw rate counts */

    double yaw_rate;                       /* of the tractor, smoothed, rad/s */
};

#define PART_FIELDS                                                                                         \
    SUBSYSTEM_FIELDS CHAIN_FIELDS(chain) ACTUATOR_FIELDS(actuator) SETTING(part, coupling, 1, 1, 0, 0)      \
    SETTING(part, interval, 0, 1, 0, 0) SETTING(part, smoothing, 0, 1, 0, 0)

static void body_state(const struct drawbar_estimate *estimate, double *state)
{
    state[0] = estimate->tractor.yaw - estimate->trailer.yaw;
    state[1] = estimate->trailer_steering;
}

/* Let the tractor do what it plans. */
static void follow_plan(struct part *part, const struct drawbar_body_plan *tractor)
{
    for (int k = 0; k <= N; ++k) {
        const int interval = k < N ? k : N - 1;
        double *p = part->rti.p[k];

        p[4] = (tractor->poses[interval + 1][2] - tractor->poses[interval][2]) / part->interval;
        memcpy(&p[5], tractor->poses[k], 3 * sizeof(double));
    }
}

/* The tractor's smoothed present yaw rate, rad/s; one that is not finite is none to go on from. */
static double smoothed_yaw_rate(struct part *part, const struct drawbar_estimate *estimate, double speed)
{
    const double angle = estimate->tractor_slip * estimate->tractor_steering + estimate->steering_offset;
    const double measured = speed * (tan(angle) - tan(estimate->tractor_crab)) / part->chain.wheelbase;
    const double smoothed = part->yaw_rate + part->smoothing * (measured - part->yaw_rate);

    if (isfinite(smoothed))
        part->yaw_rate = smoothed;
    return smoothed;
}

/* Let the tractor keep its smoothed present yaw rate (measured coupling), or go straight (neglected). */
static void assume_tractor(struct part *part, const struct drawbar_estimate *estimate)
{
    const struct drawbar_pose *pose = &estimate->tractor;
    const double speed = estimate->longitudinal_slip * estimate->speed;
    const double omega = part->coupling == NEGLECTED ? 0.0 : smoothed_yaw_rate(part, estimate, speed);
    const double turn = omega * part->interval, half = 0.5 * turn;
    /* every sample covers the same chord, turned by one angle more */
    const double chord = speed / cos(estimate->tractor_crab) * part->interval * (half != 0.0 ? sin(half) / half : 1.0);
    double x = pose->x, y = pose->y;

    for (int k = 0; k <= N; ++k) {
        const double yaw = pose->yaw + k * turn, course = yaw + estimate->tractor_crab + half;
        const double motion[4] = {omega, x, y, yaw};

        memcpy(&part->rti.p[k][4], motion, sizeof motion);
        x += chord * cos(course);
        y += chord * sin(course);
    }
}

static void fill(struct part *part, const struct drawbar_estimate *estimate,
                 const struct drawbar_body_reference *reference, const struct drawbar_body_plan *neighbour)
{
    const double known[4] = {estimate->longitudinal_slip, estimate->tractor_crab, estimate->trailer_crab,
                             estimate->speed};

    for (int k = 0; k <= N; ++k) {
        memcpy(&part->rti.p[k][0], known, sizeof known);
        memcpy(&part->rti.p[k][8], reference->samples[k], 3 * sizeof(double));
    }
    if (part->coupling == PLANNED && neighbour)
        follow_plan(part, neighbour);
    else
        assume_tractor(part, estimate);
}

/* Linearise along standing still. */
static void guess(struct rti *solver)
{
    iteration_rest(solver);
}

static double body_command(struct part *part)
{
    double *z = part->rti.z;
    return actuator_follow(&part->actuator, STATE(z, 0)[1], INPUT(z, 0));
}

static void body_plan(struct part *part)
{
    for (int k = 0; k <= N; ++k) {
        const double *p = part->rti.p[k], *state = STATE(part->rti.z, k);
        double *pose = part->subsystem.poses[k];

        pose[2] = p[7] - state[0];
        trailer_antenna(&part->chain, p[5], p[6], p[7], pose[2] + state[1], pose[2], pose);
    }
    for (int k = 0; k < N; ++k)
        part->subsystem.steerings[k] = STATE(part->rti.z, k + 1)[1];
}

#include "subsystem_phases.h"

#endif

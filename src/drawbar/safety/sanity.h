/* Sanity: faults that no controller can correct, and that slow the vehicle down or end the run: positions that stay coarse, or
 * jump together, a loop that oscillates, a vehicle that moves against its heading, a hitch angle that contradicts the motion. */
#ifndef DRAWBAR_SANITY_H
#define DRAWBAR_SANITY_H

#include <string.h>
#include "geometry.h"
#include "hitch_watch.h"
#include "signals.h"
#include "status.h"
#include "swings.h"
#include "unit.h"

#define MOTION_TIME 1.0                    /* over which motion is averaged, s */
#define MOTION_LEAST 0.3                   /* distance within it that determines the direction of motion, m */
#define MOTION_SHARP 0.8                   /* largest share of it, backwards, by one sample, which may be false */
#define MOTION_SHARE 0.3                   /* share of that distance, backwards, that a point must move */
#define JUMP_MEMORY 3.0                    /* after fine positions were missing, large corrections are due: for so long they are
                                            * no jumps, s */
#define JUMP_SHARE 0.1                     /* share of what the wheels cover that they may be wrong by */
#define MOST_SPELLS 2                      /* how often a run may begin to oscillate */
#define SWING_SPEED 0.1                    /* below which a vehicle shows no calm, m/s */

struct component {
    /* settings, described in safety/sanity.py */
    double fine, coarse_after, coarse_share, coarse_budget, jump;
    double swing, steering_swing, swing_share, swing_calm;
    struct hitch_watch hitch;
    double wheelbase;                      /* m */
    double position;                       /* standard deviation of a fix whose receiver reports none, m */
    int32_t swings_slow, swings_stop;      /* half waves */
    /* state */
    time_stamp time, last_fine;            /* of the last sample, and of the last fine fix */
    time_stamp last_new, last_none;        /* when a receiver last reported a fine position, accepted or not; and of the last
                                              sample of a time without any */
    struct drawbar_pose bodies[2];         /* of the last estimate */
    double fixes[4];                       /* fine ones of the last sample that had one, m, */
    time_stamp moved_to;                   /* and its time */
    double distance, moved[2];             /* recent, by the wheels; of both points along their bodies, m */
    double observed[2];                    /* part of that distance with fixes of each point, m */
    struct swings errors[2], steering;
    int32_t swinging, oscillations;        /* it oscillates; how often that has started, */
    int32_t slowing;                       /* and how many of these times the vehicle is driven slower for */
    double calm;                           /* driven since the last swing, s */
    int32_t initialised;
};

#define COMPONENT_FIELDS                                                                                          \
    SETTING(component, fine, 0, 1, 0, 0) SETTING(component, coarse_after, 0, 1, 0, 0)                                  \
    SETTING(component, coarse_share, 0, 1, 0, 0) SETTING(component, coarse_budget, 0, 1, 0, 0)                         \
    SETTING(component, jump, 0, 1, 0, 0)                                                                               \
    SETTING(component, swing, 0, 1, 0, 0) SETTING(component, steering_swing, 0, 1, 0, 0)                               \
    SETTING(component, swing_calm, 0, 1, 0, 0)                                                                         \
    HITCH_WATCH_FIELDS(component, hitch)                                                                               \
    SETTING(component, swing_share, 0, 1, 0, 0) SETTING(component, wheelbase, 0, 1, 0, 0)                              \
    SETTING(component, position, 0, 1, 0, 0)                                                                           \
    SETTING(component, swings_slow, 1, 1, 0, 0) SETTING(component, swings_stop, 1, 1, 0, 0)

/* For how long no fix has been fine, s: all were coarse or missing. */
static inline double without_fine(struct component *sanity, const struct drawbar_measurement *measurement,
                                const struct drawbar_estimate *estimate)
{
    const double deviations[] = {measurement->tractor_fix_deviation, measurement->trailer_fix_deviation};
    const int32_t fixes[] = {estimate->tractor_fix, estimate->trailer_fix};

    for (int i = 0; i < 2; ++i)
        if (fixes[i] == DRAWBAR_FIX_ACCEPTED && !(deviations[i] > sanity->fine))
            sanity->last_fine = measurement->time;
    return measurement->time - sanity->last_fine;
}

/* Whether a point has moved against its body's heading, and the other as well or without enough fixes. */
static inline int has_moved_back(const struct component *sanity, int i)
{
    const double limit = -MOTION_SHARE * sanity->distance, observed = 0.5 * sanity->distance;
    const int other = 1 - i;

    return sanity->moved[i] < limit
        && (sanity->moved[other] < limit || (!(sanity->observed[other] > observed) && sanity->distance > 2.0 * MOTION_LEAST));
}

/* The positions of both antennas, m, NaN in place of a coarse one: its noise is no motion. */
static inline void fine_fixes(const struct component *sanity, const struct drawbar_measurement *m, double *fixes)
{
    const double reported[] = {m->tractor_x, m->tractor_y, m->trailer_x, m->trailer_y};
    const double deviations[] = {m->tractor_fix_deviation, m->trailer_fix_deviation};

    memcpy(fixes, reported, sizeof reported);
    for (int i = 0; i < 2; ++i)
        if ((isnan(deviations[i]) ? sanity->position : deviations[i]) > sanity->fine)
            fixes[2 * i] = (double)NAN;
}

/* Whether both points move against their bodies' headings while the wheels turn forwards, or the wheels turn backwards. Where
 * only one has fixes, twice the distance is needed. */
static inline int moves_backwards(struct component *sanity, const struct drawbar_measurement *m, const double *fixes,
                                  const struct drawbar_estimate *estimate)
{
    const double yaws[] = {estimate->tractor.yaw, estimate->trailer.yaw};
    const double elapsed = m->time - sanity->moved_to, decay = exp(-elapsed / MOTION_TIME);
    const double distance = isfinite(m->speed) ? fmax(m->speed * elapsed, -MOTION_SHARP * MOTION_LEAST) : 0.0;

    if (isnan(fixes[0]) && isnan(fixes[2]) && elapsed < BETWEEN_FIXES && !(m->speed < 0.0))
        return 0;                          /* shown by the next fix */
    sanity->moved_to = m->time;
    sanity->distance = decay * sanity->distance + distance;
    for (int i = 0; i < 2; ++i) {
        const double east = fixes[2 * i] - sanity->fixes[2 * i], north = fixes[2 * i + 1] - sanity->fixes[2 * i + 1];
        const double along = east * cos(yaws[i]) + north * sin(yaws[i]), most = 2.0 * fabs(distance);
        sanity->moved[i] = decay * sanity->moved[i] + (isfinite(along) ? clamped(along, -most, most) : 0.0);
        sanity->observed[i] = decay * sanity->observed[i] + (isfinite(along) ? distance : 0.0);
    }
    memcpy(sanity->fixes, fixes, sizeof sanity->fixes);
    return sanity->distance < -MOTION_LEAST
        || (sanity->distance > MOTION_LEAST && (has_moved_back(sanity, 0) || has_moved_back(sanity, 1)));
}

/* Whether a fix is a fine position (others are NaN here) and a new one. */
static inline int is_new(double fix, int32_t status)
{
    return !isnan(fix) && status != DRAWBAR_FIX_STALE;
}

/* How far a body is from where its wheels have taken it since the last estimate, m. */
static inline double leap(const struct drawbar_pose *before, const struct drawbar_pose *now, double covered)
{
    const double yaw = before->yaw + 0.5 * wrapped(now->yaw - before->yaw);

    return hypot(now->x - before->x - covered * cos(yaw), now->y - before->y - covered * sin(yaw));
}

/* Whether both bodies have leapt: both positions have overruled the estimate. */
static inline int has_jumped(struct component *sanity, time_stamp time, const double *fixes,
                             const struct drawbar_estimate *estimate)
{
    const struct drawbar_pose bodies[] = {estimate->tractor, estimate->trailer};
    const double elapsed = time - sanity->time, covered = estimate->longitudinal_slip * estimate->speed * elapsed;
    const double most = sanity->jump + JUMP_SHARE * fabs(covered);
    const int leapt = leap(&sanity->bodies[0], &bodies[0], covered) > most
        && leap(&sanity->bodies[1], &bodies[1], covered) > most;

    memcpy(sanity->bodies, bodies, sizeof bodies);
    if (is_new(fixes[0], estimate->tractor_fix) || is_new(fixes[2], estimate->trailer_fix))
        sanity->last_new = time;
    else if (time - sanity->last_new > BETWEEN_FIXES)
        sanity->last_none = time;
    return leapt && time - sanity->last_none > JUMP_MEMORY;
}

/* How many half waves in a row either error or the steering has swung. */
static inline int32_t swings_of(struct component *sanity, const struct drawbar_estimate *estimate,
                                const struct drawbar_body_reference *tractor,
                                const struct drawbar_body_reference *trailer)
{
    const double beside = estimate->tractor_steering - atan(sanity->wheelbase * tractor->closest[AT_CURVATURE]);
    const int32_t one = swings_update(&sanity->errors[0], sanity->time, tractor->lateral_error, sanity->swing);
    const int32_t other = swings_update(&sanity->errors[1], sanity->time, trailer->lateral_error, sanity->swing);
    const int32_t steering = swings_update(&sanity->steering, sanity->time, beside, sanity->steering_swing);
    const int32_t errors = one > other ? one : other;

    return errors > steering ? errors : steering;
}

/* Update with half waves in a row; returns the part of the set speed that may be driven. The speed that oscillated first is tried
 * again once it is calm: it may have been the way onto the line, or delays that were not known yet. It stays low if it was not. */
static inline double share_of_swings(struct component *sanity, int32_t swings, double speed, double elapsed)
{
    const int begins = swings >= sanity->swings_slow && !sanity->swinging;
    double share = 1.0;

    sanity->swinging = swings >= sanity->swings_slow;
    sanity->oscillations += begins;
    sanity->slowing += begins;
    sanity->calm = swings > 0 ? 0.0 : fabs(speed) >= SWING_SPEED ? sanity->calm + elapsed : sanity->calm;
    if (sanity->oscillations == 1 && sanity->calm > sanity->swing_calm)
        sanity->slowing = 0;
    for (int32_t i = 0; i < sanity->slowing; ++i)
        share *= sanity->swing_share;
    return share;
}

/* Judge one step, as it was reported and as it was aligned: returns 0 or the status with which the run ends; `share`
 * becomes the part of the set speed that may be driven. departure: see yaw_witness.h, rad. */
int UNIT(judge)(struct component *sanity, const struct drawbar_measurement *reported,
                const struct drawbar_measurement *measurement, const struct drawbar_estimate *estimate,
                const struct drawbar_body_reference *tractor, const struct drawbar_body_reference *trailer, double departure,
                double *share)
{
    if (!sanity->initialised) {
        sanity->last_fine = sanity->last_new = sanity->last_none = sanity->moved_to = sanity->time = measurement->time;
        sanity->initialised = 1;
    }
    const double coarse = without_fine(sanity, measurement, estimate), elapsed = measurement->time - sanity->time;
    double fixes[4];
    fine_fixes(sanity, measurement, fixes);
    const int backwards = moves_backwards(sanity, measurement, fixes, estimate);
    const int jumped = has_jumped(sanity, measurement->time, fixes, estimate);
    const int contradiction = hitch_judge(&sanity->hitch, reported->hitch_angle, measurement, estimate, departure, elapsed);
    sanity->time = measurement->time;
    const int32_t swings = swings_of(sanity, estimate, tractor, trailer);

    *share = share_of_swings(sanity, swings, estimate->speed, elapsed);
    *share *= coarse > sanity->coarse_after ? sanity->coarse_share : 1.0;
    if (backwards)
        return DRAWBAR_BACKWARDS;
    if (jumped)
        return DRAWBAR_JUMPED;
    if (contradiction)
        return contradiction;
    if (coarse > sanity->coarse_budget)
        return DRAWBAR_COARSE;
    return swings >= sanity->swings_stop || sanity->oscillations > MOST_SPELLS ? DRAWBAR_OSCILLATION : 0;
}

#endif

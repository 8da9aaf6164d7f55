/* Position watch: fixes that stay coarse, positions that jump together, and a vehicle that moves against its heading. */
#ifndef DRAWBAR_POSITION_WATCH_H
#define DRAWBAR_POSITION_WATCH_H

#include <math.h>
#include <string.h>
#include "geometry.h"
#include "signals.h"

#define MOTION_TIME 1.0                    /* over which motion is averaged, s */
#define MOTION_LEAST 0.3                   /* distance within it that determines the direction of motion, m */
#define MOTION_SHARP 0.8                   /* largest share of it, backwards, by one sample, which may be false */
#define MOTION_SHARE 0.3                   /* share of that distance, backwards, that a point must move */
#define JUMP_MEMORY 3.0                    /* after fine positions were missing, large corrections are due: for so long they are
                                            * no jumps, s */
#define JUMP_SHARE 0.1                     /* share of what the wheels cover that they may be wrong by */
#define FIX_INTERVAL 1.25                  /* between fixes of receivers at 1 Hz, at most, s */
#define FIX_LATER 1.25                     /* times the last interval: after so long the next fix is missing */

struct position_watch {
    /* settings, described in safety/sanity.py */
    double fine, jump;
    double position;                       /* standard deviation of a fix whose receiver reports none, m */
    /* state */
    struct drawbar_pose bodies[2];         /* of the last estimate */
    double fixes[4];                       /* fine ones of the last sample that had one, m */
    double distance, moved[2];             /* recent, by the wheels; of both points along their bodies, m */
    double observed[2];                    /* part of that distance with fixes of each point, m */
    double interval;                       /* between the last two fine fixes that were accepted, s */
    time_stamp time, moved_to;             /* of the last sample, and of the last one with a fine fix */
    time_stamp last_fine;                  /* of the last fine fix that was accepted */
    time_stamp last_new, last_none;        /* when a receiver last reported a fine position, accepted or not; and of the last
                                            * sample of a time without any */
};

#define POSITION_WATCH_FIELDS(type, place)                                                                   \
    SETTING(type, place.fine, 0, 1, 0, 0) SETTING(type, place.jump, 0, 1, 0, 0)                              \
    SETTING(type, place.position, 0, 1, 0, 0)

static inline void positions_begin(struct position_watch *watch, time_stamp time)
{
    watch->moved_to = watch->time = watch->last_fine = watch->last_new = watch->last_none = time;
}

/* For how long no fix has been fine, s: all were coarse or missing. */
static inline double positions_without_fine(struct position_watch *watch, const struct drawbar_measurement *measurement,
                                            const struct drawbar_estimate *estimate)
{
    const double deviations[] = {measurement->tractor_fix_deviation, measurement->trailer_fix_deviation};
    const int32_t fixes[] = {estimate->tractor_fix, estimate->trailer_fix};

    for (int i = 0; i < 2; ++i)
        if (fixes[i] == DRAWBAR_FIX_ACCEPTED && !(deviations[i] > watch->fine) && measurement->time > watch->last_fine) {
            watch->interval = measurement->time - watch->last_fine;
            watch->last_fine = measurement->time;
        }
    return measurement->time - watch->last_fine;
}

/* Whether a time without a fine fix (s) is no longer than that between two fixes, as with receivers at 1 Hz, and neither has
 * reported another since. */
static inline int is_between_fixes(const struct position_watch *watch, double without_fine,
                                   const struct drawbar_estimate *estimate)
{
    const int tractor = estimate->tractor_fix == DRAWBAR_FIX_MISSING || estimate->tractor_fix == DRAWBAR_FIX_STALE;
    const int trailer = estimate->trailer_fix == DRAWBAR_FIX_MISSING || estimate->trailer_fix == DRAWBAR_FIX_STALE;

    return tractor && trailer && without_fine < fmin(FIX_LATER * watch->interval, FIX_INTERVAL);
}

/* Whether a point has moved against its body's heading, and the other as well or without enough fixes. */
static inline int has_moved_back(const struct position_watch *watch, int i)
{
    const double limit = -MOTION_SHARE * watch->distance, observed = 0.5 * watch->distance;
    const int other = 1 - i;

    return watch->moved[i] < limit
        && (watch->moved[other] < limit || (!(watch->observed[other] > observed) && watch->distance > 2.0 * MOTION_LEAST));
}

/* The positions of both antennas, m, NaN in place of a coarse one: its noise is no motion. */
static inline void fine_fixes(const struct position_watch *watch, const struct drawbar_measurement *m, double *fixes)
{
    const double reported[] = {m->tractor_x, m->tractor_y, m->trailer_x, m->trailer_y};
    const double deviations[] = {m->tractor_fix_deviation, m->trailer_fix_deviation};

    memcpy(fixes, reported, sizeof reported);
    for (int i = 0; i < 2; ++i)
        if ((isnan(deviations[i]) ? watch->position : deviations[i]) > watch->fine)
            fixes[2 * i] = (double)NAN;
}

/* Whether both points move against their bodies' headings while the wheels turn forwards, or the wheels turn backwards. Where
 * only one has fixes, twice the distance is needed. */
static inline int positions_move_backwards(struct position_watch *watch, const struct drawbar_measurement *m,
                                           const double *fixes, const struct drawbar_estimate *estimate)
{
    const double yaws[] = {estimate->tractor.yaw, estimate->trailer.yaw};
    const double elapsed = m->time - watch->moved_to, decay = exp(-elapsed / MOTION_TIME);
    const double distance = isfinite(m->speed) ? fmax(m->speed * elapsed, -MOTION_SHARP * MOTION_LEAST) : 0.0;

    if (isnan(fixes[0]) && isnan(fixes[2]) && elapsed < BETWEEN_FIXES && !(m->speed < 0.0))
        return 0;                          /* shown by the next fix */
    watch->moved_to = m->time;
    watch->distance = decay * watch->distance + distance;
    for (int i = 0; i < 2; ++i) {
        const double east = fixes[2 * i] - watch->fixes[2 * i], north = fixes[2 * i + 1] - watch->fixes[2 * i + 1];
        const double along = east * cos(yaws[i]) + north * sin(yaws[i]), most = 2.0 * fabs(distance);
        watch->moved[i] = decay * watch->moved[i] + (isfinite(along) ? clamped(along, -most, most) : 0.0);
        watch->observed[i] = decay * watch->observed[i] + (isfinite(along) ? distance : 0.0);
    }
    memcpy(watch->fixes, fixes, sizeof watch->fixes);
    return watch->distance < -MOTION_LEAST
        || (watch->distance > MOTION_LEAST && (has_moved_back(watch, 0) || has_moved_back(watch, 1)));
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

/* Whether both bodies have leapt: both positions have overruled the estimate. While the vehicle speeds up or brakes, the estimated
 * speed, a mean over the window, is behind the measured one: the next fix takes back what that makes. */
static inline int positions_have_jumped(struct position_watch *watch, const struct drawbar_measurement *measurement,
                                        const double *fixes, const struct drawbar_estimate *estimate)
{
    const struct drawbar_pose bodies[] = {estimate->tractor, estimate->trailer};
    const time_stamp time = measurement->time;
    const double elapsed = time - watch->time, covered = estimate->longitudinal_slip * estimate->speed * elapsed;
    const double since_fix = fmin(time - watch->last_new, FIX_INTERVAL), slower = measurement->speed - estimate->speed;
    const double behind = isfinite(slower) ? fabs(slower) * since_fix : 0.0;
    const double most = watch->jump + JUMP_SHARE * fabs(covered) + behind;
    const int leapt = leap(&watch->bodies[0], &bodies[0], covered) > most
        && leap(&watch->bodies[1], &bodies[1], covered) > most;

    memcpy(watch->bodies, bodies, sizeof bodies);
    watch->time = time;
    if (is_new(fixes[0], estimate->tractor_fix) || is_new(fixes[2], estimate->trailer_fix))
        watch->last_new = time;
    else if (time - watch->last_new > BETWEEN_FIXES)
        watch->last_none = time;
    return leapt && time - watch->last_none > JUMP_MEMORY;
}

#endif

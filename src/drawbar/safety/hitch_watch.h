/* Hitch watch: whether the angles that are measured at hitch and joint contradict the motion of both bodies.
 *
 * An estimate follows a wrong hitch angle: yaws and side-slips bend until most of it fits, and both bodies are steered
 * beside the line. What they cannot bend to shows in both angles, a few degrees for long, more than usual on this ground.
 * A sensor that is stuck shows sooner by itself: it reports the very same angle while the estimate turns.
 */
#ifndef DRAWBAR_HITCH_WATCH_H
#define DRAWBAR_HITCH_WATCH_H

#include <math.h>
#include "geometry.h"
#include "signals.h"
#include "status.h"
#include "still.h"

#define HITCH_MEAN 0.5                     /* time over which differences are averaged, s */
#define HITCH_USUAL 7.0                    /* times the usual mean difference that is a contradiction */
#define HITCH_FIRST 0.0105                 /* usual one before anything is known of the ground, rad, */
#define HITCH_FIRST_TIME 5.0               /* and time for which that counts, s */
#define HITCH_LATELY 30.0                  /* over which it is averaged, s */
#define HITCH_SHARP 3.0                    /* times the limit of the mean that a difference counts in it at most */
#define HITCH_SURGE 2.0                    /* times the usual one that counts at most: a fault is not to become usual */
#define HITCH_MOVES 0.1                    /* speed below which nothing is learned, m/s */
#define HITCH_TURNED 0.5                   /* share of `most` that the estimate turns while a stuck sensor does not, */
#define HITCH_SHIFTED (1.0 * DRAWBAR_PI / 180.0)    /* and an angle, where the sensor hardly ever repeats itself, rad, */
#define HITCH_OF_PATIENCE 0.5              /* share of the patience that one sample counts for at most */
#define HITCH_SURE 1.5                     /* and so many times less, the more often it does */

struct hitch_watch {
    /* settings, described in safety/sanity.py */
    double least, most, patience;
    /* state */
    double means[2];                       /* measured minus estimated angles of hitch and joint, rad */
    double usual, known;                   /* mean square of their length, rad2, over so long, s */
    struct still still;                    /* the angle as it is reported, and as it is estimated, rad */
    double contradicts, stuck;             /* for how long, s */
    int32_t begun;
};

#define HITCH_WATCH_FIELDS(type, place)                                                                      \
    SETTING(type, place.least, 0, 1, 0, 0) SETTING(type, place.most, 0, 1, 0, 0)                             \
    SETTING(type, place.patience, 0, 1, 0, 0) FIELD(type, place.stuck, 0, 1, 0, 0)

/* An angle that is missing differs by nothing; a single false one is not to exceed the mean's limit by itself. */
static inline double hitch_difference(double measured, double estimated, double limit)
{
    return isfinite(measured) ? clipped(wrapped(measured - estimated), HITCH_SHARP * limit) : 0.0;
}

/* Whether both angles differ for long by more than this ground makes them. */
static inline int hitch_contradicts(struct hitch_watch *watch, const struct drawbar_measurement *m,
                                    const struct drawbar_estimate *estimate, double elapsed)
{
    const int known = estimate->status == SOLVED;
    const double usual = sqrt(watch->usual), limit = fmin(fmax(watch->least, HITCH_USUAL * usual), watch->most);
    const double now[] = {
        known ? hitch_difference(m->hitch_angle, estimate->hitch_angle, limit) : 0.0,
        known ? hitch_difference(m->trailer_steering, estimate->trailer_steering, limit) : 0.0,
    };
    const double share = fmin(-expm1(-elapsed / HITCH_MEAN), 1.0 / HITCH_SHARP);

    for (int i = 0; i < 2; ++i)
        watch->means[i] += share * (now[i] - watch->means[i]);
    const double mean = hypot(watch->means[0], watch->means[1]);
    if (fabs(m->speed) >= HITCH_MOVES && elapsed > 0.0) {
        const double counts = fmin(mean, HITCH_SURGE * usual);
        watch->known = fmin(watch->known + elapsed, HITCH_LATELY);
        watch->usual += elapsed / watch->known * (counts * counts - watch->usual);
    }
    return mean > limit;
}

/* For how long the sensor has reported the very same angle although the estimate has turned away from it, s; `patience` and
 * more at once where it never repeats itself so often. */
static inline double hitch_stuck(struct hitch_watch *watch, double reported, double estimated, double speed,
                                 double elapsed)
{
    const struct still *still = &watch->still;
    const double away = fabs(wrapped(estimated - reported)), least = HITCH_TURNED * watch->most;

    still_take(&watch->still, reported, estimated, speed);
    const double unusual = still_unusual(still);
    if (unusual >= 1.0 && still_missed(still, HITCH_SHIFTED) > HITCH_SHIFTED / fmin(unusual, HITCH_SURE))
        return (double)INFINITY;
    return still->most - still->least > least && away > 0.5 * least ? watch->stuck + elapsed : 0.0;
}

/* Look at a step: 0, or the status with which the run ends. reported: by the sensor; m: brought up to now. */
static inline int hitch_look(struct hitch_watch *watch, double reported, const struct drawbar_measurement *m,
                             const struct drawbar_estimate *estimate, double elapsed)
{
    if (!watch->begun) {
        watch->usual = HITCH_FIRST * HITCH_FIRST;
        watch->known = HITCH_FIRST_TIME;
        watch->still.value = (double)NAN;
        watch->begun = 1;
    }
    const int differs = hitch_contradicts(watch, m, estimate, elapsed);
    const double counts = fmin(elapsed, HITCH_OF_PATIENCE * watch->patience);
    if (!isfinite(reported) || estimate->status != SOLVED) {   /* there is nothing to compare */
        watch->contradicts = watch->stuck = 0.0;
        return 0;
    }
    watch->contradicts = differs ? watch->contradicts + counts : 0.0;
    watch->stuck = hitch_stuck(watch, reported, estimate->hitch_angle, m->speed, counts);
    return fmax(watch->contradicts, watch->stuck) > watch->patience ? DRAWBAR_HITCH : 0;
}

#endif

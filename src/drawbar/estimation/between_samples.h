/* Between two samples: what a quantity was at an earlier time, and what an old value of it would be now.
 *
 * From the last estimate to what is expected now every quantity is taken to change evenly; a body moves along an arc.
 */
#ifndef DRAWBAR_BETWEEN_SAMPLES_H
#define DRAWBAR_BETWEEN_SAMPLES_H

#include <math.h>
#include "signals.h"

#define OLDEST 1.0                         /* what is older is missing, s */

/* One sample of alignment: what was estimated last, and what is expected now. */
struct since {
    const struct drawbar_estimate *last, *expected;
    time_stamp now;
    double elapsed;                        /* by the time stamps, s */
    double predicted;                      /* over which the model went from the last to the expected estimate, s */
};

/* Where something that is `then` (0) and `now` (1) was at an age (s). */
static inline double at_age(const struct since *since, double age, double then, double now)
{
    return age > 0.0 && since->predicted > 0.0 ? now - age / since->predicted * (now - then) : now;
}

/* Where a body was at an age (s) that was at `then` a sample ago and is at `now`: back along the arc through both. Its chord over
 * several samples has another direction than that over one. */
static inline struct drawbar_pose pose_at_age(const struct since *since, double age, const struct drawbar_pose *then,
                                              const struct drawbar_pose *now)
{
    const double samples = age > 0.0 && since->predicted > 0.0 ? age / since->predicted : 0.0;
    const double turned = now->yaw - then->yaw, chord = -0.5 * (samples - 1.0) * turned;
    const double east = now->x - then->x, north = now->y - then->y;

    return (struct drawbar_pose){now->x - samples * (east * cos(chord) - north * sin(chord)),
                                 now->y - samples * (east * sin(chord) + north * cos(chord)), now->yaw - samples * turned};
}

/* How far the vehicle has moved, m. */
static inline double moved_since(const struct since *since)
{
    const double moved = fabs(since->expected->speed) * since->elapsed;
    return isfinite(moved) ? moved : 0.0;
}

/* What a sensor would report now that reported `value` at an age (s): as its quantity changes from last to expected. */
static inline double brought_up(const struct since *since, double value, double age, double last, double expected)
{
    if (age == 0.0 || isnan(age))
        return value;
    return age > 0.0 && age <= OLDEST ? value + expected - at_age(since, age, last, expected) : (double)NAN;
}

#endif

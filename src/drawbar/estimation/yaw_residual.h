/* Yaw residual: by how much the tractor's yaw of fixes and angles has lately departed from the integral of its yaw-rate sensor.
 *
 * A wrong hitch angle shows in that yaw, wheels that slip do not: they affect neither fixes nor angles nor yaw rate. What both
 * have differed by for long (zeros of the sensors, a bias) does not count.
 */
#ifndef DRAWBAR_YAW_RESIDUAL_H
#define DRAWBAR_YAW_RESIDUAL_H

#include <math.h>
#include <stdint.h>
#include "geometry.h"

#define RESIDUAL_LEVEL 3.0                 /* time constant of the lasting difference, s, and how long it is learned */
#define RESIDUAL_MEAN 0.5                  /* time constant of the departure from it, s */
#define RESIDUAL_HOLD 5.0                  /* time constant with which its largest value fades, s */
#define RESIDUAL_GAP 1.0                   /* for how long the yaw may be missing, s */

struct yaw_residual {
    double expected;                       /* yaw by the integral of the yaw rate and the lasting difference, rad */
    double rate;                           /* the last yaw rate, rad/s */
    double mean, largest;                  /* mean departure from what is expected; its magnitude lately, rad */
    double known, missing;                 /* for how long both have been there, and the yaw has not, s */
};

/* The largest recent departure, rad; NaN where the yaw rate or, for longer, the yaw is missing, or both are too new. */
static inline double yaw_residual_departure(const struct yaw_residual *residual)
{
    return residual->known > RESIDUAL_LEVEL ? residual->largest : (double)NAN;
}

/* Update with the yaw by fixes and angles, rad, and the yaw rate, rad/s. */
static inline void yaw_residual_update(struct yaw_residual *residual, double yaw, double rate, double elapsed)
{
    residual->missing = isfinite(yaw) ? 0.0 : residual->missing + elapsed;
    if (!isfinite(rate) || !(elapsed > 0.0) || residual->missing > RESIDUAL_GAP)
        residual->known = 0.0;
    else if (!(residual->known > 0.0))
        *residual = (struct yaw_residual){.expected = yaw, .known = isfinite(yaw) ? elapsed : 0.0};
    else {
        residual->expected += 0.5 * (rate + residual->rate) * elapsed;
        residual->known += elapsed;
    }
    residual->rate = rate;
    const double difference = wrapped(yaw - residual->expected);

    if (residual->known > 0.0 && isfinite(difference)) {
        residual->expected -= expm1(-elapsed / fmin(RESIDUAL_LEVEL, residual->known)) * difference;
        residual->mean -= expm1(-elapsed / RESIDUAL_MEAN) * (difference - residual->mean);
        residual->largest = fmax(exp(-elapsed / RESIDUAL_HOLD) * residual->largest, fabs(residual->mean));
    }
}

#endif

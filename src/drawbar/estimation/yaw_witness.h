/* Yaw witness: by how much the tractor's yaw of fixes and angles has lately departed from the integral of its yaw-rate sensor.
 *
 * A wrong hitch angle shows in that yaw, wheels that slip do not: neither fixes nor angles nor yaw rate know of them. What both
 * have differed by for long (zeros of the sensors, a bias) does not count.
 */
#ifndef DRAWBAR_YAW_WITNESS_H
#define DRAWBAR_YAW_WITNESS_H

#include <math.h>
#include <stdint.h>
#include "geometry.h"

#define WITNESS_LEVEL 3.0                  /* time constant of the lasting difference, s, and how long it is learned */
#define WITNESS_MEAN 0.5                   /* time constant of the departure from it, s */
#define WITNESS_HOLD 5.0                   /* time constant with which its largest value fades, s */
#define WITNESS_GAP 1.0                    /* for how long the yaw may be missing, s */

struct yaw_witness {
    double expected;                       /* yaw by the integral of the yaw rate and the lasting difference, rad */
    double rate;                           /* the last yaw rate, rad/s */
    double mean, largest;                  /* mean departure from what is expected; its magnitude lately, rad */
    double known, missing;                 /* for how long both have been there, and the yaw has not, s */
};

/* The largest recent departure, rad; NaN where the yaw rate or, for longer, the yaw is missing, or both are too new. */
static inline double yaw_witness_departure(const struct yaw_witness *witness)
{
    return witness->known > WITNESS_LEVEL ? witness->largest : (double)NAN;
}

/* Update with the yaw by fixes and angles, rad, and the yaw rate, rad/s. */
static inline void yaw_witness_update(struct yaw_witness *witness, double yaw, double rate, double elapsed)
{
    witness->missing = isfinite(yaw) ? 0.0 : witness->missing + elapsed;
    if (!isfinite(rate) || !(elapsed > 0.0) || witness->missing > WITNESS_GAP)
        witness->known = 0.0;
    else if (!(witness->known > 0.0))
        *witness = (struct yaw_witness){.expected = yaw, .known = isfinite(yaw) ? elapsed : 0.0};
    else {
        witness->expected += 0.5 * (rate + witness->rate) * elapsed;
        witness->known += elapsed;
    }
    witness->rate = rate;
    const double difference = wrapped(yaw - witness->expected);

    if (witness->known > 0.0 && isfinite(difference)) {
        witness->expected -= expm1(-elapsed / fmin(WITNESS_LEVEL, witness->known)) * difference;
        witness->mean -= expm1(-elapsed / WITNESS_MEAN) * (difference - witness->mean);
        witness->largest = fmax(exp(-elapsed / WITNESS_HOLD) * witness->largest, fabs(witness->mean));
    }
}

#endif

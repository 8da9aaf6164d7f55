/* Manoeuvre: by how much the vehicle has lately changed its motion; right fixes may then lie off
 * (docs/theory/screening.md).
 *
 * What is late by a time that nobody tells (a fix after the vehicle, a body after its wheels) puts an antenna off by that
 * time its motion. The estimator takes up what lasts of it; what has changed lately it has not taken up yet.
 */
#ifndef DRAWBAR_MANOEUVRE_H
#define DRAWBAR_MANOEUVRE_H

#include <math.h>
#include <stdint.h>

/* How the tractor moves, or by how much that has changed. */
struct motion {
    double speed, yaw_rate;                /* m/s, rad/s */
};

struct manoeuvre {
    struct motion mean;                    /* what the estimator has taken up */
    struct motion change;                  /* beyond that, fading */
};

/* Take in a value; a change fades as the mean follows, even where the motion only passes through its mean. */
static inline void manoeuvre_follow(double value, int32_t settling, double *mean, double *change)
{
    *change = fmax(fabs(value - *mean), *change * (1.0 - 1.0 / settling));
    *mean += (value - *mean) / settling;
}

/* Take in one sample's motion; what of it is not known stays as it was. settling: samples in which the estimator takes up
 * a change. */
static inline void manoeuvre_update(struct manoeuvre *manoeuvre, const struct motion *motion, int32_t settling)
{
    if (isfinite(motion->speed))
        manoeuvre_follow(motion->speed, settling, &manoeuvre->mean.speed, &manoeuvre->change.speed);
    if (isfinite(motion->yaw_rate))
        manoeuvre_follow(motion->yaw_rate, settling, &manoeuvre->mean.yaw_rate, &manoeuvre->change.yaw_rate);
}

#endif

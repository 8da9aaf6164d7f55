/* Manoeuvre: the recent change of the vehicle's motion, by which the innovations of correct fixes grow
 * (docs/theory/screening.md).
 *
 * An unmodelled delay (of a fix, or of a body behind its wheels) displaces an antenna by its motion during the delay. The
 * estimator compensates the steady part of that displacement, not yet the part of a recent change.
 */
#ifndef DRAWBAR_MANOEUVRE_H
#define DRAWBAR_MANOEUVRE_H

#include <math.h>
#include <stdint.h>

/* The tractor's motion, or its change. */
struct motion {
    double speed, yaw_rate;                /* m/s, rad/s */
};

struct manoeuvre {
    struct motion mean;                    /* that the estimator has compensated */
    struct motion change;                  /* beyond that, decaying */
};

/* Update with a value; a change decays as the mean follows, even where the motion only passes through its mean. */
static inline void manoeuvre_follow(double value, int32_t settling, double *mean, double *change)
{
    *change = fmax(fabs(value - *mean), *change * (1.0 - 1.0 / settling));
    *mean += (value - *mean) / settling;
}

/* Update with one sample's motion; an unknown part stays as it was. settling: time constant in which the estimator compensates
 * a change, samples. */
static inline void manoeuvre_update(struct manoeuvre *manoeuvre, const struct motion *motion, int32_t settling)
{
    if (isfinite(motion->speed))
        manoeuvre_follow(motion->speed, settling, &manoeuvre->mean.speed, &manoeuvre->change.speed);
    if (isfinite(motion->yaw_rate))
        manoeuvre_follow(motion->yaw_rate, settling, &manoeuvre->mean.yaw_rate, &manoeuvre->change.yaw_rate);
}

#endif

/* Yaw rate of the tractor, by its wheels. */
#ifndef DRAWBAR_YAW_RATE_H
#define DRAWBAR_YAW_RATE_H

#include <math.h>
#include "signals.h"

/* The tractor's yaw rate (rad/s) at a speed of its rear axle (m/s), from estimated steering angle and side-slips; wheelbase
 * in m. */
static inline double tractor_yaw_rate(const struct drawbar_estimate *estimate, double speed, double wheelbase)
{
    const double angle = estimate->tractor_slip * estimate->tractor_steering + estimate->steering_offset;

    return speed * (tan(angle) - tan(estimate->tractor_crab)) / wheelbase;
}

#endif

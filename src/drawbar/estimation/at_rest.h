/* At rest: what one measurement shows, by itself, of a vehicle that stands; shared by the estimators' models. */
#ifndef DRAWBAR_AT_REST_H
#define DRAWBAR_AT_REST_H

#include "yaws_at_rest.h"

/* What is measured in a sample that was left out. */
static const struct drawbar_measurement nothing_measured = {
    .time = (double)NAN, .tractor_x = (double)NAN, .tractor_y = (double)NAN, .trailer_x = (double)NAN,
    .trailer_y = (double)NAN, .hitch_angle = (double)NAN, .speed = (double)NAN, .tractor_steering = (double)NAN,
    .trailer_steering = (double)NAN, .tractor_yaw = (double)NAN,
    .tractor_yaw_rate = (double)NAN
};

/* The value, or NaN where it is not finite: missing. */
static inline double if_finite(double value)
{
    return isfinite(value) ? value : (double)NAN;
}

/* The measured quantities, which are outputs of both models; what is not finite is missing. */
static inline void measured(const struct drawbar_measurement *measurement, double *y)
{
    y[Y_TRACTOR_X] = if_finite(measurement->tractor_x);
    y[Y_TRACTOR_Y] = if_finite(measurement->tractor_y);
    y[Y_TRAILER_X] = if_finite(measurement->trailer_x);
    y[Y_TRAILER_Y] = if_finite(measurement->trailer_y);
    y[Y_HITCH_ANGLE] = if_finite(measurement->hitch_angle);
    y[Y_SPEED] = if_finite(measurement->speed);
    y[Y_TRACTOR_STEERING] = if_finite(measurement->tractor_steering);
    y[Y_TRAILER_STEERING] = if_finite(measurement->trailer_steering);
}

#endif

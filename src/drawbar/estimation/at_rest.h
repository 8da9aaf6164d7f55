/* What one measurement shows, by itself, of a vehicle at rest; shared by the estimators' models. */
#ifndef DRAWBAR_AT_REST_H
#define DRAWBAR_AT_REST_H

#include "chain.h"

/* The value, or NaN where it is not finite: missing. */
static inline double if_finite(double value)
{
    return isfinite(value) ? value : NAN;
}

/* The measured value, or zero where it is missing or no number: the first guess has nothing better. */
static inline double known(double value)
{
    return isfinite(value) ? value : 0.0;
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

/* Tractor and trailer yaw (rad) from both antennas and both joint angles; returns 0 when a position is missing.
 *
 * The vector from the trailer's antenna to the tractor's has known length and direction in the trailer's frame once the
 * joint angles are known, so one measurement at rest shows the heading. */
static inline int yaws_at_rest(const struct chain *chain, const struct drawbar_measurement *measurement,
                               double *tractor, double *trailer)
{
    const double east = measurement->tractor_x - measurement->trailer_x;
    const double north = measurement->tractor_y - measurement->trailer_y;
    const double joint = known(measurement->trailer_steering), gamma = known(measurement->hitch_angle) + joint;
    const double ahead = chain->back + chain->drawbar * cos(joint) + chain->hitch * cos(gamma);
    const double left = chain->drawbar * sin(joint) + chain->hitch * sin(gamma);

    if (!isfinite(east + north))
        return 0;
    *trailer = atan2(north, east) - atan2(left, ahead);
    *tractor = *trailer + gamma;
    return 1;
}

#endif

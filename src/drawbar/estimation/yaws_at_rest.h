/* The yaws of a vehicle at rest, from one measurement. */
#ifndef DRAWBAR_YAWS_AT_REST_H
#define DRAWBAR_YAWS_AT_REST_H

#include "chain.h"

/* The measured value, or zero where it is missing or no number: the first guess has nothing better. */
static inline double known(double value)
{
    return isfinite(value) ? value : 0.0;
}

/* From the trailer's heading to the tractor's as the joints are measured, rad. */
static inline double gamma_at_rest(const struct drawbar_measurement *measurement)
{
    return known(measurement->hitch_angle) + known(measurement->trailer_steering);
}

/* Tractor and trailer yaw (rad) from both positions and both joint angles; returns 0 when a position is missing.
 *
 * The vector from the trailer's position to the tractor's has known length and direction in the trailer's frame once the
 * joint angles are known, so one measurement at rest shows the heading. beyond: how much further ahead and to the left, in
 * this frame, the tractor's position is of the trailer's than their points are, m. */
static inline int yaws_apart(const struct chain *chain, const struct drawbar_measurement *measurement,
                             const double *beyond, double *tractor, double *trailer)
{
    const double east = measurement->tractor_x - measurement->trailer_x;
    const double north = measurement->tractor_y - measurement->trailer_y;
    const double joint = known(measurement->trailer_steering), gamma = gamma_at_rest(measurement);
    const double ahead = chain->back + chain->drawbar * cos(joint) + chain->hitch * cos(gamma) + beyond[0];
    const double left = chain->drawbar * sin(joint) + chain->hitch * sin(gamma) + beyond[1];

    if (!isfinite(east + north))
        return 0;
    *trailer = atan2(north, east) - atan2(left, ahead);
    *tractor = *trailer + gamma;
    return 1;
}

/* The same from both points. */
static inline int yaws_at_rest(const struct chain *chain, const struct drawbar_measurement *measurement,
                               double *tractor, double *trailer)
{
    static const double nothing[2];
    return yaws_apart(chain, measurement, nothing, tractor, trailer);
}

#endif

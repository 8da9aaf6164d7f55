/* What of a measurement may enter: numbers that a sensor can have meant, in time. */
#ifndef DRAWBAR_ADMISSION_H
#define DRAWBAR_ADMISSION_H

#include <math.h>
#include "drawbar_signals.h"

#define FARTHEST 1e7                       /* position, m: beyond it a double holds too few digits */
#define WIDEST 6.2831853071795865          /* angle, rad: a whole turn */
#define FASTEST 50.0                       /* speed, m/s */

/* The value, or NaN where it is beyond the limit and so missing; such values are counted. */
static inline double admitted(double value, double limit, int32_t *absurd)
{
    if (fabs(value) <= limit)
        return value;
    *absurd += !isnan(value);
    return (double)NAN;
}

/* A measurement without what no sensor can have meant; returns how many values that were. */
static inline int32_t admit(const struct drawbar_measurement *measurement, struct drawbar_measurement *seen)
{
    int32_t absurd = 0;

    seen->time = measurement->time;
    seen->tractor_x = admitted(measurement->tractor_x, FARTHEST, &absurd);
    seen->tractor_y = admitted(measurement->tractor_y, FARTHEST, &absurd);
    seen->trailer_x = admitted(measurement->trailer_x, FARTHEST, &absurd);
    seen->trailer_y = admitted(measurement->trailer_y, FARTHEST, &absurd);
    seen->hitch_angle = admitted(measurement->hitch_angle, WIDEST, &absurd);
    seen->speed = admitted(measurement->speed, FASTEST, &absurd);
    seen->tractor_steering = admitted(measurement->tractor_steering, WIDEST, &absurd);
    seen->trailer_steering = admitted(measurement->trailer_steering, WIDEST, &absurd);
    return absurd;
}

#endif

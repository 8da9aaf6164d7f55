/* Leap: a value that is far from its sensor's last one is not believed unless the next one is so, too. */
#ifndef DRAWBAR_LEAP_H
#define DRAWBAR_LEAP_H

#include <math.h>
#include <stdint.h>

struct leap {
    double last;                           /* value that was believed */
    int32_t begun, masked;                 /* is there one; was the newest one masked? */
};

/* The value, NaN where it is not believed; most: the largest change between two samples. */
static inline double leap_masked(struct leap *leap, double most, double value)
{
    leap->masked = leap->begun && !leap->masked && fabs(value - leap->last) > most;
    if (leap->masked || !isfinite(value))
        return (double)NAN;
    leap->last = value;
    leap->begun = 1;
    return value;
}

#endif

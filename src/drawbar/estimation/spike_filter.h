/* Spike filter: a value that is far from the last accepted one is rejected once; if the next is as far, that is accepted. */
#ifndef DRAWBAR_SPIKE_FILTER_H
#define DRAWBAR_SPIKE_FILTER_H

#include <math.h>
#include <stdint.h>

struct spike_filter {
    double last;                           /* accepted value */
    int32_t initialised, rejected;         /* is there one; was the newest value rejected? */
};

/* The value, NaN where it is rejected; most: the largest change between two samples. */
static inline double spike_filtered(struct spike_filter *filter, double most, double value)
{
    filter->rejected = filter->initialised && !filter->rejected && fabs(value - filter->last) > most;
    if (filter->rejected || !isfinite(value))
        return (double)NAN;
    filter->last = value;
    filter->initialised = 1;
    return value;
}

#endif

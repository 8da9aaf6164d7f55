/* Admission of a measurement: the numbers that a sensor can have meant, in time. */
#ifndef DRAWBAR_ADMISSION_H
#define DRAWBAR_ADMISSION_H

#include <stddef.h>
#include <string.h>
#include "signals.h"

#define MEASURED_NUMBERS (sizeof measurement_limits / sizeof *measurement_limits)

/* A measurement without what no sensor can have meant; returns how many values that were. The time is another's business. */
static inline int32_t admit(const struct drawbar_measurement *measurement, struct drawbar_measurement *seen)
{
    const size_t first = offsetof(struct drawbar_measurement, tractor_x);
    double values[MEASURED_NUMBERS];       /* all of its members from there to the last ones, which are enumerations */
    int32_t absurd = 0;

    *seen = *measurement;
    memcpy(values, (const char *)measurement + first, sizeof values);
    for (size_t i = 0; i < MEASURED_NUMBERS; ++i)
        if (!(fabs(values[i]) <= measurement_limits[i])) {
            absurd += !isnan(values[i]);
            values[i] = (double)NAN;
        }
    memcpy((char *)seen + first, values, sizeof values);
    return absurd;
}

#endif

/* Admission of a measurement: values beyond physical limits count as missing. */
#ifndef DRAWBAR_ADMISSION_H
#define DRAWBAR_ADMISSION_H

#include <stddef.h>
#include <string.h>
#include "signals.h"

#define MEASURED_NUMBERS (sizeof measurement_limits / sizeof *measurement_limits)

/* A measurement without impossible values; returns how many there were. Its time is not checked here. */
static inline int32_t admit(const struct drawbar_measurement *measurement, struct drawbar_measurement *admitted)
{
    const size_t first = offsetof(struct drawbar_measurement, tractor_x);
    double values[MEASURED_NUMBERS];       /* all members from there to the last ones, which are enumerations */
    int32_t impossible = 0;

    *admitted = *measurement;
    memcpy(values, (const char *)measurement + first, sizeof values);
    for (size_t i = 0; i < MEASURED_NUMBERS; ++i)
        if (!(fabs(values[i]) <= measurement_limits[i])) {
            impossible += !isnan(values[i]);
            values[i] = (double)NAN;
        }
    memcpy((char *)admitted + first, values, sizeof values);
    return impossible;
}

#endif

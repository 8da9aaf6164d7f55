/* A sensor's counts as an angle or a position, by its table or its cubic; and whether a table or cubic is any good. */
#ifndef DRAWBAR_LINEARISE_H
#define DRAWBAR_LINEARISE_H

#include <math.h>
#include "drawbar_actuate.h"

#define LARGEST_SETTING 1e6

/* Whether a setting is finite and from low to high. */
static int setting_within(double value, double low, double high)
{
    return value >= low && value <= high;
}

static double cubic_at(const double c[4], double n)
{
    return c[0] + n * (c[1] + n * (c[2] + n * c[3]));
}

static double cubic_slope(const double c[4], double n)
{
    return c[1] + n * (2.0 * c[2] + n * 3.0 * c[3]);
}

/* Whether the cubic rises, or falls, over the whole range: its slope, a parabola, is extreme at the ends or its vertex. */
static int cubic_is_monotone(const struct drawbar_sensor *sensor)
{
    const double *c = sensor->cubic, low = sensor->lowest, high = sensor->highest;
    const double first = cubic_slope(c, low), last = cubic_slope(c, high);

    for (int i = 0; i < 4; ++i)
        if (!isfinite(c[i]))
            return 0;
    if (!(isfinite(first) && isfinite(last) && fabs(cubic_at(c, low)) <= LARGEST_SETTING
          && fabs(cubic_at(c, high)) <= LARGEST_SETTING && first * last > 0.0))
        return 0;
    const double vertex = -c[2] / (3.0 * c[3]);            /* not finite for what is no cubic: then outside */
    return !(vertex > low && vertex < high) || cubic_slope(c, vertex) * first > 0.0;
}

static int table_is_monotone(const struct drawbar_sensor *sensor)
{
    const double *counts = sensor->counts, *values = sensor->values;
    const double direction = values[1] - values[0];

    for (int i = 0; i < sensor->points; ++i)
        if (!setting_within(counts[i], -LARGEST_SETTING, LARGEST_SETTING)
            || !setting_within(values[i], -LARGEST_SETTING, LARGEST_SETTING))
            return 0;
    for (int i = 1; i < sensor->points; ++i)
        if (!(counts[i] > counts[i - 1] && (values[i] - values[i - 1]) * direction > 0.0))
            return 0;
    return 1;
}

static int sensor_is_sound(const struct drawbar_sensor *sensor)
{
    if (!setting_within(sensor->lowest, -LARGEST_SETTING, LARGEST_SETTING)
        || !setting_within(sensor->highest, -LARGEST_SETTING, LARGEST_SETTING) || !(sensor->lowest < sensor->highest))
        return 0;
    if (sensor->points == 0)
        return cubic_is_monotone(sensor);
    return sensor->points >= 2 && sensor->points <= DRAWBAR_TABLE_POINTS && table_is_monotone(sensor);
}

static double table_at(const struct drawbar_sensor *sensor, double counts)
{
    int i = 1;

    while (i < sensor->points - 1 && counts > sensor->counts[i])
        ++i;
    const double share = (counts - sensor->counts[i - 1]) / (sensor->counts[i] - sensor->counts[i - 1]);
    return sensor->values[i - 1] + share * (sensor->values[i] - sensor->values[i - 1]);
}

/* What the sensor measures, or NaN where its counts are not finite or outside its electrical range. */
static double linearised(const struct drawbar_sensor *sensor, double counts)
{
    if (!(counts >= sensor->lowest && counts <= sensor->highest))
        return (double)NAN;
    const double value = sensor->points == 0 ? cubic_at(sensor->cubic, counts) : table_at(sensor, counts);
    return isfinite(value) ? value : (double)NAN;
}

#endif

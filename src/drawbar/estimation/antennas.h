/* Antennas: where both are reported and where they are expected, and what lies between the two; four numbers each,
 * those of the tractor's antenna first; east and north, or ahead and to the left, m. */
#ifndef DRAWBAR_ANTENNAS_H
#define DRAWBAR_ANTENNAS_H

#include <math.h>

static inline double distance(const double *one, const double *other)
{
    return hypot(one[0] - other[0], one[1] - other[1]);
}

/* The innovation of each fix, longitudinal and lateral to the line through both expected antennas, m. */
static inline void antenna_innovations(const double *fixes, const double *expected, double *innovations)
{
    const double length = distance(expected, expected + 2);
    const double c = (expected[0] - expected[2]) / length, s = (expected[1] - expected[3]) / length;

    for (int i = 0; i < 4; i += 2) {
        const double east = fixes[i] - expected[i], north = fixes[i + 1] - expected[i + 1];
        innovations[i] = c * east + s * north;
        innovations[i + 1] = c * north - s * east;
    }
}

/* By how much the antennas are further from each other than expected, m. */
static inline double antenna_length_error(const double *fixes, const double *expected)
{
    return distance(fixes, fixes + 2) - distance(expected, expected + 2);
}

#endif

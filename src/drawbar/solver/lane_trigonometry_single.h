/* Lane trigonometry in single precision; a library that is exported so has this in the place of lane_trigonometry.h.
 *
 * Argument reduction by pi/2 in three parts (Cody and Waite 1980), then the minimax polynomials of Cephes' sinf.c on
 * [-pi/4, pi/4] (S. Moshier, public). Absolute error below 1e-7 for |x| <= 1e3; NaN and infinity give NaN.
 * The arctangent is that of Cephes' atanf.c, with a relative error below 3e-7.
 */
#ifndef DRAWBAR_LANE_TRIGONOMETRY_H
#define DRAWBAR_LANE_TRIGONOMETRY_H

#include <math.h>
#include <stdint.h>
#include "ieee.h"
#include "lane_loops.h"

/* Adding 1.5 * 2^23 rounds to the nearest integer, which the last bits of the sum then hold. */
#define LANE_ROUND 12582912.0f

/* sin(x + turns * pi/2) */
LANE float lane_sine(float x, uint32_t turns)
{
    union { float number; uint32_t bits; } shifted = {x * 0.636619772f + LANE_ROUND}, value;
    const float n = shifted.number - LANE_ROUND;
    const float r = ((x - n * 1.5703125f) - n * 4.837512969970703125e-4f) - n * 7.54978995489188216e-8f;
    const float z = r * r;
    const float s = (((-1.9515295891e-4f * z + 8.3321608736e-3f) * z - 1.6666654611e-1f) * z) * r + r;
    const float c = (((2.443315711809948e-5f * z - 1.388731625493765e-3f) * z + 4.166664568298827e-2f) * z) * z
        + (1.0f - 0.5f * z);
    const uint32_t quarter = shifted.bits + turns;
    value.number = quarter & 1 ? c : s;
    value.bits ^= (quarter & 2) << 30;     /* the sign flips every two quarter turns */
    return value.number;
}

/* atan2(y, x) */
LANE float lane_atan2(float y, float x)
{
    const float high = fabsf(y), wide = fabsf(x);
    const int steep = high > wide;
    const float least = steep ? wide : high, most = steep ? high : wide;
    const int middle = least > 0.4142135623730950f * most;   /* of the first eighth of a turn: pi/4 and what is left */
    const float below = middle ? least + most : most;
    const float t = (middle ? least - most : least) / (below == 0.0f ? 1.0f : below), z = t * t;
    const float p = (((8.05374449538e-2f * z - 1.38776856032e-1f) * z + 1.99777106478e-1f) * z - 3.33329491539e-1f) * z;
    const float eighth = (middle ? 0.7853981633974483f : 0.0f) + (t * p + t);
    const float quarter = steep ? 1.5707963267948966f - eighth : eighth;
    return copysignf(x < 0.0f ? 3.14159265358979323846f - quarter : quarter, y);
}

#endif

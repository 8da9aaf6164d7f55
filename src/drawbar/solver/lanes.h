/* Lanes: sine, cosine, tangent and arctangent without branches or library calls, so that a loop over stages becomes SIMD code. */
#ifndef DRAWBAR_LANES_H
#define DRAWBAR_LANES_H

#include <math.h>
#include <stdint.h>
#include "lane_loops.h"
#include "lane_trigonometry.h"

LANE double lane_sin(double x)
{
    return lane_sine(x, 0);
}

LANE double lane_cos(double x)
{
    return lane_sine(x, 1);
}

LANE double lane_tan(double x)
{
    return lane_sine(x, 0) / lane_sine(x, 1);
}

LANE double lane_atan(double x)
{
    return lane_atan2(x, 1.0);
}

/* Write those of four numbers side by side that `which` has a bit for; the others are zeros, and stay what they are. In units
 * whose matrices lie in packs (packs.h) it is one store instead of four. */
LANE void write_four(double *to, int which, double a, double b, double c, double d)
{
#if defined(PACK) && PACK > 1
    (void)which;
    write_pack(to, 0, ((pack){a, b, c, d}));
#else
    if (which & 1)
        to[0] = a;
    if (which & 2)
        to[1] = b;
    if (which & 4)
        to[2] = c;
    if (which & 8)
        to[3] = d;
#endif
}

#endif

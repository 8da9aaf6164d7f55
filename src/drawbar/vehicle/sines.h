/* Sines and cosines of many angles, in SIMD lanes; the code stands once. */
#ifndef DRAWBAR_SINES_H
#define DRAWBAR_SINES_H

#include "noinline.h"
#include "lanes.h"

/* Before a loop that costs little: clang would make ten times the code of it. */
#if defined(__clang__)
#define AS_IT_STANDS _Pragma("clang loop vectorize(disable) unroll(disable)")
#else
#define AS_IT_STANDS
#endif

/* Of so many angles, rad. */
static NOINLINE void sines_of(const double *restrict angles, int count, double *restrict cosines, double *restrict sines)
{
    for (int k = 0; k < count; ++k) {
        cosines[k] = lane_cos(angles[k]);
        sines[k] = lane_sin(angles[k]);
    }
}

#endif

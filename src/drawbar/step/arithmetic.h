/* Arithmetic, tried out: not every compiler tells by a macro (ieee.h) that it takes sums in another order, or NaN for a number. */
#ifndef DRAWBAR_STEP_ARITHMETIC_H
#define DRAWBAR_STEP_ARITHMETIC_H

#include <math.h>
#include "ieee.h"
#include "lane_trigonometry.h"

#define SINE_ROUNDING 1e-12                /* largest error of a sine, and more */

/* Whether the library can be trusted as it was compiled. The angle is volatile, so that its sine is computed as all others. */
static int arithmetic_is_sound(void)
{
    const volatile double angle = 2.5;

    return ieee_knows_missing() && fabs(lane_sine(angle, 0) - 0.59847214410395649) <= SINE_ROUNDING;
}

#endif

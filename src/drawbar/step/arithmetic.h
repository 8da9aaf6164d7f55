/* Arithmetic, tried out: not every compiler tells by a macro (ieee.h) that it takes sums in another order, or NaN for a number. */
#ifndef DRAWBAR_STEP_ARITHMETIC_H
#define DRAWBAR_STEP_ARITHMETIC_H

#include "ieee.h"
#include "lane_trigonometry.h"

/* Whether the library can be trusted as it was compiled: NaN is no number, and a number is rounded as sines round theirs. */
static int arithmetic_is_sound(void)
{
    const volatile double given = 1.6;     /* volatile: the compiler must not know it */

    return ieee_knows_missing() && (given + LANE_ROUND) - LANE_ROUND == 2.0;
}

#endif

/* Sine of a lane, without branches or library calls.
 *
 * Argument reduction by pi/2 in three parts (Cody and Waite 1980), then the minimax polynomials of Cephes'
 * sin.c on [-pi/4, pi/4] (S. Moshier, public). Absolute error below 3e-16 for |x| <= 1e5; NaN and infinity give NaN.
 */
#ifndef DRAWBAR_LANE_SINE_H
#define DRAWBAR_LANE_SINE_H

#include <stdint.h>
#include "lane_loops.h"

/* Adding 1.5 * 2^52 rounds to the nearest integer, which the last bits of the sum then hold. */
#define LANE_ROUND 6755399441055744.0

/* sin(x + turns * pi/2) */
LANE double lane_sine(double x, uint64_t turns)
{
    union { double number; uint64_t bits; } shifted = {x * 0.63661977236758134308 + LANE_ROUND}, value;
    const double n = shifted.number - LANE_ROUND;
    const double r = ((x - n * 1.57079625129699707031) - n * 7.54978941586159635335e-8) - n * 5.39030285815811905182e-15;
    const double z = r * r;
    const double s = ((((((1.58962301576546568060e-10 * z - 2.50507477628578072866e-8) * z + 2.75573136213857245213e-6) * z
                         - 1.98412698295895385996e-4) * z + 8.33333333332211858878e-3) * z
                       - 1.66666666666666307295e-1) * z) * r + r;
    const double c = ((((((-1.13585365213876817300e-11 * z + 2.08757008419747316778e-9) * z - 2.75573141792967388112e-7) * z
                         + 2.48015872888517045348e-5) * z - 1.38888888888730564116e-3) * z
                       + 4.16666666666665929218e-2) * z) * z + (1.0 - 0.5 * z);
    const uint64_t quarter = shifted.bits + turns;
    value.number = quarter & 1 ? c : s;
    value.bits ^= (quarter & 2) << 62;     /* the sign flips every two quarter turns */
    return value.number;
}

#endif

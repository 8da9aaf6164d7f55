/* Lane trigonometry: sine and arctangent of a lane, without branches or library calls.
 *
 * Argument reduction by pi/2 in three parts (Cody and Waite 1980), then the minimax polynomials of Cephes'
 * sin.c on [-pi/4, pi/4] (S. Moshier, public). Absolute error below 3e-16 for |x| <= 1e5; NaN and infinity give NaN.
 * The arctangent is that of Cephes' atan.c, with a relative error below 5e-16.
 */
#ifndef DRAWBAR_LANE_TRIGONOMETRY_H
#define DRAWBAR_LANE_TRIGONOMETRY_H

#include <math.h>
#include <stdint.h>
#include "ieee.h"
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

/* atan2(y, x) */
LANE double lane_atan2(double y, double x)
{
    const double high = fabs(y), wide = fabs(x);
    const int steep = high > wide;
    const double least = steep ? wide : high, most = steep ? high : wide;
    const int middle = least > 0.66 * most;       /* of the first eighth of a turn: pi/4 and what is left */
    const double below = middle ? least + most : most;
    const double t = (middle ? least - most : least) / (below == 0.0 ? 1.0 : below), z = t * t;
    const double p = ((((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z - 7.500855792314704667340e1) * z
                       - 1.228866684490136173410e2) * z - 6.485021904942025371773e1) * z;
    const double q = ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z + 4.328810604912902668951e2) * z
                      + 4.853903996359136964868e2) * z + 1.945506571482613964425e2;
    const double eighth = (middle ? 7.85398163397448309616e-1 : 0.0) + (t * (p / q) + t);
    const double quarter = steep ? 1.57079632679489661923 - eighth : eighth;
    return copysign(x < 0.0 ? 3.14159265358979323846 - quarter : quarter, y);
}

#endif

/* Swings to both sides of a signal that ought to be near zero: a loop that oscillates rather than settles.
 *
 * A half wave ends where the signal is on the other side of zero by half of the threshold. One counts if its peak is beyond
 * the threshold, or its mean with the one before is, if it did not take longer than LONGEST_SWING, and if it is not clearly
 * smaller than the one before, or than the last one on its own side: what dies away by itself (a bump, the way onto the
 * line) is no oscillation, but one about a place beside zero is.
 */
#ifndef DRAWBAR_SWINGS_H
#define DRAWBAR_SWINGS_H

#include <math.h>
#include <stdint.h>
#include <string.h>
#include "noinline.h"

#define LONGEST_SWING 8.0                  /* s */
#define STILL_SWINGING 0.7                 /* least share of a peak before it */

struct swings {
    double peak, before, earlier;          /* of this half wave, so far, and of the two before; 0: there was none */
    double lasted;                         /* this half wave, s */
    int32_t side;                          /* 1: it is to the left, -1: to the right, 0: none yet */
    int32_t count;                         /* half waves in a row that count */
};

/* Update with the signal after an elapsed time (s); returns the number of consecutive half waves that are swings. */
static NOINLINE int32_t swings_update(struct swings *swings, double elapsed, double signal, double threshold)
{
    const int32_t side = signal > 0.5 * threshold ? 1 : signal < -0.5 * threshold ? -1 : 0;

    swings->lasted += elapsed;
    if (!isfinite(signal) || swings->lasted > LONGEST_SWING)
        memset(swings, 0, sizeof *swings);
    if (side != 0 && side != swings->side) {
        const double last = swings->earlier > 0.0 ? fmin(swings->before, swings->earlier) : swings->before;
        const double size = fmax(swings->peak, 0.5 * (swings->peak + swings->before));
        const int counts = size > threshold && swings->peak >= STILL_SWINGING * last;
        swings->count = counts ? swings->count + 1 : 0;
        swings->earlier = swings->before;
        swings->before = swings->peak;
        swings->peak = swings->lasted = 0.0;
        swings->side = side;
    }
    if (swings->side != 0)
        swings->peak = fmax(swings->peak, swings->side * signal);
    return swings->count;
}

#endif

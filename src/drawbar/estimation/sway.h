/* Sway: the variance of fixes by the lateral motion of antennas on masts that no attitude sensor measures.
 *
 * On uneven ground these errors are correlated over seconds and larger than the fixes' white noise, so an estimate that weights
 * the fixes by their white noise follows the masts. Their variance shows in the lateral difference of both antennas'
 * innovations, averaged over a second (suspicion.h): white noise averages out, and slopes move both antennas alike.
 */
#ifndef DRAWBAR_SWAY_H
#define DRAWBAR_SWAY_H

#include <math.h>
#include "suspicion.h"

#define SWAY_WHITE 0.45                    /* standard deviation of the averaged difference by white noise, per a fix's */
#define SWAY_WHITE_LIMIT 0.6               /* the same with a margin: it is estimated from BASELINE_MEMORY samples */
#define SWAY_PRIOR_SAMPLES 25.0            /* weight of the prior, white noise alone, in samples */
#define SWAY_WEIGHT 4.0                    /* variance per mean square of the difference: one antenna has half of it, and errors
                                            * whose correlation from sample to sample is r count (1 + r) / (1 - r) fold: r = 0.78 */

/* The variance of a fix by sway, m2; deviation: of its white noise, m. */
static inline double sway_variance(const struct suspicion *suspicion, double deviation)
{
    const double white = SWAY_WHITE * deviation, white_limit = SWAY_WHITE_LIMIT * deviation;
    const double mean_square = (SWAY_PRIOR_SAMPLES * white * white + suspicion->baseline_samples * suspicion->baseline[1])
        / (SWAY_PRIOR_SAMPLES + suspicion->baseline_samples);

    return SWAY_WEIGHT * fmax(mean_square - white_limit * white_limit, 0.0);
}

#endif

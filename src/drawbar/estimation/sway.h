/* Sway: how far antennas on masts swing across the vehicle, where no attitude sensor tells it.
 *
 * On uneven ground such errors last for seconds and are larger than the noise of the fixes, so an estimate that believes the
 * fixes follows the masts. What shows the sway is by how much the antennas usually disagree across the vehicle, averaged over
 * a second (suspicion.h): white noise averages out, and slopes move both antennas alike.
 */
#ifndef DRAWBAR_SWAY_H
#define DRAWBAR_SWAY_H

#include <math.h>
#include "suspicion.h"

#define SWAY_WHITE 0.45                    /* of a fix's deviation that averaged disagreement has by white noise */
#define SWAY_MOST_WHITE 0.6                /* the same with a margin: it is known from USUAL_MEMORY samples */
#define SWAY_BEFORE 25.0                   /* samples of white noise that are taken to have been before the first */
#define SWAY_WEIGHT 4.0                    /* variance per mean square of the disagreement: one antenna has half of it, and errors
                                            * whose correlation from sample to sample is r count (1 + r) / (1 - r) fold: r = 0.78 */

/* The variance that a fix has by sway, m2; deviation: its white one, m. */
static inline double sway_variance(const struct suspicion *suspicion, double deviation)
{
    const double white = SWAY_WHITE * deviation, most = SWAY_MOST_WHITE * deviation;
    const double usual = (SWAY_BEFORE * white * white + suspicion->learned * suspicion->usual[1])
        / (SWAY_BEFORE + suspicion->learned);

    return SWAY_WEIGHT * fmax(usual - most * most, 0.0);
}

#endif

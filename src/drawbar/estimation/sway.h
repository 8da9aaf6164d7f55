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

#define SWAY_WHITE 0.75                    /* of a fix's deviation that averaged disagreement has without sway, with a margin */
#define SWAY_WEIGHT 4.0                    /* variance per mean square of the disagreement: one antenna has half of it, and errors
                                            * whose correlation from sample to sample is r count (1 + r) / (1 - r) fold: r = 0.78 */
#define SWAY_BEFORE 25.0                   /* samples without sway that are taken to have been before the first */

/* The variance that a fix has by sway, m2; deviation: its white one, m. */
static inline double sway_variance(const struct suspicion *suspicion, double deviation)
{
    const double white = SWAY_WHITE * deviation, beyond = suspicion->usual[1] - white * white;

    return SWAY_WEIGHT * suspicion->learned / (SWAY_BEFORE + suspicion->learned) * fmax(beyond, 0.0);
}

#endif

/* Trust in two antennas: when they are to be believed more than the estimate.
 *
 * Two antennas that agree with each other cannot be locked out by an estimate that is wrong. An estimate that both have
 * confirmed for some time is overruled by both only: then it was moved by more than it can know (a new base station, a
 * tow). Before that one suffices, twice in a row: its yaw, say, was wrong from the start.
 */
#ifndef DRAWBAR_TRUST_H
#define DRAWBAR_TRUST_H

#include <math.h>
#include <stdint.h>
#include "geometry.h"

#define AGAIN 1e-3                         /* s; shorter than any sample */

struct lasting {
    time_stamp since;
    int32_t holds;
};

struct trust {
    struct lasting contradicted, confirmed;
    int32_t earned;                        /* both antennas have confirmed the estimate for long enough */
};

/* Take in whether something holds at this time; returns whether it has for as long as that (s). */
static inline int lasts(struct lasting *lasting, double time, int holds, double patience)
{
    if (!lasting->holds || !isfinite(lasting->since))
        lasting->since = time;
    lasting->holds = holds;
    return holds && time - lasting->since >= patience;
}

/* Has the estimate been contradicted for long enough: for the patience (s) where it has earned trust, else twice in a
 * row? It then has to earn its trust anew.
 *
 * agreeing: both antennas have a fix, as far from each other as they should be; rejected: how many of the two are. */
static inline int trust_overruled(struct trust *trust, double time, int agreeing, int rejected, double patience)
{
    const int contradicted = agreeing && rejected > (trust->earned ? 1 : 0);
    const double long_enough = trust->earned ? patience : AGAIN;

    trust->earned |= lasts(&trust->confirmed, time, agreeing && rejected == 0, patience);
    if (!lasts(&trust->contradicted, time, contradicted, long_enough))
        return 0;
    trust->earned = trust->contradicted.holds = 0;
    return 1;
}

#endif

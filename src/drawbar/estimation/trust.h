/* Trust in two antennas: when their fixes overrule the estimate.
 *
 * Two antennas that agree with each other cannot be locked out by a wrong estimate. An estimate that both have confirmed for
 * some time is overruled by both only: then the positions have shifted without a measured motion (a new base station, a tow).
 * Before that one rejected fix suffices, twice in a row: the first yaw, for one, may have been wrong.
 */
#ifndef DRAWBAR_TRUST_H
#define DRAWBAR_TRUST_H

#include <math.h>
#include <stdint.h>
#include "geometry.h"

#define AGAIN 1e-3                         /* s; shorter than any sample */

struct condition {
    time_stamp since;
    int32_t holds;
};

struct trust {
    struct condition contradicted, confirmed;
    int32_t earned;                        /* both antennas have confirmed the estimate for long enough */
};

/* Update with whether a condition holds at this time; returns whether it has for the patience (s). */
static inline int has_held(struct condition *condition, double time, int holds, double patience)
{
    if (!condition->holds || !isfinite(condition->since))
        condition->since = time;
    condition->holds = holds;
    return holds && time - condition->since >= patience;
}

/* Whether the estimate has been contradicted for long enough: for the patience (s) where it has earned trust, else twice in a
 * row. Its trust is reset then.
 *
 * agreeing: both antennas have a fix, at the right distance from each other; rejected: how many of the two are. */
static inline int trust_overruled(struct trust *trust, double time, int agreeing, int rejected, double patience)
{
    const int contradicted = agreeing && rejected > (trust->earned ? 1 : 0);
    const double long_enough = trust->earned ? patience : AGAIN;

    trust->earned |= has_held(&trust->confirmed, time, agreeing && rejected == 0, patience);
    if (!has_held(&trust->contradicted, time, contradicted, long_enough))
        return 0;
    trust->earned = trust->contradicted.holds = 0;
    return 1;
}

#endif

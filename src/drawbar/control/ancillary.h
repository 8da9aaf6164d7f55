/* The ancillary law of tube-based control: u = u- + K (x - x-) (equation robustcontrollaw).
 *
 * Holds one body to its nominal state, whatever the neighbour and the ground did, and watches its tube. While the
 * deviation is in the tube, and the plan within its tightened bounds, the sum respects the bound on the command by
 * itself. Outside, or where no tube is declared, it is clipped to the bound and the clip is reported.
 */
#ifndef DRAWBAR_ANCILLARY_H
#define DRAWBAR_ANCILLARY_H

#include "geometry.h"
#include "signals.h"
#include "unit.h"

#define MOST_DEVIATIONS 4
#define MOST_FACETS 8

struct component {
    double limit;                          /* largest command, rad */
    int32_t count;                         /* number of the law's coordinates; 0: no law */
    int32_t facet_count;
    double gain[MOST_DEVIATIONS];          /* K: rad per error */
    double facets[MOST_FACETS][MOST_DEVIATIONS];   /* directions in which the margin is measured */
    double heights[MOST_FACETS];           /* how far x^ - x- can be in these directions */
};

#define COMPONENT_FIELDS                                                                                         \
    SETTING(component, limit, 0, 1, 0, 0) SETTING(component, count, 1, 1, 0, 0)                                       \
    SETTING(component, facet_count, 1, 1, 0, 0) SETTING(component, gain, 0, MOST_DEVIATIONS, 0, 0)                    \
    SETTING(component, facets, 0, MOST_FACETS, MOST_DEVIATIONS, 0) SETTING(component, heights, 0, MOST_FACETS, 0, 0)

static inline double weighted_sum(const double *weights, const double *values, int count)
{
    double sum = 0.0;

    for (int i = 0; i < count; ++i)
        sum += weights[i] * values[i];
    return sum;
}

/* How far a deviation is from leaving the tube: 1 at the centre, 0 on the boundary, NaN without a set. Measured along the
 * bounded coordinates and the quantities that the bounds are on: negative is surely outside. */
static inline double tube_margin(const struct component *law, const double *deviation)
{
    double largest = law->facet_count > 0 ? 0.0 : (double)NAN;

    for (int i = 0; i < law->facet_count; ++i) {
        const double share = fabs(weighted_sum(law->facets[i], deviation, law->count)) / law->heights[i];
        largest = share <= largest ? largest : share;
    }
    return 1.0 - largest;
}

/* The steering to command now, from the newest nominal plan and the deviation that it states. What is not finite is no
 * command to clip: it goes on to the gate, which refuses it. */
int UNIT(apply)(const struct component *law, const struct drawbar_body_plan *plan,
                struct drawbar_body_steering *steering)
{
    const int held = law->count > 0 && plan->deviations == law->count;
    const double ancillary = held ? weighted_sum(law->gain, plan->deviation, law->count) : 0.0;
    const double total = plan->steering + ancillary;

    steering->nominal = plan->steering;
    steering->ancillary = ancillary;
    steering->command = clipped(total, law->limit);
    steering->margin = held ? tube_margin(law, plan->deviation) : (double)NAN;
    steering->saturated = isfinite(total) && fabs(total) > law->limit;
    return 0;
}

#endif

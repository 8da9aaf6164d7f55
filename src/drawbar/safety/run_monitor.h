/* Run monitor: whether a run may go on; it watches what the controllers cannot mend.
 *
 * Without a fix a vehicle is led by its wheels: after the distance s its heading is off by theta and the curvature that
 * it steers by delta / L, so that it is s hypot(theta, delta s / 2 L) off its line (standard deviations, docs/safety.md).
 */
#ifndef DRAWBAR_RUN_MONITOR_H
#define DRAWBAR_RUN_MONITOR_H

#include <math.h>
#include "geometry.h"
#include "signals.h"
#include "unit.h"

struct component {
    double lost;                           /* distance from the path at which a run is given up, m */
    double blind;                          /* time without a fix of either antenna after which it is, s */
    double blind_deviation;                /* standard deviation of the position across at which it is, m */
    double heading, bend;                  /* theta, rad; delta / 2 L, 1/m */
    double distance;                       /* since the last fix, m */
    time_stamp last_fix, now;
    int32_t begun;
};

#define COMPONENT_FIELDS SETTING(component, lost, 0, 1, 0, 0) SETTING(component, blind, 0, 1, 0, 0) \
    SETTING(component, blind_deviation, 0, 1, 0, 0) SETTING(component, heading, 0, 1, 0, 0)                          \
    SETTING(component, bend, 0, 1, 0, 0) FIELD(component, distance, 0, 1, 0, 0)

/* Standard deviation of the position across the line after the distance since the last fix, m. */
static inline double lateral_deviation(const struct component *monitor)
{
    return monitor->distance * hypot(monitor->heading, monitor->bend * monitor->distance);
}

/* Look at one step's estimate and the tractor's reference. A fix counts if it was believed; one that a receiver repeats
 * is none. */
int UNIT(watch)(struct component *monitor, const struct drawbar_estimate *estimate,
                const struct drawbar_body_reference *tractor)
{
    const int fix = estimate->tractor_fix == DRAWBAR_FIX_ACCEPTED || estimate->trailer_fix == DRAWBAR_FIX_ACCEPTED;

    if (fix || !monitor->begun) {
        monitor->last_fix = monitor->now = estimate->time;
        monitor->distance = 0.0;
    }
    const double elapsed = estimate->time - monitor->now;
    monitor->distance += fabs(estimate->speed) * elapsed;
    monitor->now = estimate->time;
    monitor->begun = 1;
    if (!(fabs(tractor->lateral_error) <= monitor->lost)) /* also when it is NaN */
        return OFF_COURSE;
    if (estimate->time - monitor->last_fix > monitor->blind
        || !(lateral_deviation(monitor) <= monitor->blind_deviation))
        return BLIND;
    return ON_COURSE;
}

#endif

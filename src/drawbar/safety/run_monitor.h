/* Run monitor: whether a run may continue: the tractor is near the path, and fixes are recent.
 *
 * Without a fix the vehicle is guided by dead reckoning: after the distance s, with the errors theta of the heading and delta / L
 * of the curvature, its lateral position has the standard deviation s hypot(theta, delta s / 2 L) (docs/safety.md).
 */
#ifndef DRAWBAR_RUN_MONITOR_H
#define DRAWBAR_RUN_MONITOR_H

#include <math.h>
#include "geometry.h"
#include "signals.h"
#include "unit.h"

struct component {
    double lost;                           /* largest distance from the path, m */
    double blind;                          /* longest time without a fix of either antenna, s */
    double blind_deviation;                /* largest standard deviation of the lateral position, m */
    double heading, bend;                  /* theta, rad; delta / 2 L, 1/m */
    double distance;                       /* since the last fix, m */
    time_stamp last_fix, last_time;
    int32_t initialised;
};

#define COMPONENT_FIELDS SETTING(component, lost, 0, 1, 0, 0) SETTING(component, blind, 0, 1, 0, 0) \
    SETTING(component, blind_deviation, 0, 1, 0, 0) SETTING(component, heading, 0, 1, 0, 0)                          \
    SETTING(component, bend, 0, 1, 0, 0) FIELD(component, distance, 0, 1, 0, 0)

/* Standard deviation of the lateral position after the distance since the last fix, m. */
static inline double lateral_deviation(const struct component *monitor)
{
    return monitor->distance * hypot(monitor->heading, monitor->bend * monitor->distance);
}

/* Judge one step's estimate and the tractor's reference; returns enum monitor_verdict. Only accepted fixes count: repeated ones
 * are stale. */
int UNIT(watch)(struct component *monitor, const struct drawbar_estimate *estimate,
                const struct drawbar_body_reference *tractor)
{
    const int fix = estimate->tractor_fix == DRAWBAR_FIX_ACCEPTED || estimate->trailer_fix == DRAWBAR_FIX_ACCEPTED;

    if (fix || !monitor->initialised) {
        monitor->last_fix = monitor->last_time = estimate->time;
        monitor->distance = 0.0;
    }
    const double elapsed = estimate->time - monitor->last_time;
    monitor->distance += fabs(estimate->speed) * elapsed;
    monitor->last_time = estimate->time;
    monitor->initialised = 1;
    if (!(fabs(tractor->lateral_error) <= monitor->lost)) /* also when it is NaN */
        return OFF_COURSE;
    if (estimate->time - monitor->last_fix > monitor->blind
        || !(lateral_deviation(monitor) <= monitor->blind_deviation))
        return BLIND;
    return ON_COURSE;
}

#endif

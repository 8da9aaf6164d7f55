/* Run monitor: whether a run may continue: the tractor is near the path, and fixes are recent.
 *
 * On the way onto the path the tractor may be as far from it as a start allows. Once it has followed the path it must stay nearer:
 * else its steering does not suffice, or does not do what is commanded.
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

#define ON_PATH 0.1                        /* distance from the path within which the tractor follows it, m, */
#define FOLLOWS_AFTER 5.0                  /* once it has been for so long, m */

struct component {
    double lost;                           /* largest distance from the path, m */
    double leaving;                        /* the same once the tractor has followed it, m */
    double blind;                          /* longest time without a fix of either antenna, s */
    double blind_deviation;                /* largest standard deviation of the lateral position, m */
    double heading, bend;                  /* theta, rad; delta / 2 L, 1/m */
    double distance;                       /* since the last fix, m */
    double followed;                       /* travelled on the path, m; no longer updated beyond FOLLOWS_AFTER */
    time_stamp last_fix, last_time;
    int32_t initialised;
};

#define COMPONENT_FIELDS SETTING(component, lost, 0, 1, 0, 0) SETTING(component, leaving, 0, 1, 0, 0) \
    SETTING(component, blind, 0, 1, 0, 0)                                                                            \
    SETTING(component, blind_deviation, 0, 1, 0, 0) SETTING(component, heading, 0, 1, 0, 0)                          \
    SETTING(component, bend, 0, 1, 0, 0) FIELD(component, distance, 0, 1, 0, 0) \
    FIELD(component, followed, 0, 1, 0, 0)

/* Standard deviation of the lateral position after the distance since the last fix, m. */
static inline double lateral_deviation(const struct component *monitor)
{
    return monitor->distance * hypot(monitor->heading, monitor->bend * monitor->distance);
}

/* Update with a travelled distance and the distance from the path, m; returns how far from the path the tractor may be, m. */
static inline double largest_error(struct component *monitor, double travelled, double error)
{
    if (monitor->followed < FOLLOWS_AFTER)
        monitor->followed = fabs(error) <= ON_PATH ? monitor->followed + travelled : 0.0;
    return monitor->followed < FOLLOWS_AFTER ? monitor->lost : fmin(monitor->leaving, monitor->lost);
}

/* Begin the way onto another path. */
void UNIT(rejoin)(struct component *monitor)
{
    monitor->followed = 0.0;
}

/* Judge one step's estimate and the tractor's reference; returns enum monitor_verdict. Only accepted fixes count: repeated ones
 * are stale. released: somebody else steers, who need not follow the path. */
int UNIT(watch)(struct component *monitor, const struct drawbar_estimate *estimate,
                const struct drawbar_body_reference *tractor, int released)
{
    const int fix = estimate->tractor_fix == DRAWBAR_FIX_ACCEPTED || estimate->trailer_fix == DRAWBAR_FIX_ACCEPTED;
    const double elapsed = monitor->initialised ? estimate->time - monitor->last_time : 0.0;
    const double travelled = fabs(estimate->speed) * elapsed;

    if (fix || !monitor->initialised) {
        monitor->last_fix = estimate->time;
        monitor->distance = 0.0;
    } else {
        monitor->distance += travelled;
    }
    monitor->last_time = estimate->time;
    monitor->initialised = 1;
    if (released)
        UNIT(rejoin)(monitor);
    if (!(fabs(tractor->lateral_error) <= largest_error(monitor, travelled, tractor->lateral_error))) /* also when it is NaN */
        return OFF_COURSE;
    if (estimate->time - monitor->last_fix > monitor->blind
        || !(lateral_deviation(monitor) <= monitor->blind_deviation))
        return BLIND;
    return ON_COURSE;
}

#endif

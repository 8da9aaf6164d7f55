/* Supervisor: whether a run may go on; it watches what the controllers cannot mend.
 *
 * Without a fix a vehicle is led by its wheels: after the distance s its heading is off by theta and the curvature that
 * it steers by delta / L, so that it is s hypot(theta, delta s / 2 L) off its line (standard deviations, docs/safety.md).
 */
#ifndef DRAWBAR_SUPERVISOR_H
#define DRAWBAR_SUPERVISOR_H

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
static inline double lateral_deviation(const struct component *supervisor)
{
    return supervisor->distance * hypot(supervisor->heading, supervisor->bend * supervisor->distance);
}

/* Look at one step's estimate and the tractor's reference. A fix counts if it was believed; one that a receiver repeats
 * is none. */
int UNIT(watch)(struct component *supervisor, const struct drawbar_estimate *estimate,
                const struct drawbar_body_reference *tractor)
{
    const int fix = estimate->tractor_fix == DRAWBAR_FIX_ACCEPTED || estimate->trailer_fix == DRAWBAR_FIX_ACCEPTED;

    if (fix || !supervisor->begun) {
        supervisor->last_fix = supervisor->now = estimate->time;
        supervisor->distance = 0.0;
    }
    const double elapsed = estimate->time - supervisor->now;
    supervisor->distance += fabs(estimate->speed) * elapsed;
    supervisor->now = estimate->time;
    supervisor->begun = 1;
    if (!(fabs(tractor->lateral_error) <= supervisor->lost)) /* also when it is NaN */
        return OFF_COURSE;
    if (estimate->time - supervisor->last_fix > supervisor->blind
        || !(lateral_deviation(supervisor) <= supervisor->blind_deviation))
        return BLIND;
    return ON_COURSE;
}

#endif

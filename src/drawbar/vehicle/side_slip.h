/* Side-slip of an axle: how it changes with where the axle faces and how it turns, on ground that gives way under the
 * wheels (docs/theory/lever-arm.md). */
#ifndef DRAWBAR_SIDE_SLIP_H
#define DRAWBAR_SIDE_SLIP_H

#include <math.h>
#include "geometry.h"
#include "signals.h"
#include "sines.h"

/* By how much the side-slip angles (left positive, rad) that slope and curve give an axle at the estimated speed change along a
 * path from its first sample (x, y, yaw, curvature) to each of `count`; not at all where the path is no path, so that what was
 * planned before stays finite. The cosines and sines are those of the yaws. */
static inline void side_slip_changes(const struct drawbar_estimate *estimate, const double (*samples)[4], int count,
                                     double *changes, double *cosines, double *sines)
{
    const double speed = estimate->longitudinal_slip * estimate->speed, bend = estimate->creep * speed * speed / GRAVITY;
    double first = 0.0;

    AS_IT_STANDS for (int k = 0; k < count; ++k)
        changes[k] = samples[k][AT_YAW];
    sines_of(changes, count, cosines, sines);
    AS_IT_STANDS for (int k = 0; k < count; ++k) {
        const double slip = estimate->slide_north * cosines[k] - estimate->slide_east * sines[k] - bend * samples[k][AT_CURVATURE];
        first = k > 0 ? first : slip;
        changes[k] = isfinite(slip - first) ? slip - first : 0.0;
    }
}

#endif

/* Side-slip of an axle: how it changes with where the axle faces and how it turns, on ground that gives way under the
 * wheels (docs/theory/lever-arm.md). */
#ifndef DRAWBAR_SIDE_SLIP_H
#define DRAWBAR_SIDE_SLIP_H

#include <math.h>
#include "geometry.h"
#include "signals.h"

/* The side-slip angle (left positive, rad) that slope and curve give an axle with this yaw (rad) on this curvature (1/m), at
 * the estimated speed. */
static inline double side_slip(const struct drawbar_estimate *estimate, double yaw, double curvature)
{
    const double speed = estimate->longitudinal_slip * estimate->speed;

    return estimate->slide_north * cos(yaw) - estimate->slide_east * sin(yaw)
        - estimate->creep * speed * speed * curvature / GRAVITY;
}

/* By how much side-slip angles (rad) change along a path from its first sample to another (x, y, yaw, curvature); not at all
 * where the path is no path, so that what was planned before stays finite. */
static inline double side_slip_change(const struct drawbar_estimate *estimate, const double *first, const double *other)
{
    const double change = side_slip(estimate, other[AT_YAW], other[AT_CURVATURE])
        - side_slip(estimate, first[AT_YAW], first[AT_CURVATURE]);

    return isfinite(change) ? change : 0.0;
}

#endif

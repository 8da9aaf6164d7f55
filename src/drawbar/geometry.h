/* Geometry: angles and gravity, as in geometry.py, rows of numbers that are poses, and times. */
#ifndef DRAWBAR_GEOMETRY_H
#define DRAWBAR_GEOMETRY_H

#include <math.h>
#include "ieee.h"

#define DRAWBAR_PI 3.14159265358979323846
#define GRAVITY 9.81                       /* m/s^2 */

/* A pose as a row of numbers, m and rad; a sample of a path is one that also has the curvature there, 1/m. */
enum { AT_X, AT_Y, AT_YAW, AT_CURVATURE };

typedef double time_stamp;                 /* s, of any steady clock; a double in single precision, too */
#define BETWEEN_FIXES 0.9                  /* longest time between two fixes of a receiver that reports less often than samples are
                                            * taken, s */

/* The angle in [-pi, pi), rad; for differences only, never for states. */
static inline double wrapped(double angle)
{
    return angle - 2.0 * DRAWBAR_PI * floor((angle + DRAWBAR_PI) / (2.0 * DRAWBAR_PI));
}

/* The angle shifted by a multiple of 2 pi to within pi of the target, rad. */
static inline double nearest_branch(double angle, double target)
{
    return angle + 2.0 * DRAWBAR_PI * floor((target - angle) / (2.0 * DRAWBAR_PI) + 0.5);
}

static inline double clamped(double value, double low, double high)
{
    return fmin(fmax(value, low), high);
}

/* The angle within +-limit, rad; one that is not finite stays, for the gate to refuse. */
static inline double clipped(double angle, double limit)
{
    return isfinite(angle) ? clamped(angle, -limit, limit) : angle;
}

#endif

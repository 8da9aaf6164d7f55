/* Where the nominal problem starts, and how far the vehicle is from there (Mayne et al. 2005, section 3).
 *
 * A nominal controller does not hold the vehicle to a timetable: what separates the nominal state from the estimate along
 * the path is no error. Before the two are compared the nominal state moves along the path to beside the estimate.
 */
#ifndef DRAWBAR_NOMINAL_STATE_H
#define DRAWBAR_NOMINAL_STATE_H

#include "geometry.h"

/* Move a pose x, y (m), yaw (rad) along the path to the estimate's closest point (x, y, yaw, curvature, which is taken as
 * constant on the way); its offset and heading to the path stay. */
static inline void move_beside(double *pose, const double *closest)
{
    const double cosine = cos(closest[2]), sine = sin(closest[2]), curvature = closest[3];
    const double east = pose[0] - closest[0], north = pose[1] - closest[1];
    const double ahead = cosine * east + sine * north, left = cosine * north - sine * east;
    const double outward = 1.0 - curvature * left;
    /* distances from the circle of curvature, without the difference of two large radii */
    const double offset = (2.0 * left - curvature * (ahead * ahead + left * left))
        / (1.0 + hypot(outward, curvature * ahead));

    pose[0] = closest[0] - offset * sine;
    pose[1] = closest[1] + offset * cosine;
    pose[2] -= atan2(curvature * ahead, outward);
}

/* Lateral (m) and heading (rad) in the nominal heading's frame, then the remaining states: n - 1 values of states (n). */
static inline void pose_deviation(const double *estimated, const double *nominal, int n, double *deviation)
{
    const double east = estimated[0] - nominal[0], north = estimated[1] - nominal[1];

    deviation[0] = cos(nominal[2]) * north - sin(nominal[2]) * east;
    deviation[1] = wrapped(estimated[2] - nominal[2]);
    for (int i = 3; i < n; ++i)
        deviation[i - 1] = estimated[i] - nominal[i];
}

/* The difference of states (n) that are angles or lengths of the body itself; the first is a yaw's. */
static inline void plain_deviation(const double *estimated, const double *nominal, int n, double *deviation)
{
    deviation[0] = wrapped(estimated[0] - nominal[0]);
    for (int i = 1; i < n; ++i)
        deviation[i] = estimated[i] - nominal[i];
}

#endif

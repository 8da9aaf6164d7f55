/* Nominal state: where the nominal problem starts, and how far the vehicle is from there (Mayne et al. 2005, section
 * 3).
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
    const double cosine = cos(closest[AT_YAW]), sine = sin(closest[AT_YAW]), curvature = closest[AT_CURVATURE];
    const double east = pose[AT_X] - closest[AT_X], north = pose[AT_Y] - closest[AT_Y];
    const double ahead = cosine * east + sine * north, left = cosine * north - sine * east;
    const double outward = 1.0 - curvature * left;
    /* distances from the circle of curvature, without the difference of two large radii */
    const double offset = (2.0 * left - curvature * (ahead * ahead + left * left))
        / (1.0 + hypot(outward, curvature * ahead));

    pose[AT_X] = closest[AT_X] - offset * sine;
    pose[AT_Y] = closest[AT_Y] + offset * cosine;
    pose[AT_YAW] -= atan2(curvature * ahead, outward);
}

/* Lateral (m) and heading (rad) in the nominal heading's frame, then the remaining states: n - 1 values of states (n). */
static inline void pose_deviation(const double *estimated, const double *nominal, int n, double *deviation)
{
    const double east = estimated[AT_X] - nominal[AT_X], north = estimated[AT_Y] - nominal[AT_Y];

    deviation[0] = cos(nominal[AT_YAW]) * north - sin(nominal[AT_YAW]) * east;
    deviation[1] = wrapped(estimated[AT_YAW] - nominal[AT_YAW]);
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

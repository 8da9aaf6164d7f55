/* Tracked points: what a body must do for a point of it, such as a tool's, to follow a line.
 *
 * A point that is `ahead` of its body's axle moves in a direction by which the body turns: d yaw / d distance =
 * (direction - yaw) / ahead (small angles). Ahead of the axle that is a lag in the direction of travel; behind it, one
 * against it: the line ahead determines today's yaw. So the body's own point gets a line that leads the tracked point
 * along the path, and no controller needs to steer a point that first moves the wrong way (docs/theory/tracked-points.md).
 * The including unit defines STAGES.
 */
#ifndef DRAWBAR_TRACKED_H
#define DRAWBAR_TRACKED_H

#include <math.h>
#include <string.h>
#include "geometry.h"
#include "side_slip.h"
#include "signals.h"

#define TRACKED_STEEPEST 1.0               /* angle up to which a tracked point moves across its body, rad */

struct tracked {
    double arm[2];                         /* of the tracked point from the body's own: forward, left, m */
    double axle;                           /* the body's own point ahead of its axle, m */
};

static inline int tracked_is_body(const struct tracked *tracked)
{
    return tracked->arm[0] == 0.0 && tracked->arm[1] == 0.0;
}

/* Where a tracked point of a body is whose own point is at x, y (m) and which faces along yaw (rad); `arm`: its place on
 * the body, forward and left, m. */
static inline void tracked_place(const double *arm, double x, double y, double yaw, double *place)
{
    place[0] = x + (arm[0] * cos(yaw) - arm[1] * sin(yaw));
    place[1] = y + (arm[0] * sin(yaw) + arm[1] * cos(yaw));
}

/* The body's own point of which a tracked point is there; the inverse of tracked_place. */
static inline void body_place(const double *arm, double x, double y, double yaw, double *place)
{
    place[0] = x - (arm[0] * cos(yaw) - arm[1] * sin(yaw));
    place[1] = y - (arm[0] * sin(yaw) + arm[1] * cos(yaw));
}

/* One step of how a body turns whose tracked point, `ahead` (m, not 0) of its axle, moves on: the yaw after a way (m,
 * negative: before it) during which the point's direction goes from one to another (rad), both without the side-slip. It is
 * the exact solution of d yaw / d distance = (direction - yaw) / ahead, which small angles and products of `left` are left out
 * of. Stable in the direction in which the axle is behind the point. */
static inline double tracked_turn(double ahead, double distance, double from, double to, double yaw)
{
    const double lag = distance != 0.0 ? ahead * (to - from) / distance : 0.0;

    return to - lag + (yaw - from + lag) * exp(-distance / ahead);
}

/* How far one sample is from another, m. */
static inline double tracked_distance(const double *from, const double *to)
{
    return hypot(to[AT_X] - from[AT_X], to[AT_Y] - from[AT_Y]);
}

/* The yaws (count of them, rad) of a body whose tracked point has these directions at the samples (rad, with the side-slip
 * taken off): from today's yaw on where the point is ahead of the axle, else from the end back, where it turns steadily.
 * A point on the axle moves as the body faces. */
static inline void tracked_yaws(double ahead, double yaw, const double *directions, const double (*samples)[4], int count,
                                double *yaws)
{
    const int last = count - 1, first = ahead > 0.0 ? 0 : last, next = ahead > 0.0 ? 1 : -1;
    const double distance = tracked_distance(samples[last - 1], samples[last]);
    const double steady = directions[last]
        - (distance > 0.0 ? ahead * (directions[last] - directions[last - 1]) / distance : 0.0);

    memcpy(yaws, directions, (size_t)count * sizeof *yaws);
    if (ahead == 0.0)
        return;
    yaws[first] = ahead > 0.0 ? yaw : steady;
    for (int k = first; k != last - first; k += next)
        yaws[k + next] = tracked_turn(ahead, next * tracked_distance(samples[k], samples[k + next]), directions[k],
                                      directions[k + next], yaws[k]);
}

/* The curvature (1/m) of the axle's middle whose body's tracked point (`ahead` of it and to its `left`, m) moves so far
 * (rad) across the body on a curvature, 1/m. */
static inline double tracked_axle(double ahead, double left, double curvature, double across)
{
    const double slope = tan(clipped(across, TRACKED_STEEPEST));

    return ahead != 0.0 ? slope / (ahead + left * slope) : curvature / (1.0 + left * curvature);
}

/* Let the samples of what a tracked point follows become those of the body's own point; yaw and crab angle (rad) are the
 * body's. */
static inline void tracked_body(const struct tracked *tracked, const struct drawbar_estimate *estimate, double yaw,
                                double crab, double (*samples)[4])
{
    const double ahead = tracked->arm[0] + tracked->axle;
    double directions[STAGES + 1], yaws[STAGES + 1], sines[STAGES + 1];

    side_slip_changes(estimate, (const double (*)[4])samples, STAGES + 1, directions, yaws, sines);
    for (int k = 0; k <= STAGES; ++k)
        directions[k] = samples[k][AT_YAW] - crab - directions[k];
    tracked_yaws(ahead, yaw, directions, (const double (*)[4])samples, STAGES + 1, yaws);
    for (int k = 0; k <= STAGES; ++k) {
        double *sample = samples[k];
        const double turn = ahead != 0.0 ? (directions[k] - yaws[k]) / ahead : sample[AT_CURVATURE];
        const double slipped = sample[AT_YAW] - directions[k];

        body_place(tracked->arm, sample[AT_X], sample[AT_Y], yaws[k], sample);
        sample[AT_CURVATURE] = tracked_axle(ahead, tracked->arm[1], sample[AT_CURVATURE], directions[k] - yaws[k]);
        sample[AT_YAW] = yaws[k] + slipped + tracked->axle * turn;
    }
}

#endif

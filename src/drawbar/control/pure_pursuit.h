/* Pure pursuit (R. C. Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, CMU-RI-TR-92-01, 1992).
 *
 * Steers the rear axle along the arc that meets the path one look-ahead distance away:
 * delta = atan(2 L_t sin(alpha) / l_d), alpha the bearing of that point. Neither slip nor the steering's lag is
 * corrected for.
 */
#ifndef DRAWBAR_PURE_PURSUIT_H
#define DRAWBAR_PURE_PURSUIT_H

#include "chain.h"

struct law {
    double look_ahead;                     /* distance of the pursued point along the path, m */
};

#define LAW_FIELDS SETTING(component, law.look_ahead, 0, 1, 0, 0)

/* The pursued point x, y of the path, m. It lies on the arc that leaves the last sample before it; so the path also
 * goes on where the samples end. */
static void goal_point(const double (*samples)[4], double look_ahead, double *goal)
{
    const double *from = samples[0];
    double beyond = look_ahead;

    for (int k = 1; k <= N; ++k) {
        const double chord = hypot(samples[k][AT_X] - from[AT_X], samples[k][AT_Y] - from[AT_Y]);
        if (!(chord <= beyond))
            break;
        beyond -= chord;
        from = samples[k];
    }
    const double bearing = from[AT_YAW] + 0.5 * from[AT_CURVATURE] * beyond;
    goal[AT_X] = from[AT_X] + beyond * cos(bearing);
    goal[AT_Y] = from[AT_Y] + beyond * sin(bearing);
}

static double law_steering(const struct law *law, const struct chain *chain,
                           const struct drawbar_estimate *estimate, const struct drawbar_body_reference *reference)
{
    const struct drawbar_pose *pose = &estimate->tractor;
    double goal[2];

    goal_point(reference->samples, law->look_ahead, goal);
    const double east = goal[AT_X] - pose->x, north = goal[AT_Y] - pose->y, alpha = atan2(north, east) - pose->yaw;
    return atan2(2.0 * chain->wheelbase * sin(alpha), hypot(east, north));
}

#include "explicit.h"

#endif

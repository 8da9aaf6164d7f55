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
        const double chord = hypot(samples[k][0] - from[0], samples[k][1] - from[1]);
        if (!(chord <= beyond))
            break;
        beyond -= chord;
        from = samples[k];
    }
    const double bearing = from[2] + 0.5 * from[3] * beyond;
    goal[0] = from[0] + beyond * cos(bearing);
    goal[1] = from[1] + beyond * sin(bearing);
}

static double law_steering(const struct law *law, const struct chain *chain,
                           const struct drawbar_estimate *estimate, const struct drawbar_body_reference *reference)
{
    const struct drawbar_pose *pose = &estimate->tractor;
    double goal[2];

    goal_point(reference->samples, law->look_ahead, goal);
    const double east = goal[0] - pose->x, north = goal[1] - pose->y, alpha = atan2(north, east) - pose->yaw;
    return atan2(2.0 * chain->wheelbase * sin(alpha), hypot(east, north));
}

#include "explicit.h"

#endif

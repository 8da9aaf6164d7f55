/* Linear quadratic regulator in path coordinates (Snider 2009, Automatic Steering Methods, CMU-RI-TR-09-08).
 *
 * Feeds lateral and heading error back on top of the steering that holds the path's curvature. The feed-forward is the
 * product's, with the estimated slips. The lateral error counts no further than where it is balanced by the
 * steepest approach.
 */
#ifndef DRAWBAR_LQR_H
#define DRAWBAR_LQR_H

#include "chain.h"
#include "tangent.h"

struct law {
    double gain[2];                        /* K: steering is minus K times the errors, rad/m and rad/rad */
    double lead;                           /* how far ahead the curvature is fed forward, samples */
    double furthest;                       /* lateral error that balances the steepest approach, m */
};

#define LAW_FIELDS                                                                                           \
    SETTING(component, law.gain, 0, 2, 0, 0) SETTING(component, law.lead, 0, 1, 0, 0) SETTING(component, law.furthest, 0, 1, 0, 0)

/* The path's curvature (1/m) so many samples ahead, in proportion between two of them; the last one beyond the end. */
static double curvature_ahead(const double (*samples)[4], double lead)
{
    const int before = (int)fmin(lead, N - 1);
    const double here = samples[before][AT_CURVATURE], next = samples[before + 1][AT_CURVATURE];
    return here + (fmin(lead, N) - before) * (next - here);
}

static double law_steering(const struct law *law, const struct chain *chain,
                           const struct drawbar_estimate *estimate, const struct drawbar_body_reference *reference)
{
    const double (*samples)[4] = reference->samples;
    const double forward = curvature_steering(chain, estimate, curvature_ahead(samples, law->lead));
    const double heading = wrapped(estimate->tractor.yaw + estimate->tractor_crab - samples[0][AT_YAW]);
    const double lateral = clipped(tangent_distance(&estimate->tractor, reference), law->furthest);

    return forward - (law->gain[0] * lateral + law->gain[1] * heading);
}

#include "explicit.h"

#endif

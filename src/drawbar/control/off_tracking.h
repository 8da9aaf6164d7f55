/* Off-tracking: what the trailer's steering leaves of it, and how far the tractor leaves its line to share that.
 *
 * On a steady curve the whole vehicle turns about one centre, so each part's distance from it follows from the lengths,
 * the joint's angle and the axles' side-slip. Behind a tractor on its line the trailer so keeps a lateral error, of which
 * its own steering can take back no more than the short drawbar reaches sideways (docs/theory/off-tracking.md).
 */
#ifndef DRAWBAR_OFF_TRACKING_H
#define DRAWBAR_OFF_TRACKING_H

#include "geometry.h"
#include "signals.h"

struct off_tracking {
    double hitch;                          /* tractor's tracked point to free joint, m */
    double antenna;                        /* free joint to the trailer's, the trailer's steering at its limit, m */
    double apart;                          /* the trailer's tracked point to the left of the tractor's, m */
    double cut_in;                         /* lateral error per curvature, m^2 */
    double reach;                          /* of the short drawbar sideways, m */
};

/* The error (m, left positive) that is left on a curvature (1/m) of the tractor's line; products of the crab angles (rad)
 * and the curvature are neglected. */
static inline double off_tracking_remainder(const struct off_tracking *vehicle, double curvature, double tractor_crab,
                                            double trailer_crab)
{
    const double hanging = vehicle->hitch * sin(tractor_crab) + vehicle->antenna * sin(trailer_crab);
    const double error = hanging + vehicle->cut_in * curvature + vehicle->apart;
    const double reach = vehicle->reach * cos(trailer_crab);

    return error - clipped(error, reach);
}

/* Lateral targets of the tractor by which both bodies share what the trailer cannot steer away.
 *
 * The tractor takes a share of what remains beyond an accepted error, at most half of what remains, and keeps a little
 * outside of every curve, where the trailer's steering has nothing left to correct with. The target changes no faster than
 * the trailer can follow, a first-order lag of the trailer's length along the path. Both controllers compute it: the tractor's
 * tracks it, the trailer's predicts the tractor by it. */
struct shared_error {
    struct off_tracking off_tracking;
    double share;                          /* of the error beyond the accepted one */
    double accepted_error;                 /* m */
    double widening;                       /* m^2 */
    double lag;                            /* distance within which the trailer follows, m */
    double sample_time;                    /* s */

    double next;                           /* the target where the next call begins, m */
};

#define SHARED_ERROR_FIELDS(place)                                                                          \
    SETTING(component, place.off_tracking.hitch, 0, 1, 0, 0) SETTING(component, place.off_tracking.antenna, 0, 1, 0, 0) \
    SETTING(component, place.off_tracking.apart, 0, 1, 0, 0) SETTING(component, place.off_tracking.cut_in, 0, 1, 0, 0) \
    SETTING(component, place.off_tracking.reach, 0, 1, 0, 0) \
    SETTING(component, place.share, 0, 1, 0, 0) SETTING(component, place.accepted_error, 0, 1, 0, 0)                  \
    SETTING(component, place.widening, 0, 1, 0, 0) SETTING(component, place.lag, 0, 1, 0, 0)                             \
    SETTING(component, place.sample_time, 0, 1, 0, 0)

/* The target (m) that a curvature (1/m) asks for in the long run. */
static inline double steady_target(const struct shared_error *shared, const struct drawbar_estimate *estimate,
                                   double curvature)
{
    const double remainder = off_tracking_remainder(&shared->off_tracking, curvature, estimate->tractor_crab,
                                                    estimate->trailer_crab);
    const double excess = fabs(remainder) - shared->accepted_error;
    const double taken = fmin(shared->share * excess, 0.5 * fabs(remainder));

    return -shared->widening * curvature - (excess < 0.0 ? 0.0 : copysign(taken, remainder));
}

/* The lateral targets (m, left positive) at the next stages of the path (x, y, yaw, curvature), and the slopes (rad) at which
 * they leave the line; the next call begins at the second. A first one that is not finite is not kept. */
static inline void shared_targets(struct shared_error *shared, const struct drawbar_estimate *estimate,
                                  const double (*samples)[4], int stages, double *targets, double *slopes)
{
    const double step = estimate->longitudinal_slip * estimate->speed * shared->sample_time;
    const double follows = -expm1(-step / shared->lag);
    double target = shared->next;

    for (int k = 0; k < stages; ++k) {
        const double left = steady_target(shared, estimate, samples[k][AT_CURVATURE]) - target;
        targets[k] = target;
        slopes[k] = left / shared->lag;
        target += follows * left;
        if (k == 0 && isfinite(target))
            shared->next = target;
    }
}

#endif

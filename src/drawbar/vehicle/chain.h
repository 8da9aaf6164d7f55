/* Chain: what the controllers and estimators on the chain share; lengths, feed-forward, the trailer's antenna. */
#ifndef DRAWBAR_CHAIN_H
#define DRAWBAR_CHAIN_H

#include "geometry.h"
#include "signals.h"
#include "sines.h"

struct chain {
    double wheelbase;                      /* L_t, m */
    double hitch;                          /* a, rear axle to free joint, m */
    double drawbar;                        /* d, m */
    double back;                           /* actuated joint to the trailer's antenna, L_i - c, m */
};

#define CHAIN_FIELDS(type, place)                                                                            \
    SETTING(type, place.wheelbase, 0, 1, 0, 0) SETTING(type, place.hitch, 0, 1, 0, 0)                        \
    SETTING(type, place.drawbar, 0, 1, 0, 0) SETTING(type, place.back, 0, 1, 0, 0)

/* The steering (rad) that holds the tractor on a curvature (1/m), for the estimated slip. */
static inline double curvature_steering(const struct chain *chain, const struct drawbar_estimate *estimate,
                                        double curvature)
{
    const double slope = chain->wheelbase * curvature + tan(estimate->tractor_crab);
    return (atan(slope) - estimate->steering_offset) / estimate->tractor_slip;
}

/* The trailer antenna's position (m) behind a rear axle at x, y (m); yaws of tractor, drawbar and trailer, rad. */
static inline void trailer_antenna(const struct chain *chain, double x, double y, double theta, double phi, double psi,
                                   double *antenna)
{
    antenna[0] = x - chain->hitch * cos(theta) - chain->drawbar * cos(phi) - chain->back * cos(psi);
    antenna[1] = y - chain->hitch * sin(theta) - chain->drawbar * sin(phi) - chain->back * sin(psi);
}

/* The same for so many: the poses, of the rear axle first, become those of the antenna. The cosines and sines become
 * those of the angles. */
static inline void trailer_antennas(const struct chain *chain, int count, const double (*angles)[3], double *cosines,
                                    double *sines, double (*poses)[3])
{
    sines_of(angles[0], 3 * count, cosines, sines);
    AS_IT_STANDS for (int k = 0; k < count; ++k) {
        const double *c = cosines + 3 * k, *s = sines + 3 * k;
        poses[k][AT_X] -= chain->hitch * c[0] + chain->drawbar * c[1] + chain->back * c[2];
        poses[k][AT_Y] -= chain->hitch * s[0] + chain->drawbar * s[1] + chain->back * s[2];
    }
}

#endif

/* The slide: in which direction, and at which angle, the ground draws every axle, found from the side-slips in all headings.
 *
 * On a side slope all axles drift downhill, to the left or to the right as they face. What is the same in the world is thus
 * told from what is the same for the vehicle (its sensors' zeros), and turns with neither: a model that knows it expects the
 * side-slips of the next heading instead of finding them anew in each curve. Recursive least squares of
 *
 *     alpha = constant - east sin(yaw) + north cos(yaw)
 *
 * over the estimated side-slips of both axles (Plackett 1950), with a random walk of all three.
 */
#ifndef DRAWBAR_SLIDE_H
#define DRAWBAR_SLIDE_H

#include <math.h>
#include "geometry.h"

#define SLIDE_TERMS 3                      /* east, north, constant */
#define MOST_SLIDE 0.12                    /* rad */

struct slide {
    double prior, walk;                    /* of east and north: standard deviation at first, and per sample, rad; prior 0:
                                            * nothing is found */
    double constant_prior, noise;          /* of the constant; of one estimated side-slip, rad */
    double value[SLIDE_TERMS];             /* rad */
    double covariance[SLIDE_TERMS][SLIDE_TERMS];
};

#define SLIDE_FIELDS(type, place)                                                                            \
    SETTING(type, place.prior, 0, 1, 0, 0) SETTING(type, place.walk, 0, 1, 0, 0)                             \
    SETTING(type, place.constant_prior, 0, 1, 0, 0) SETTING(type, place.noise, 0, 1, 0, 0)                   \
    FIELD(type, place.value, 0, SLIDE_TERMS, 0, 0)

static inline void slide_begin(struct slide *slide)
{
    for (int i = 0; i < SLIDE_TERMS; ++i) {
        const double deviation = i < 2 ? slide->prior : slide->constant_prior;
        slide->value[i] = 0.0;
        for (int j = 0; j < SLIDE_TERMS; ++j)
            slide->covariance[i][j] = i == j ? deviation * deviation : 0.0;
    }
}

/* At which angle to its left an axle with this yaw is drawn, rad. */
static inline double slide_across(const struct slide *slide, double yaw)
{
    return slide->value[1] * cos(yaw) - slide->value[0] * sin(yaw);
}

/* Take in the side-slip (rad) of an axle with this yaw. */
static inline void slide_take(struct slide *slide, double yaw, double crab)
{
    const double row[SLIDE_TERMS] = {-sin(yaw), cos(yaw), 1.0};
    double gain[SLIDE_TERMS], spread = slide->noise * slide->noise, error = crab;

    for (int i = 0; i < SLIDE_TERMS; ++i) {
        gain[i] = 0.0;
        for (int j = 0; j < SLIDE_TERMS; ++j)
            gain[i] += slide->covariance[i][j] * row[j];
        spread += row[i] * gain[i];
        error -= row[i] * slide->value[i];
    }
    if (!isfinite(error))
        return;
    for (int i = 0; i < SLIDE_TERMS; ++i) {
        slide->value[i] += gain[i] * error / spread;
        for (int j = 0; j < SLIDE_TERMS; ++j)
            slide->covariance[i][j] -= gain[i] * gain[j] / spread;
    }
    const double size = hypot(slide->value[0], slide->value[1]), share = size > MOST_SLIDE ? MOST_SLIDE / size : 1.0;
    slide->value[0] *= share;              /* the same in all directions of the world */
    slide->value[1] *= share;
}

/* Let a sample pass: what is known goes back towards the prior, so that east and north walk by `walk`. */
static inline void slide_walk(struct slide *slide)
{
    const double share = slide->walk / slide->prior, fresh = fmin(share * share, 1.0);

    for (int i = 0; i < SLIDE_TERMS; ++i) {
        const double deviation = i < 2 ? slide->prior : slide->constant_prior;
        for (int j = 0; j < SLIDE_TERMS; ++j)
            slide->covariance[i][j] += fresh * ((i == j ? deviation * deviation : 0.0) - slide->covariance[i][j]);
    }
}

#endif

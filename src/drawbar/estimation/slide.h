/* The slide: in which direction, and at which angle, the ground draws every axle, found from the side-slips in all headings.
 *
 * On a side slope all axles drift downhill, to the left or to the right as they face. What is the same in the world is thus
 * told from what is the same for the vehicle (its sensors' zeros), and turns with neither. In a curve every axle drifts outwards,
 * by `creep` times its side acceleration (to its left, in g). A model that knows it expects the
 * side-slips of the next heading instead of finding them anew in each curve. Recursive least squares of
 *
 *     alpha = constant - east sin(yaw) + north cos(yaw) - creep push
 *
 * over the estimated side-slips of both axles (Plackett 1950), with a random walk of all four.
 */
#ifndef DRAWBAR_SLIDE_H
#define DRAWBAR_SLIDE_H

#include <math.h>
#include "geometry.h"

#define SLIDE_TERMS 4                      /* east, north, creep, constant */
#define MOST_SLIDE 0.12                    /* rad */
#define MOST_CREEP 1.0

/* How an axle faces and how it is pushed aside. */
struct axle {
    double yaw;                            /* rad */
    double push;                           /* side acceleration to its left, g */
};

struct slide {
    double prior, walk;                    /* of east and north: standard deviation at first, and per sample, rad; prior 0:
                                            * nothing is found */
    double creep_prior;                    /* the same of creep; 0: it stays 0 */
    double constant_prior, noise;          /* of the constant; of one estimated side-slip, rad */
    double value[SLIDE_TERMS];             /* rad; creep: rad/g */
    double covariance[SLIDE_TERMS][SLIDE_TERMS];
};

#define SLIDE_FIELDS(type, place)                                                                            \
    SETTING(type, place.prior, 0, 1, 0, 0) SETTING(type, place.walk, 0, 1, 0, 0)                             \
    SETTING(type, place.creep_prior, 0, 1, 0, 0)                                                             \
    SETTING(type, place.constant_prior, 0, 1, 0, 0) SETTING(type, place.noise, 0, 1, 0, 0)                   \
    FIELD(type, place.value, 0, SLIDE_TERMS, 0, 0)

/* Standard deviation of a term at first. */
static inline double slide_prior(const struct slide *slide, int term)
{
    return term < 2 ? slide->prior : term == 2 ? slide->creep_prior : slide->constant_prior;
}

/* What a side-slip is made of, by terms. */
static inline void slide_row(struct axle axle, double *row)
{
    row[0] = -sin(axle.yaw);
    row[1] = cos(axle.yaw);
    row[2] = -axle.push;
    row[3] = 1.0;
}

static inline void slide_begin(struct slide *slide)
{
    for (int i = 0; i < SLIDE_TERMS; ++i) {
        const double deviation = slide_prior(slide, i);
        slide->value[i] = 0.0;
        for (int j = 0; j < SLIDE_TERMS; ++j)
            slide->covariance[i][j] = i == j ? deviation * deviation : 0.0;
    }
}

/* At which angle to its left slope and curve draw an axle, rad. */
static inline double slide_across(const struct slide *slide, struct axle axle)
{
    double row[SLIDE_TERMS];

    slide_row(axle, row);
    return slide->value[0] * row[0] + slide->value[1] * row[1] + slide->value[2] * row[2];
}

/* Take in the side-slip (rad) of an axle. */
static inline void slide_take(struct slide *slide, struct axle axle, double crab)
{
    double row[SLIDE_TERMS], gain[SLIDE_TERMS], spread = slide->noise * slide->noise, error = crab;

    slide_row(axle, row);
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
    slide->value[2] = clipped(slide->value[2], MOST_CREEP);
}

/* Let a sample pass: what is known goes back towards the prior, so that east and north walk by `walk`. */
static inline void slide_walk(struct slide *slide)
{
    const double share = slide->walk / slide->prior, fresh = fmin(share * share, 1.0);

    for (int i = 0; i < SLIDE_TERMS; ++i) {
        const double deviation = slide_prior(slide, i);
        for (int j = 0; j < SLIDE_TERMS; ++j)
            slide->covariance[i][j] += fresh * ((i == j ? deviation * deviation : 0.0) - slide->covariance[i][j]);
    }
}

#endif

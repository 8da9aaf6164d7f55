/* The slide: in which direction, and at which angle, the ground draws every axle, found from the side-slips in all headings.
 *
 * On a side slope all axles drift downhill, to the left or to the right as they face. What is the same in the world is thus
 * told from what is the same for the vehicle (its sensors' zeros), and turns with neither. In a curve every axle drifts outwards,
 * by `creep` times its side acceleration (to its left, in g). A model that knows it expects the
 * side-slips of the next heading instead of finding them anew in each curve. Recursive least squares of
 *
 *     alpha = constant - east sin(yaw) + north cos(yaw) - creep push
 *
 * over the estimated side-slips of both axles (Plackett 1950), with a random walk of all unknowns. Where a body's attitude
 * shows by how much the ground falls, east and north are creep times this fall and what is left beside it, and a curve's
 * creep is the slope's and what is left beside it: the first metres on a slope then show much of the next curve.
 */
#ifndef DRAWBAR_SLIDE_H
#define DRAWBAR_SLIDE_H

#include <math.h>
#include <string.h>
#include "apart.h"
#include "geometry.h"
#include "ground_record.h"
#include "signals.h"

enum { SLIDE_EAST, SLIDE_NORTH, SLIDE_CREEP, SLIDE_CONSTANT, SLIDE_CURVE, SLIDE_TERMS };   /* curve: beyond creep */

#define FALL_MEMORY 10.0                   /* time over which the ground's fall is averaged, s */
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
    double beyond_slope;                   /* in place of `prior` where the ground's fall is known, rad */
    double creep_prior;                    /* deviation at first of creep, and of a curve's beyond a slope's; 0: both stay 0 */
    double constant_prior, noise;          /* of the constant; of one estimated side-slip, rad */
    double value[SLIDE_TERMS];             /* rad; creep: rad/g */
    double covariance[SLIDE_TERMS][SLIDE_TERMS];
    double falls[2];                       /* by which the ground falls to the east and to the north, averaged, rad */
    double seen;                           /* for how long that was seen, at most FALL_MEMORY, s */
};

#define SLIDE_FIELDS(type, place)                                                                            \
    SETTING(type, place.prior, 0, 1, 0, 0) SETTING(type, place.walk, 0, 1, 0, 0)                             \
    SETTING(type, place.beyond_slope, 0, 1, 0, 0)                                                            \
    SETTING(type, place.creep_prior, 0, 1, 0, 0)                                                             \
    SETTING(type, place.constant_prior, 0, 1, 0, 0) SETTING(type, place.noise, 0, 1, 0, 0)                   \
    FIELD(type, place.value, 0, SLIDE_TERMS, 0, 0)

/* Standard deviation of a term at first. */
static inline double slide_prior(const struct slide *slide, int term)
{
    if (term == SLIDE_CONSTANT)
        return slide->constant_prior;
    if (term >= SLIDE_CREEP)
        return slide->creep_prior;
    return slide->seen > 0.0 ? slide->beyond_slope : slide->prior;
}

/* What a side-slip is made of, by terms. */
static inline void slide_row(const struct slide *slide, struct axle axle, double *row)
{
    row[SLIDE_EAST] = -sin(axle.yaw);
    row[SLIDE_NORTH] = cos(axle.yaw);
    row[SLIDE_CREEP] = row[SLIDE_EAST] * slide->falls[0] + row[SLIDE_NORTH] * slide->falls[1] - axle.push;
    row[SLIDE_CONSTANT] = 1.0;
    row[SLIDE_CURVE] = slide->seen > 0.0 ? -axle.push : 0.0;
}

/* Know no more than at first of anything. */
static APART void slide_doubt(struct slide *slide)
{
    for (int i = 0; i < SLIDE_TERMS; ++i) {
        const double deviation = slide_prior(slide, i);
        for (int j = 0; j < SLIDE_TERMS; ++j)
            slide->covariance[i][j] = i == j ? deviation * deviation : 0.0;
    }
}

static inline void slide_begin(struct slide *slide)
{
    memset(slide->value, 0, sizeof slide->value);
    slide->falls[0] = slide->falls[1] = slide->seen = 0.0;
    slide_doubt(slide);
}

/* Side-slip by the slope to the east and to the north, rad, and by a curve, rad/g: axles drift out of it, never into it. What
 * shows the opposite is an estimate that lags in a swing, and a model that believed it would let the swing grow. */
static APART void slide_told(const struct slide *slide, double *told)
{
    for (int i = 0; i < 2; ++i)
        told[i] = slide->value[i] + slide->value[SLIDE_CREEP] * slide->falls[i];
    told[2] = fmax(slide->value[SLIDE_CREEP] + slide->value[SLIDE_CURVE], 0.0);
}

/* At which angle to its left slope and curve draw an axle, rad. */
static APART double slide_across(const struct slide *slide, struct axle axle)
{
    double told[3];

    slide_told(slide, told);
    return told[1] * cos(axle.yaw) - told[0] * sin(axle.yaw) - told[2] * axle.push;
}

/* Take in how a body that faces so stands on the ground for a sample, rad, s; NaN: nobody knows. */
static APART void slide_stand(struct slide *slide, double yaw, double roll, double pitch, double sample_time)
{
    double slope[2];

    slope_below(yaw, roll, pitch, slope);
    if (!isfinite(slope[0] + slope[1]))
        return;
    const int first = slide->seen == 0.0;
    slide->seen = fmin(slide->seen + sample_time, FALL_MEMORY);
    for (int i = 0; i < 2; ++i)
        slide->falls[i] -= sample_time / slide->seen * (slope[i] + slide->falls[i]);
    if (first)
        slide_doubt(slide);
}

/* Take in the side-slip (rad) of an axle. */
static APART void slide_take(struct slide *slide, struct axle axle, double crab)
{
    /* without an attitude sensor the masts' swing is in it */
    const double noise = slide->seen > 0.0 ? 0.5 * slide->noise : slide->noise;
    double row[SLIDE_TERMS], gain[SLIDE_TERMS], spread = noise * noise, error = crab;

    slide_row(slide, axle, row);
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
    const double size = hypot(slide->value[SLIDE_EAST], slide->value[SLIDE_NORTH]);
    const double share = size > MOST_SLIDE ? MOST_SLIDE / size : 1.0;
    slide->value[SLIDE_EAST] *= share;     /* the same in all directions of the world */
    slide->value[SLIDE_NORTH] *= share;
    const double creep = clipped(slide->value[SLIDE_CREEP], MOST_CREEP);
    slide->value[SLIDE_CURVE] = clipped(creep + slide->value[SLIDE_CURVE], MOST_CREEP) - creep;
    slide->value[SLIDE_CREEP] = creep;
}

/* Let a sample pass: what is known goes back towards the prior, so that east and north walk by `walk`. */
static APART void slide_walk(struct slide *slide)
{
    const double share = slide->walk / slide->prior, fresh = fmin(share * share, 1.0);

    for (int i = 0; i < SLIDE_TERMS; ++i) {
        const double deviation = slide_prior(slide, i);
        for (int j = 0; j < SLIDE_TERMS; ++j)
            slide->covariance[i][j] += fresh * ((i == j ? deviation * deviation : 0.0) - slide->covariance[i][j]);
    }
}

#endif

/* Slide: the side-slip of every axle by the ground's slope and by lateral acceleration, identified in all headings.
 *
 * On a side slope all axles drift downhill, to the left or to the right depending on their heading, while the sensors' zeros are
 * constant in the vehicle's frame: that separates the two. In a curve every axle drifts outwards, by `creep` times its lateral
 * acceleration (to its left, in g). With both in its model the estimator predicts the side-slips of the next heading instead of
 * estimating them again in each curve. Recursive least squares of
 *
 *     alpha = constant - east sin(yaw) + north cos(yaw) - creep acceleration
 *
 * over the estimated side-slips of both axles (Plackett 1950), with a random walk of all coefficients. Where a body's attitude
 * measures the ground's fall, east and north are creep times this fall plus a remainder, and a curve's creep is the slope's plus
 * a remainder: the first metres on a slope then predict much of the next curve.
 */
#ifndef DRAWBAR_SLIDE_H
#define DRAWBAR_SLIDE_H

#include <math.h>
#include <string.h>
#include "noinline.h"
#include "geometry.h"
#include "ground_record.h"
#include "signals.h"

enum { SLIDE_EAST, SLIDE_NORTH, SLIDE_CREEP, SLIDE_CONSTANT, SLIDE_CURVE, SLIDE_TERMS };   /* curve: remainder */

#define FALL_TIME 10.0                     /* time constant of the ground's fall, s */
#define MOST_SLIDE 0.12                    /* limit of the side-slip by the slope, rad */
#define MOST_CREEP 1.0                     /* limit of creep, rad/g */
#define MOST_AHEAD 0.2                     /* of the wheelbase, see slide_at_speed */

/* An axle's heading and lateral acceleration. */
struct axle {
    double yaw;                            /* rad */
    double acceleration;                   /* to its left, g */
};

struct slide {
    double prior, walk;                    /* of east and north: prior standard deviation, and random walk per sample, rad; prior
                                            * 0: nothing is identified */
    double beyond_slope;                   /* in place of `prior` where the ground's fall is measured, rad */
    double creep_prior;                    /* prior standard deviation of creep, and of a curve's remainder; 0: both stay 0 */
    double constant_prior, noise;          /* of the constant, prior; of one estimated side-slip, rad */
    double value[SLIDE_TERMS];             /* rad; creep: rad/g */
    double covariance[SLIDE_TERMS][SLIDE_TERMS];
    double fall[2];                        /* of the ground to the east and to the north, averaged, rad */
    double attitude_time;                  /* for how long attitudes have measured it, at most FALL_TIME, s */
    double ahead;                          /* by how many wheelbases 1 rad/g of creep moves an axle ahead at this speed */
};

#define SLIDE_FIELDS(type, place)                                                                            \
    SETTING(type, place.prior, 0, 1, 0, 0) SETTING(type, place.walk, 0, 1, 0, 0)                             \
    SETTING(type, place.beyond_slope, 0, 1, 0, 0)                                                            \
    SETTING(type, place.creep_prior, 0, 1, 0, 0)                                                             \
    SETTING(type, place.constant_prior, 0, 1, 0, 0) SETTING(type, place.noise, 0, 1, 0, 0)                   \
    FIELD(type, place.value, 0, SLIDE_TERMS, 0, 0)

/* Prior standard deviation of a coefficient. */
static inline double slide_prior(const struct slide *slide, int term)
{
    if (term == SLIDE_CONSTANT)
        return slide->constant_prior;
    if (term >= SLIDE_CREEP)
        return slide->creep_prior;
    return slide->attitude_time > 0.0 ? slide->beyond_slope : slide->prior;
}

/* The regression row of a side-slip. */
static inline void slide_row(const struct slide *slide, struct axle axle, double *row)
{
    row[SLIDE_EAST] = -sin(axle.yaw);
    row[SLIDE_NORTH] = cos(axle.yaw);
    row[SLIDE_CREEP] = row[SLIDE_EAST] * slide->fall[0] + row[SLIDE_NORTH] * slide->fall[1] - axle.acceleration;
    row[SLIDE_CONSTANT] = 1.0;
    row[SLIDE_CURVE] = slide->attitude_time > 0.0 ? -axle.acceleration : 0.0;
}

/* Reset the covariance to the prior. */
static NOINLINE void slide_reset_covariance(struct slide *slide)
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
    slide->fall[0] = slide->fall[1] = slide->attitude_time = slide->ahead = 0.0;
    slide_reset_covariance(slide);
}

/* Set the speed (m/s) at which the coefficients are in effect. An axle that drifts out of its curve by `creep` moves as if it were
 * creep speed^2 / g further ahead. Where an antenna that stands aside is taken for creep, the vehicle oscillates if that is
 * more than MOST_AHEAD of the wheelbase (m). */
static inline void slide_at_speed(struct slide *slide, double speed, double wheelbase)
{
    slide->ahead = speed * speed / (GRAVITY * wheelbase);
}

/* The three coefficients in effect: side-slip by the slope, east and north, rad; by lateral acceleration, rad/g, never negative:
 * axles drift out of a curve. The opposite is an estimate that lags in an oscillation, which a model with it would amplify. */
static NOINLINE void slide_coefficients(const struct slide *slide, double *coefficients)
{
    for (int i = 0; i < 2; ++i)
        coefficients[i] = slide->value[i] + slide->value[SLIDE_CREEP] * slide->fall[i];
    coefficients[2] = fmax(slide->value[SLIDE_CREEP] + slide->value[SLIDE_CURVE], 0.0);
    if (coefficients[2] * slide->ahead > MOST_AHEAD)
        coefficients[2] = MOST_AHEAD / slide->ahead;
}

/* Predicted side-slip of an axle, to its left, rad. */
static NOINLINE double slide_across(const struct slide *slide, struct axle axle)
{
    double coefficients[3];

    slide_coefficients(slide, coefficients);
    return coefficients[1] * cos(axle.yaw) - coefficients[0] * sin(axle.yaw) - coefficients[2] * axle.acceleration;
}

/* Update the ground's fall with a body's yaw, roll and pitch (rad; NaN: unknown) over a sample (s). */
static NOINLINE void slide_attitude(struct slide *slide, double yaw, double roll, double pitch, double sample_time)
{
    double slope[2];

    slope_below(yaw, roll, pitch, slope);
    if (!isfinite(slope[0] + slope[1]))
        return;
    const int first = slide->attitude_time == 0.0;
    slide->attitude_time = fmin(slide->attitude_time + sample_time, FALL_TIME);
    for (int i = 0; i < 2; ++i)
        slide->fall[i] -= sample_time / slide->attitude_time * (slope[i] + slide->fall[i]);
    if (first)
        slide_reset_covariance(slide);
}

/* Update the coefficients with an axle's estimated side-slip (rad). */
static NOINLINE void slide_update(struct slide *slide, struct axle axle, double side_slip)
{
    /* without an attitude sensor the masts' sway adds to it */
    const double noise = slide->attitude_time > 0.0 ? 0.5 * slide->noise : slide->noise;
    double row[SLIDE_TERMS], gain[SLIDE_TERMS], variance = noise * noise, innovation = side_slip;

    slide_row(slide, axle, row);
    for (int i = 0; i < SLIDE_TERMS; ++i) {
        gain[i] = 0.0;
        for (int j = 0; j < SLIDE_TERMS; ++j)
            gain[i] += slide->covariance[i][j] * row[j];
        variance += row[i] * gain[i];
        innovation -= row[i] * slide->value[i];
    }
    if (!isfinite(innovation))
        return;
    for (int i = 0; i < SLIDE_TERMS; ++i) {
        slide->value[i] += gain[i] * innovation / variance;
        for (int j = 0; j < SLIDE_TERMS; ++j)
            slide->covariance[i][j] -= gain[i] * gain[j] / variance;
    }
    const double size = hypot(slide->value[SLIDE_EAST], slide->value[SLIDE_NORTH]);
    const double share = size > MOST_SLIDE ? MOST_SLIDE / size : 1.0;
    slide->value[SLIDE_EAST] *= share;     /* the limit is isotropic */
    slide->value[SLIDE_NORTH] *= share;
    const double creep = clipped(slide->value[SLIDE_CREEP], MOST_CREEP);
    slide->value[SLIDE_CURVE] = clipped(creep + slide->value[SLIDE_CURVE], MOST_CREEP) - creep;
    slide->value[SLIDE_CREEP] = creep;
}

/* Forget by one sample: the covariance relaxes towards the prior, so that east and north walk by `walk`. */
static NOINLINE void slide_forget(struct slide *slide)
{
    const double share = slide->walk / slide->prior, fresh = fmin(share * share, 1.0);

    for (int i = 0; i < SLIDE_TERMS; ++i) {
        const double deviation = slide_prior(slide, i);
        for (int j = 0; j < SLIDE_TERMS; ++j)
            slide->covariance[i][j] += fresh * ((i == j ? deviation * deviation : 0.0) - slide->covariance[i][j]);
    }
}

#endif

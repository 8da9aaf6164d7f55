/* Mast swing: whether an antenna swings as the roll says that its body's sensor reports.
 *
 * A mast of height h carries its antenna by -h sin(roll) to the left. Beside the estimator's own prediction, corrected by nothing but
 * its speed and yaw, each fix shows where the antenna is, and over many of them which share of the reported roll the mast
 * swings with: 1 of a sensor that is right, -1 of one that is reversed, between where the roll is nothing but noise. A Kalman
 * filter finds this share along with the prediction's own drift.
 */
#ifndef DRAWBAR_MAST_SWING_H
#define DRAWBAR_MAST_SWING_H

#include <math.h>
#include <stdint.h>
#include <string.h>
#include "geometry.h"

enum { SWING_OFFSET, SWING_DRIFT, SWING_SHARE, SWUNG };

#define OFFSET_FIRST 0.3                   /* deviation of the prediction's place, m */
#define DRIFT_FIRST 0.05                   /* and of its direction before anything is known, rad */
#define SHARE_FIRST 1.0                    /* deviation of the share before anything is known */
#define OFFSET_WALK 0.01                   /* by which place, m, */
#define DRIFT_WALK 0.005                    /* direction, rad, */
#define SHARE_WALK 0.02                    /* and share change, each per square root of a metre */
#define SWING_NOISE 0.02                   /* of a fix, with that of the roll, at least, m */
#define SWING_JUMP 4.0                     /* deviations of a fix that has jumped: it says nothing of the roll */
#define SWING_USUAL 30.0                   /* time over which the squares of what is unexpected are averaged, s */
#define SWING_LATELY 4.0                   /* the same for what is so now, s */
#define SWING_CERTAIN 4.5                  /* deviations by which the share is below zero of a reversed sensor */
#define SWING_ODD 3.0                      /* times the usual that is too much beside a roll that stands still */

struct mast_swing {
    double state[SWUNG];                   /* place, m, and direction of the prediction, rad; share */
    double covariance[SWUNG][SWUNG];
    double expected[2];                    /* where the ground point was expected, m */
    double usual, lately;                  /* mean squares of what is unexpected, in variances */
    double averaged;                       /* time over which the usual one has been, s */
    double least;                          /* usual one that SWING_NOISE makes */
    int32_t begun;
};

static inline void swing_begin(struct mast_swing *swing, const double *expected)
{
    *swing = (struct mast_swing){.state = {[SWING_SHARE] = 1.0}, .usual = 1.0, .averaged = SWING_LATELY, .begun = 1};
    swing->covariance[SWING_OFFSET][SWING_OFFSET] = OFFSET_FIRST * OFFSET_FIRST;
    swing->covariance[SWING_DRIFT][SWING_DRIFT] = DRIFT_FIRST * DRIFT_FIRST;
    swing->covariance[SWING_SHARE][SWING_SHARE] = SHARE_FIRST * SHARE_FIRST;
    memcpy(swing->expected, expected, sizeof swing->expected);
}

/* Let the vehicle move on by `moved` (m) to where its ground point is expected; `corrected`: to its left, what the newest
 * estimate has corrected the last expectation by, m. */
static inline void swing_move(struct mast_swing *swing, const double *expected, double corrected, double moved)
{
    double (*covariance)[SWUNG] = swing->covariance;

    swing->state[SWING_OFFSET] += moved * swing->state[SWING_DRIFT] - corrected;
    for (int i = 0; i < SWUNG; ++i)
        covariance[SWING_OFFSET][i] += moved * covariance[SWING_DRIFT][i];
    for (int i = 0; i < SWUNG; ++i)
        covariance[i][SWING_OFFSET] += moved * covariance[i][SWING_DRIFT];
    covariance[SWING_OFFSET][SWING_OFFSET] += moved * OFFSET_WALK * OFFSET_WALK;
    covariance[SWING_DRIFT][SWING_DRIFT] += moved * DRIFT_WALK * DRIFT_WALK;
    covariance[SWING_SHARE][SWING_SHARE] += moved * SHARE_WALK * SHARE_WALK;
    memcpy(swing->expected, expected, sizeof swing->expected);
}

/* Take in how far left of its expected ground point an antenna is (m), where the roll would put it so far to the left (m).
 * deviation: of the fix, m; learns: what is unexpected may become usual; elapsed: since the last sample, s. */
static inline void swing_take(struct mast_swing *swing, double beside, double rolled, double deviation, int learns,
                              double elapsed)
{
    const double row[SWUNG] = {1.0, 0.0, rolled}, noise = fmax(deviation, SWING_NOISE);
    double gain[SWUNG], variance = noise * noise, error = beside;

    if (!isfinite(beside + rolled))
        return;
    for (int i = 0; i < SWUNG; ++i) {
        gain[i] = swing->covariance[i][SWING_OFFSET] + rolled * swing->covariance[i][SWING_SHARE];
        error -= row[i] * swing->state[i];
    }
    variance += gain[SWING_OFFSET] + rolled * gain[SWING_SHARE];
    const double odd = fmin(error * error / variance, SWING_JUMP * SWING_JUMP);
    swing->least = SWING_NOISE / noise * SWING_NOISE / noise;
    swing->averaged = fmin(swing->averaged + learns * elapsed, SWING_USUAL);
    swing->usual -= learns * expm1(-elapsed / swing->averaged) * (odd - swing->usual);
    swing->lately -= expm1(-elapsed / SWING_LATELY) * (odd - swing->lately);
    if (odd >= SWING_JUMP * SWING_JUMP) {  /* the place is another one */
        swing->covariance[SWING_OFFSET][SWING_OFFSET] += OFFSET_FIRST * OFFSET_FIRST;
        gain[SWING_OFFSET] += OFFSET_FIRST * OFFSET_FIRST;
        variance += OFFSET_FIRST * OFFSET_FIRST;
    }
    for (int i = 0; i < SWUNG; ++i) {
        swing->state[i] += gain[i] / variance * error;
        for (int j = 0; j < SWUNG; ++j)
            swing->covariance[i][j] -= gain[i] * gain[j] / variance;
    }
}

/* Whether the antenna swings against the roll. */
static inline int swing_reversed(const struct mast_swing *swing)
{
    const double deviation = sqrt(swing->covariance[SWING_SHARE][SWING_SHARE] * fmax(swing->usual, 1.0));
    return swing->state[SWING_SHARE] < -SWING_CERTAIN * deviation;
}

/* Whether the antenna swings more than it usually is off. */
static inline int swing_odd(const struct mast_swing *swing)
{
    return swing->lately > SWING_ODD * fmax(swing->usual, swing->least);
}

#endif

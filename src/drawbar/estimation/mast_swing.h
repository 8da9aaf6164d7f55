/* Mast swing: whether an antenna moves sideways as the roll that its body's sensor reports implies.
 *
 * A mast of height h moves its antenna by -h sin(roll) to the left. Each fix, relative to dead reckoning by the estimator's speed
 * and yaw, measures the antenna's lateral position. A Kalman filter estimates with which gain that follows the reported roll,
 * along with offset and drift of the dead reckoning: 1 with a correct sensor, -1 with a reversed one, between with pure noise.
 */
#ifndef DRAWBAR_MAST_SWING_H
#define DRAWBAR_MAST_SWING_H

#include <math.h>
#include <stdint.h>
#include <string.h>
#include "geometry.h"

enum { SWING_OFFSET, SWING_DRIFT, SWING_GAIN, SWING_STATES };

#define OFFSET_PRIOR 0.3                   /* prior standard deviations: of the dead reckoning's offset, m, */
#define DRIFT_PRIOR 0.05                   /* of its direction, rad, */
#define GAIN_PRIOR 1.0                     /* and of the gain */
#define OFFSET_WALK 0.01                   /* random walks: of the offset, m, */
#define DRIFT_WALK 0.005                   /* of the direction, rad, */
#define GAIN_WALK 0.02                     /* and of the gain, each per square root of a metre */
#define SWING_NOISE 0.02                   /* least standard deviation of a fix, that of the roll included, m */
#define SWING_JUMP 4.0                     /* standard deviations from which on a fix has jumped: it shows no roll */
#define SWING_BASELINE 30.0                /* time constants of the normalised innovations squared: long, s, */
#define SWING_RECENT 4.0                   /* and short, s */
#define SWING_SIGNIFICANT 4.5              /* standard deviations by which the gain of a reversed sensor is below zero */
#define SWING_EXCESSIVE 3.0                /* ratio of both means beyond which a constant roll is contradicted */

struct mast_swing {
    double state[SWING_STATES];            /* offset, m, and direction of the dead reckoning, rad; gain */
    double covariance[SWING_STATES][SWING_STATES];
    double expected[2];                    /* where the ground point was expected, m */
    double baseline, recent;               /* normalised innovation squared: long and short mean */
    double baseline_time;                  /* time that the long mean covers so far, s */
    double baseline_floor;                 /* least long mean, by SWING_NOISE */
    int32_t initialised;
};

static inline void swing_begin(struct mast_swing *swing, const double *expected)
{
    *swing = (struct mast_swing){.state = {[SWING_GAIN] = 1.0}, .baseline = 1.0, .baseline_time = SWING_RECENT, .initialised = 1};
    swing->covariance[SWING_OFFSET][SWING_OFFSET] = OFFSET_PRIOR * OFFSET_PRIOR;
    swing->covariance[SWING_DRIFT][SWING_DRIFT] = DRIFT_PRIOR * DRIFT_PRIOR;
    swing->covariance[SWING_GAIN][SWING_GAIN] = GAIN_PRIOR * GAIN_PRIOR;
    memcpy(swing->expected, expected, sizeof swing->expected);
}

/* Propagate over a travelled distance (m) to the next expected ground point; `corrected`: by how much to the left the newest
 * estimate has corrected the last expectation, m. */
static inline void swing_propagate(struct mast_swing *swing, const double *expected, double corrected, double travelled)
{
    double (*covariance)[SWING_STATES] = swing->covariance;

    swing->state[SWING_OFFSET] += travelled * swing->state[SWING_DRIFT] - corrected;
    for (int i = 0; i < SWING_STATES; ++i)
        covariance[SWING_OFFSET][i] += travelled * covariance[SWING_DRIFT][i];
    for (int i = 0; i < SWING_STATES; ++i)
        covariance[i][SWING_OFFSET] += travelled * covariance[i][SWING_DRIFT];
    covariance[SWING_OFFSET][SWING_OFFSET] += travelled * OFFSET_WALK * OFFSET_WALK;
    covariance[SWING_DRIFT][SWING_DRIFT] += travelled * DRIFT_WALK * DRIFT_WALK;
    covariance[SWING_GAIN][SWING_GAIN] += travelled * GAIN_WALK * GAIN_WALK;
    memcpy(swing->expected, expected, sizeof swing->expected);
}

/* Update with an antenna's lateral position (m, left of the expected ground point) and the one that the roll implies (m).
 * deviation: of the fix, m; learns: whether the long mean is updated; elapsed: since the last sample, s. */
static inline void swing_update(struct mast_swing *swing, double lateral, double by_roll, double deviation, int learns,
                                double elapsed)
{
    const double row[SWING_STATES] = {1.0, 0.0, by_roll}, noise = fmax(deviation, SWING_NOISE);
    double gain[SWING_STATES], variance = noise * noise, innovation = lateral;

    if (!isfinite(lateral + by_roll))
        return;
    for (int i = 0; i < SWING_STATES; ++i) {
        gain[i] = swing->covariance[i][SWING_OFFSET] + by_roll * swing->covariance[i][SWING_GAIN];
        innovation -= row[i] * swing->state[i];
    }
    variance += gain[SWING_OFFSET] + by_roll * gain[SWING_GAIN];
    const double nis = fmin(innovation * innovation / variance, SWING_JUMP * SWING_JUMP);
    swing->baseline_floor = SWING_NOISE / noise * SWING_NOISE / noise;
    swing->baseline_time = fmin(swing->baseline_time + learns * elapsed, SWING_BASELINE);
    swing->baseline -= learns * expm1(-elapsed / swing->baseline_time) * (nis - swing->baseline);
    swing->recent -= expm1(-elapsed / SWING_RECENT) * (nis - swing->recent);
    if (nis >= SWING_JUMP * SWING_JUMP) {  /* the offset is another one */
        swing->covariance[SWING_OFFSET][SWING_OFFSET] += OFFSET_PRIOR * OFFSET_PRIOR;
        gain[SWING_OFFSET] += OFFSET_PRIOR * OFFSET_PRIOR;
        variance += OFFSET_PRIOR * OFFSET_PRIOR;
    }
    for (int i = 0; i < SWING_STATES; ++i) {
        swing->state[i] += gain[i] / variance * innovation;
        for (int j = 0; j < SWING_STATES; ++j)
            swing->covariance[i][j] -= gain[i] * gain[j] / variance;
    }
}

/* Whether the antenna moves against the reported roll. */
static inline int swing_reversed(const struct mast_swing *swing)
{
    const double deviation = sqrt(swing->covariance[SWING_GAIN][SWING_GAIN] * fmax(swing->baseline, 1.0));
    return swing->state[SWING_GAIN] < -SWING_SIGNIFICANT * deviation;
}

/* Whether the innovations have grown beyond their long-term variance. */
static inline int swing_excessive(const struct mast_swing *swing)
{
    return swing->recent > SWING_EXCESSIVE * fmax(swing->baseline, swing->baseline_floor);
}

#endif

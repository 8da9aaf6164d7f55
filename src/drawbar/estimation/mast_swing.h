/* Mast swing: whether an antenna moves sideways as the roll that its body's sensor reports implies.
 *
 * A mast of height h moves its antenna by -h sin(roll) to the left. Each fix, relative to dead reckoning by the estimator's speed
 * and yaw, measures the antenna's lateral position. A Kalman filter estimates with which gain that follows the reported roll,
 * along with offset and drift of the dead reckoning: 1 with a correct sensor, -1 with a reversed one, between with pure noise.
 * A body also rocks on its tyres, two or three times a second, and then a roll that is a fifth of a second older than reported
 * contradicts the antenna's motion. So a second filter takes both averaged, and must agree before a sensor counts as reversed.
 */
#ifndef DRAWBAR_MAST_SWING_H
#define DRAWBAR_MAST_SWING_H

#include <math.h>
#include <stdint.h>
#include <string.h>
#include "geometry.h"
#include "kalman_update.h"

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
#define SWING_ROCKING 0.5                  /* time constant of the averages in which rocking fades, s, */
#define SWING_SLOWLY 1.5                   /* and standard deviations by which their gain is below zero then */
#define SWING_EXCESSIVE 3.0                /* ratio of both means beyond which a constant roll is contradicted */

struct swing_filter {
    double state[SWING_STATES];            /* offset, m, and direction of the dead reckoning, rad; gain */
    double covariance[SWING_STATES][SWING_STATES];
};

struct mast_swing {
    struct swing_filter every, averaged;   /* by every fix, and by averages */
    double lateral, by_roll;               /* averages of the antenna's lateral position, and of the one that the roll implies, m */
    double expected[2];                    /* where the ground point was expected, m */
    double baseline, recent;               /* normalised innovation squared: long and short mean */
    double baseline_time;                  /* time that the long mean covers so far, s */
    double baseline_floor;                 /* least long mean, by SWING_NOISE */
    int32_t averages;
};

static inline void swing_filter_begin(struct swing_filter *filter)
{
    *filter = (struct swing_filter){.state = {[SWING_GAIN] = 1.0}};
    filter->covariance[SWING_OFFSET][SWING_OFFSET] = OFFSET_PRIOR * OFFSET_PRIOR;
    filter->covariance[SWING_DRIFT][SWING_DRIFT] = DRIFT_PRIOR * DRIFT_PRIOR;
    filter->covariance[SWING_GAIN][SWING_GAIN] = GAIN_PRIOR * GAIN_PRIOR;
}

/* Whether it has begun: before that all is zero. */
static inline int swing_begun(const struct mast_swing *swing)
{
    return swing->baseline_time > 0.0;
}

static inline void swing_begin(struct mast_swing *swing, const double *expected)
{
    *swing = (struct mast_swing){.baseline = 1.0, .baseline_time = SWING_RECENT};
    swing_filter_begin(&swing->every);
    swing_filter_begin(&swing->averaged);
    memcpy(swing->expected, expected, sizeof swing->expected);
}

/* Propagate a filter over a travelled distance (m) to a frame that is so far to the left, m. */
static inline void swing_filter_propagate(struct swing_filter *filter, double corrected, double travelled)
{
    double (*covariance)[SWING_STATES] = filter->covariance;

    filter->state[SWING_OFFSET] += travelled * filter->state[SWING_DRIFT] - corrected;
    for (int i = 0; i < SWING_STATES; ++i)
        covariance[SWING_OFFSET][i] += travelled * covariance[SWING_DRIFT][i];
    for (int i = 0; i < SWING_STATES; ++i)
        covariance[i][SWING_OFFSET] += travelled * covariance[i][SWING_DRIFT];
    covariance[SWING_OFFSET][SWING_OFFSET] += travelled * OFFSET_WALK * OFFSET_WALK;
    covariance[SWING_DRIFT][SWING_DRIFT] += travelled * DRIFT_WALK * DRIFT_WALK;
    covariance[SWING_GAIN][SWING_GAIN] += travelled * GAIN_WALK * GAIN_WALK;
}

/* Propagate over a travelled distance (m) to the next expected ground point; `corrected`: by how much to the left the newest
 * estimate has corrected the last expectation, m. */
static inline void swing_propagate(struct mast_swing *swing, const double *expected, double corrected, double travelled)
{
    swing_filter_propagate(&swing->every, corrected, travelled);
    swing_filter_propagate(&swing->averaged, corrected, travelled);
    swing->lateral -= corrected;
    memcpy(swing->expected, expected, sizeof swing->expected);
}

/* Update a filter with a lateral position and the one that the roll implies, m; noise: standard deviation, m. Returns the
 * normalised innovation squared, clipped; where it is, the offset is another one. */
static inline double swing_filter_update(struct swing_filter *filter, double lateral, double by_roll, double noise)
{
    double cross[SWING_STATES], variance = noise * noise;
    const double innovation = lateral - filter->state[SWING_OFFSET] - by_roll * filter->state[SWING_GAIN];

    for (int i = 0; i < SWING_STATES; ++i)
        cross[i] = filter->covariance[i][SWING_OFFSET] + by_roll * filter->covariance[i][SWING_GAIN];
    variance += cross[SWING_OFFSET] + by_roll * cross[SWING_GAIN];
    const double nis = fmin(innovation * innovation / variance, SWING_JUMP * SWING_JUMP);
    if (nis >= SWING_JUMP * SWING_JUMP) {
        filter->covariance[SWING_OFFSET][SWING_OFFSET] += OFFSET_PRIOR * OFFSET_PRIOR;
        cross[SWING_OFFSET] += OFFSET_PRIOR * OFFSET_PRIOR;
        variance += OFFSET_PRIOR * OFFSET_PRIOR;
    }
    kalman_update(SWING_STATES, filter->state, *filter->covariance, cross, variance, innovation);
    return nis;
}

/* Update with an antenna's lateral position (m, left of the expected ground point) and the one that the roll implies (m).
 * deviation: of the fix, m; learns: whether the long mean is updated; elapsed: since the last sample, s. */
static inline void swing_update(struct mast_swing *swing, double lateral, double by_roll, double deviation, int learns,
                                double elapsed)
{
    const double noise = fmax(deviation, SWING_NOISE);

    if (!isfinite(lateral + by_roll))
        return;
    const double nis = swing_filter_update(&swing->every, lateral, by_roll, noise);
    const double share = swing->averages ? -expm1(-elapsed / SWING_ROCKING) : 1.0;
    swing->averages = 1;
    swing->lateral += share * (lateral - swing->lateral);
    swing->by_roll += share * (by_roll - swing->by_roll);
    swing_filter_update(&swing->averaged, swing->lateral, swing->by_roll, noise);
    swing->baseline_floor = SWING_NOISE / noise * SWING_NOISE / noise;
    swing->baseline_time = fmin(swing->baseline_time + learns * elapsed, SWING_BASELINE);
    swing->baseline -= learns * expm1(-elapsed / swing->baseline_time) * (nis - swing->baseline);
    swing->recent -= expm1(-elapsed / SWING_RECENT) * (nis - swing->recent);
}

/* Whether a filter's gain is so many standard deviations below zero. */
static inline int swing_filter_reversed(const struct mast_swing *swing, const struct swing_filter *filter, double significant)
{
    const double deviation = sqrt(filter->covariance[SWING_GAIN][SWING_GAIN] * fmax(swing->baseline, 1.0));
    return filter->state[SWING_GAIN] < -significant * deviation;
}

/* Whether the antenna moves against the reported roll. */
static inline int swing_reversed(const struct mast_swing *swing)
{
    return swing_filter_reversed(swing, &swing->every, SWING_SIGNIFICANT)
        && swing_filter_reversed(swing, &swing->averaged, SWING_SLOWLY);
}

/* Whether the innovations have grown beyond their long-term variance. */
static inline int swing_excessive(const struct mast_swing *swing)
{
    return swing->recent > SWING_EXCESSIVE * fmax(swing->baseline, swing->baseline_floor);
}

#endif

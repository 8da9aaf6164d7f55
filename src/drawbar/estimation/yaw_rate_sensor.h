/* Yaw-rate sensor of the tractor: bias and scale error of the sensor and the unreported latency of fixes or sensor are
 * estimated and corrected, and a sensor that contradicts the antennas or the wheels is excluded.
 *
 * Antennas and angles give a reference for the tractor's yaw. The lead of the sensor's integral over that reference grows with
 * the bias, and in curves with the scale error. Where fixes are late, the reference lags by the turn that the line through both
 * antennas makes during the latency, in opposite directions in curves to the left and to the right; where the sensor is late,
 * the reference leads. A Kalman filter separates these errors (docs/theory/identification.md). The sensor is used once the
 * variance of the bias is small and its yaw rate has agreed with that of the wheels for a while. Where the innovations grow too
 * large, the sensor is excluded and the filter restarts.
 */
#ifndef DRAWBAR_YAW_RATE_SENSOR_H
#define DRAWBAR_YAW_RATE_SENSOR_H

#include <math.h>
#include <stdint.h>
#include "geometry.h"
#include "kalman_update.h"
#include "noinline.h"

#define DEGREE (DRAWBAR_PI / 180.0)
#define BIAS_PRIOR (2.0 * DEGREE)          /* its prior standard deviation, rad/s */
#define MOST_BIAS (3.0 * BIAS_PRIOR)
#define BIAS_KNOWN (0.4 * DEGREE)          /* standard deviation below which the sensor is used, rad/s */
#define BIAS_WALK (0.005 * DEGREE)         /* its random walk, rad/s per square root of a second */
#define YAW_NOISE (1.5 * DEGREE)           /* standard deviation of one reference, rad */
#define LEAD_PRIOR (2.0 * DEGREE)          /* prior standard deviation of the integral's lead, rad */
#define LEAD_WALK (0.2 * DEGREE)           /* its random walk beside the bias, rad per square root of a second */
#define MOST_LEAD (3.0 * DEGREE)           /* root mean square of the innovations beyond which the sensor is excluded, rad */
#define JUMP_RATE (12.0 * DEGREE)          /* change between samples that no vehicle makes, rad/s */
#define JUMP (6.0 * DEGREE)                /* an innovation that excludes the sensor when it occurs twice in a row, rad */
#define INNOVATION_TIME 1.0                /* time constant of that mean square, s */
#define COMPARISON_TIME 30.0               /* time constant of the comparison with the wheels, s */
#define LEAST_TURNED 27.0                  /* integral of the squared yaw rate that the comparison needs, deg^2 / s */
#define SCALE_TOLERANCE 0.35               /* largest relative difference of the sensor from the wheels */
#define DIFFERENCE_TIME 5.0                /* time constant of its mean difference from the wheels, s */
#define DEVIATION_FACTOR 3.0               /* standard deviations of that difference which are no deviation, */
#define LEAST_DEVIATION (3.0 * DEGREE)     /* and their least value, rad/s */
#define LONGEST_DEVIATION 0.9              /* duration of deviations, faded by that time constant, that excludes the sensor, s */
#define EXCLUSION_TIME 60.0                /* for how long it then stays excluded, s */
#define SCALE_PRIOR 0.03                   /* prior standard deviation of the scale error */
#define MOST_SCALE (3.0 * SCALE_PRIOR)
#define LATENCY_PRIOR 0.1                  /* prior standard deviation of the fixes' latency, s */
#define LATENCY_WALK 0.002                 /* its random walk, s per square root of a second */
#define MOST_LATENCY 0.25                  /* limit of the correction, s */
#define LATENCY_RATE 0.02                  /* rate of the correction, s/s: positions must not jump */

enum { BIAS, LEAD, LATENCY, SCALE, YAW_RATE_STATES };

/* The tractor's yaw by antennas and angles, rad, NaN: unknown; how fast the line through both antennas turns, rad/s. */
struct yaw_reference {
    double yaw, turning;
};

struct yaw_rate_sensor {
    double state[YAW_RATE_STATES];         /* bias, rad/s; lead of the integral, rad; latency of the fixes beyond the
                                              sensor's, s; relative scale error */
    double covariance[YAW_RATE_STATES][YAW_RATE_STATES];
    double latency;                        /* corrected for, s; below zero: of the sensor */
    double integral;                       /* rad */
    double last;                           /* yaw rate of the last sample, rad/s */
    double innovation_variance;            /* mean square of the innovations, rad^2 */
    double wheels_square, cross_product;   /* integrals: of the wheels' yaw rate squared, and times the sensor's, rad^2 / s */
    double mean_difference;                /* from the wheels, rad/s */
    double difference_time;                /* that the variance covers so far, s */
    double difference_variance;            /* about that mean, rad^2 / s^2 */
    double deviating_time;                 /* faded sum of the samples that deviated, s */
    double exclusion;                      /* remaining time of an exclusion, s */
    int32_t integrates;                    /* there is an integral */
    int32_t deviates, jumps;               /* whether the newest deviated; number of JUMPs in a row */
};

/* Whether the filter has begun: before that all is zero. */
static inline int yaw_rate_begun(const struct yaw_rate_sensor *sensor)
{
    return sensor->covariance[LATENCY][LATENCY] > 0.0;
}

/* Reset the filter; the sensor is excluded for a while (s). */
static COLD void yaw_rate_begin(struct yaw_rate_sensor *sensor, double exclusion)
{
    *sensor = (struct yaw_rate_sensor){.latency = sensor->latency, .exclusion = exclusion};
    sensor->covariance[BIAS][BIAS] = BIAS_PRIOR * BIAS_PRIOR;
    sensor->covariance[LATENCY][LATENCY] = LATENCY_PRIOR * LATENCY_PRIOR;
    sensor->covariance[SCALE][SCALE] = SCALE_PRIOR * SCALE_PRIOR;
}

/* Restart the integral from a reference: in a curve that lags by its latency. */
static COLD void yaw_rate_restart_integral(struct yaw_rate_sensor *sensor, const struct yaw_reference *reference)
{
    const double turning = reference->turning;

    sensor->integral = reference->yaw;
    sensor->state[LEAD] = turning * (sensor->latency - sensor->state[LATENCY]);
    sensor->innovation_variance = 0.0;
    sensor->jumps = 0;
    for (int i = 0; i < YAW_RATE_STATES; ++i)
        sensor->covariance[LEAD][i] = -turning * sensor->covariance[LATENCY][i];
    for (int i = 0; i < YAW_RATE_STATES; ++i)
        sensor->covariance[i][LEAD] = -turning * sensor->covariance[i][LATENCY];
    sensor->covariance[LEAD][LEAD] += LEAD_PRIOR * LEAD_PRIOR;
    sensor->integrates = 1;
}

/* Propagate by a yaw rate (rad/s). */
static inline void yaw_rate_integrate(struct yaw_rate_sensor *sensor, double measured, double elapsed)
{
    const double turned = 0.5 * (measured + sensor->last) * elapsed;

    sensor->integral += turned;
    sensor->state[LEAD] += elapsed * sensor->state[BIAS] + turned * sensor->state[SCALE];
    for (int i = 0; i < YAW_RATE_STATES; ++i)
        sensor->covariance[LEAD][i] += elapsed * sensor->covariance[BIAS][i] + turned * sensor->covariance[SCALE][i];
    for (int i = 0; i < YAW_RATE_STATES; ++i)
        sensor->covariance[i][LEAD] += elapsed * sensor->covariance[i][BIAS] + turned * sensor->covariance[i][SCALE];
    sensor->covariance[BIAS][BIAS] += elapsed * BIAS_WALK * BIAS_WALK;
    sensor->covariance[LEAD][LEAD] += elapsed * LEAD_WALK * LEAD_WALK;
    sensor->covariance[LATENCY][LATENCY] += elapsed * LATENCY_WALK * LATENCY_WALK;
}

/* Update with a reference; a jump is not used. */
static inline void yaw_rate_compare(struct yaw_rate_sensor *sensor, const struct yaw_reference *reference, double share)
{
    const double delayed = (sensor->state[LATENCY] - sensor->latency) * reference->turning;
    const double innovation = wrapped(sensor->integral - reference->yaw - sensor->state[LEAD] - delayed);
    double cross[YAW_RATE_STATES], variance = YAW_NOISE * YAW_NOISE;

    sensor->jumps = fabs(innovation) > JUMP ? sensor->jumps + 1 : 0;
    if (sensor->jumps)
        return;
    for (int i = 0; i < YAW_RATE_STATES; ++i)
        cross[i] = sensor->covariance[i][LEAD] + reference->turning * sensor->covariance[i][LATENCY];
    variance += cross[LEAD] + reference->turning * cross[LATENCY];
    sensor->innovation_variance += share * (innovation * innovation - sensor->innovation_variance);
    kalman_update(YAW_RATE_STATES, sensor->state, *sensor->covariance, cross, variance, innovation);
    sensor->state[BIAS] = clipped(sensor->state[BIAS], MOST_BIAS);
    sensor->state[SCALE] = clipped(sensor->state[SCALE], MOST_SCALE);
}

/* Move the corrected latency towards the estimate less its standard deviation. A later sensor's integral is ahead by the turn in
 * that time from now on: what brings its rates up (rate_history.h) adds only what they change by, and a curve that lasts changes
 * nothing. turning: see yaw_reference, rad/s. */
static inline void yaw_rate_apply_latency(struct yaw_rate_sensor *sensor, double turning, double elapsed)
{
    const double state = sensor->state[LATENCY], before = fmin(sensor->latency, 0.0);
    const double significant = state - clipped(state, sqrt(sensor->covariance[LATENCY][LATENCY]));

    sensor->latency += clipped(clipped(significant, MOST_LATENCY) - sensor->latency, LATENCY_RATE * elapsed);
    sensor->integral += (before - fmin(sensor->latency, 0.0)) * turning;
}

/* Whether the sensor agrees with the wheels, judged once the vehicle has turned enough. */
static inline int yaw_rate_agrees(struct yaw_rate_sensor *sensor, double measured, double wheels, double elapsed)
{
    const double kept = exp(-elapsed / COMPARISON_TIME);

    sensor->wheels_square = kept * sensor->wheels_square + elapsed * wheels * wheels;
    sensor->cross_product = kept * sensor->cross_product + elapsed * wheels * measured;
    return sensor->wheels_square > LEAST_TURNED * DEGREE * DEGREE
        && fabs(sensor->cross_product / sensor->wheels_square - 1.0) < SCALE_TOLERANCE;
}

/* Whether the difference from the wheels deviates from its mean by more than its variance explains, as where a sensor changes
 * its sign in a curve, jumps or becomes noisy: the integral would show that later. */
static inline int yaw_rate_deviates(struct yaw_rate_sensor *sensor, double difference, double elapsed)
{
    const double limit = fmax(LEAST_DEVIATION, DEVIATION_FACTOR * sqrt(sensor->difference_variance));
    const double changed = difference - sensor->mean_difference, counted = clipped(changed, limit);
    const int deviates = fabs(changed) > limit;

    sensor->mean_difference -= expm1(-elapsed / DIFFERENCE_TIME) * counted;
    sensor->deviating_time = exp(-elapsed / DIFFERENCE_TIME) * sensor->deviating_time + deviates * elapsed;
    sensor->difference_time = fmin(sensor->difference_time + elapsed, COMPARISON_TIME);
    sensor->difference_variance += fmin(elapsed / sensor->difference_time, 1.0)
        * (counted * counted - sensor->difference_variance);
    return deviates;
}

/* A measured yaw rate without the estimated errors, rad/s. */
static inline double yaw_rate_corrected(const struct yaw_rate_sensor *sensor, double measured)
{
    return measured - sensor->state[SCALE] * measured - sensor->state[BIAS];
}

/* The corrected yaw rate, rad/s; NaN: excluded or unknown.
 *
 * measured: by the sensor, rad/s; wheels: by the wheels, rad/s; elapsed: since the last call, s. */
static inline double yaw_rate_judged(struct yaw_rate_sensor *sensor, double measured, double wheels,
                                     const struct yaw_reference *reference, double elapsed)
{
    const double share = -expm1(-fmax(elapsed, 0.0) / INNOVATION_TIME);

    if (!yaw_rate_begun(sensor))
        yaw_rate_begin(sensor, 0.0);
    sensor->exclusion = fmax(sensor->exclusion - fmax(elapsed, 0.0), 0.0);
    if (!isfinite(measured + wheels) || !(elapsed > 0.0)) {
        sensor->integrates = 0;
        return (double)NAN;
    }
    const int deviates = yaw_rate_deviates(sensor, yaw_rate_corrected(sensor, measured) - wheels, elapsed);
    if (deviates && !sensor->deviates && sensor->integrates && fabs(measured - sensor->last) > JUMP_RATE)
        measured = sensor->last;           /* an outlier must not enter the integral */
    sensor->deviates = deviates;
    if (sensor->integrates)
        yaw_rate_integrate(sensor, measured, elapsed);
    sensor->last = measured;
    if (isfinite(reference->yaw) && !sensor->integrates)
        yaw_rate_restart_integral(sensor, reference);
    else if (isfinite(reference->yaw))
        yaw_rate_compare(sensor, reference, share);
    if (sensor->innovation_variance > MOST_LEAD * MOST_LEAD || sensor->jumps > 1 || sensor->deviating_time > LONGEST_DEVIATION)
        yaw_rate_begin(sensor, EXCLUSION_TIME);
    const double corrected = yaw_rate_corrected(sensor, measured);
    const int known = sensor->covariance[BIAS][BIAS] < BIAS_KNOWN * BIAS_KNOWN;
    const int agrees = known && yaw_rate_agrees(sensor, corrected, wheels, elapsed);
    if (!agrees || deviates || sensor->exclusion > 0.0)
        return (double)NAN;
    yaw_rate_apply_latency(sensor, reference->turning, elapsed);
    return corrected;
}

#endif

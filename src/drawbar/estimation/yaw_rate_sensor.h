/* Yaw-rate sensor of the tractor: the sensor's bias and the error of its scale are found and taken off, the latency of
 * fixes or sensor that nobody tells is found, and a sensor that contradicts the antennas or the wheels is not believed.
 *
 * Antennas and angles show the tractor's yaw by themselves. How far the integral of the sensor's yaw rate runs ahead of
 * that yaw grows with the bias, and in curves with the error of the scale. Where fixes are late, that yaw lags by the turn
 * that the line through both antennas makes during the latency: one way in a curve to the left, the other way in one to
 * the right. Where the sensor is late, the yaw is ahead. A Kalman filter tells these errors from each other
 * (docs/theory/identification.md). The sensor is used once the bias is known and its yaw rate has agreed with that of the
 * wheels for a while. Where the integral departs from the yaw, the sensor is dropped and the filter begins anew.
 */
#ifndef DRAWBAR_YAW_RATE_SENSOR_H
#define DRAWBAR_YAW_RATE_SENSOR_H

#include <math.h>
#include <stdint.h>
#include "geometry.h"

#define DEGREE (DRAWBAR_PI / 180.0)
#define FIRST_BIAS (2.0 * DEGREE)          /* its deviation before anything is known, rad/s */
#define MOST_BIAS (3.0 * FIRST_BIAS)
#define BIAS_KNOWN (0.4 * DEGREE)          /* deviation from which on the sensor is used, rad/s */
#define BIAS_WALK (0.005 * DEGREE)         /* by which it changes, rad/s per square root of a second */
#define YAW_NOISE (1.5 * DEGREE)           /* of one yaw that antennas and angles show, rad */
#define FIRST_LEAD (2.0 * DEGREE)          /* deviation of the integral's first lead, rad */
#define LEAD_WALK (0.2 * DEGREE)           /* by which the lead changes beside the bias, rad per square root of a second */
#define MOST_LEAD (3.0 * DEGREE)           /* a root mean square of unexpected lead that contradicts, rad */
#define LEAP_RATE (12.0 * DEGREE)          /* change from one sample to the next that no vehicle makes, rad/s */
#define LEAP (6.0 * DEGREE)                /* an unexpected lead that does by itself, twice in a row, rad */
#define OBSERVED 1.0                       /* time constant of that mean, s */
#define ALIKE 30.0                         /* time over which the sensor is compared with the wheels, s */
#define TURNED 27.0                        /* what the vehicle has turned in that time before it says anything, deg^2 / s */
#define UNLIKE 0.35                        /* by so much more or less than the wheels the sensor may say */
#define LATELY 5.0                         /* time constant of its mean difference from the wheels, s */
#define SUDDEN 3.0                         /* times its usual deviation from that mean by which it may deviate, */
#define LEAST_SUDDEN (3.0 * DEGREE)        /* and by so much always, rad/s */
#define TOO_OFTEN 0.9                      /* for so long it may have deviated LATELY, s */
#define PATIENCE 60.0                      /* for how long nothing is believed afterwards, s */
#define FIRST_SCALE 0.03                   /* deviation of the share of what it says that is too much */
#define MOST_SCALE (3.0 * FIRST_SCALE)
#define FIRST_LATENCY 0.1                  /* deviation of the fixes' latency before anything is known, s */
#define LATENCY_WALK 0.002                 /* by which it changes, s per square root of a second */
#define MOST_LATENCY 0.25                  /* that is reckoned with, s */
#define LATENCY_RATE 0.02                  /* by which what is reckoned with changes, s/s: positions must not jump */

enum { BIAS, LEAD, LATENCY, SCALE, FOUND };

/* The tractor's yaw as antennas and angles show it, rad, NaN: they do not; how fast the line through both antennas turns,
 * rad/s. */
struct shown_yaw {
    double yaw, turning;
};

struct yaw_rate_sensor {
    double found[FOUND];                   /* bias, rad/s; how far the integral is ahead, rad; by how much the fixes are
                                              later than the sensor, s; share of what the sensor says that is too much */
    double covariance[FOUND][FOUND];
    double latency;                        /* that is reckoned with, s; below zero: the sensor is late */
    double integral;                       /* rad */
    double before;                         /* last sample's yaw rate, rad/s */
    double unexpected;                     /* mean square of the lead beyond what was expected */
    double square, product;                /* of the wheels' yaw rate, and with the sensor's, rad^2 / s */
    double usual;                          /* mean difference from the wheels, rad/s */
    double watched;                        /* over which the next is a mean, s */
    double apart;                          /* mean square of the difference from that, rad^2 / s^2 */
    double suddens;                        /* for how long it was sudden lately, s */
    double doubted;                        /* for how much longer nothing is believed, s */
    int32_t begun, follows;                /* is there anything; is there an integral? */
    int32_t sudden, leaps;                 /* was the newest yaw rate sudden; how many leads in a row were LEAPs? */
};

/* Begin to know the sensor; nothing is believed for a while (s). */
static inline void yaw_rate_begin(struct yaw_rate_sensor *sensor, double doubted)
{
    *sensor = (struct yaw_rate_sensor){.latency = sensor->latency, .doubted = doubted, .begun = 1};
    sensor->covariance[BIAS][BIAS] = FIRST_BIAS * FIRST_BIAS;
    sensor->covariance[LATENCY][LATENCY] = FIRST_LATENCY * FIRST_LATENCY;
    sensor->covariance[SCALE][SCALE] = FIRST_SCALE * FIRST_SCALE;
}

/* Begin the integral anew, from a shown yaw: in a curve it is as far behind as that is late. */
static inline void yaw_rate_follow(struct yaw_rate_sensor *sensor, const struct shown_yaw *shown)
{
    const double turning = shown->turning;

    sensor->integral = shown->yaw;
    sensor->found[LEAD] = turning * (sensor->latency - sensor->found[LATENCY]);
    sensor->unexpected = 0.0;
    sensor->leaps = 0;
    for (int i = 0; i < FOUND; ++i)
        sensor->covariance[LEAD][i] = -turning * sensor->covariance[LATENCY][i];
    for (int i = 0; i < FOUND; ++i)
        sensor->covariance[i][LEAD] = -turning * sensor->covariance[i][LATENCY];
    sensor->covariance[LEAD][LEAD] += FIRST_LEAD * FIRST_LEAD;
    sensor->follows = 1;
}

/* Let the integral go on by a yaw rate (rad/s). */
static inline void yaw_rate_integrate(struct yaw_rate_sensor *sensor, double told, double elapsed)
{
    const double turned = 0.5 * (told + sensor->before) * elapsed;

    sensor->integral += turned;
    sensor->found[LEAD] += elapsed * sensor->found[BIAS] + turned * sensor->found[SCALE];
    for (int i = 0; i < FOUND; ++i)
        sensor->covariance[LEAD][i] += elapsed * sensor->covariance[BIAS][i] + turned * sensor->covariance[SCALE][i];
    for (int i = 0; i < FOUND; ++i)
        sensor->covariance[i][LEAD] += elapsed * sensor->covariance[i][BIAS] + turned * sensor->covariance[i][SCALE];
    sensor->covariance[BIAS][BIAS] += elapsed * BIAS_WALK * BIAS_WALK;
    sensor->covariance[LEAD][LEAD] += elapsed * LEAD_WALK * LEAD_WALK;
    sensor->covariance[LATENCY][LATENCY] += elapsed * LATENCY_WALK * LATENCY_WALK;
}

/* Compare the integral with a shown yaw; of a leap nothing is learned. */
static inline void yaw_rate_compare(struct yaw_rate_sensor *sensor, const struct shown_yaw *shown, double share)
{
    const double late = (sensor->found[LATENCY] - sensor->latency) * shown->turning;
    const double beyond = wrapped(sensor->integral - shown->yaw - sensor->found[LEAD] - late);
    double across[FOUND], variance = YAW_NOISE * YAW_NOISE;

    sensor->leaps = fabs(beyond) > LEAP ? sensor->leaps + 1 : 0;
    if (sensor->leaps)
        return;
    for (int i = 0; i < FOUND; ++i)
        across[i] = sensor->covariance[i][LEAD] + shown->turning * sensor->covariance[i][LATENCY];
    variance += across[LEAD] + shown->turning * across[LATENCY];
    sensor->unexpected += share * (beyond * beyond - sensor->unexpected);
    for (int i = 0; i < FOUND; ++i) {
        sensor->found[i] += across[i] / variance * beyond;
        for (int j = 0; j < FOUND; ++j)
            sensor->covariance[i][j] -= across[i] * across[j] / variance;
    }
    sensor->found[BIAS] = clipped(sensor->found[BIAS], MOST_BIAS);
    sensor->found[SCALE] = clipped(sensor->found[SCALE], MOST_SCALE);
}

/* Reckon with the latency that is surely there. */
static inline void yaw_rate_reckon(struct yaw_rate_sensor *sensor, double elapsed)
{
    const double found = sensor->found[LATENCY];
    const double sure = found - clipped(found, sqrt(sensor->covariance[LATENCY][LATENCY]));

    sensor->latency += clipped(clipped(sure, MOST_LATENCY) - sensor->latency, LATENCY_RATE * elapsed);
}

/* Does the sensor say what the wheels say, as far as the vehicle has turned? */
static inline int yaw_rate_alike(struct yaw_rate_sensor *sensor, double told, double wheels, double elapsed)
{
    const double kept = exp(-elapsed / ALIKE);

    sensor->square = kept * sensor->square + elapsed * wheels * wheels;
    sensor->product = kept * sensor->product + elapsed * wheels * told;
    return sensor->square > TURNED * DEGREE * DEGREE && fabs(sensor->product / sensor->square - 1.0) < UNLIKE;
}

/* Does the difference from the wheels deviate from its mean as it never does? That of a sensor that turns round in a curve,
 * jumps or becomes noisy does, and would bend the estimate before the integral shows it. */
static inline int yaw_rate_sudden(struct yaw_rate_sensor *sensor, double difference, double elapsed)
{
    const double limit = fmax(LEAST_SUDDEN, SUDDEN * sqrt(sensor->apart));
    const double changed = difference - sensor->usual, counted = clipped(changed, limit);
    const int sudden = fabs(changed) > limit;

    sensor->usual -= expm1(-elapsed / LATELY) * counted;
    sensor->suddens = exp(-elapsed / LATELY) * sensor->suddens + sudden * elapsed;
    sensor->watched = fmin(sensor->watched + elapsed, ALIKE);
    sensor->apart += fmin(elapsed / sensor->watched, 1.0) * (counted * counted - sensor->apart);
    return sudden;
}

/* What the sensor says without its errors, rad/s. */
static inline double yaw_rate_right(const struct yaw_rate_sensor *sensor, double told)
{
    return told - sensor->found[SCALE] * told - sensor->found[BIAS];
}

/* Return the yaw rate to be believed, rad/s; NaN: none.
 *
 * told: by the sensor, rad/s; wheels: by the wheels, rad/s; shown: by antennas and angles; elapsed: since the last call, s. */
static inline double yaw_rate_believed(struct yaw_rate_sensor *sensor, double told, double wheels,
                                       const struct shown_yaw *shown, double elapsed)
{
    const double share = -expm1(-fmax(elapsed, 0.0) / OBSERVED);

    if (!sensor->begun)
        yaw_rate_begin(sensor, 0.0);
    sensor->doubted = fmax(sensor->doubted - fmax(elapsed, 0.0), 0.0);
    if (!isfinite(told + wheels) || !(elapsed > 0.0)) {
        sensor->follows = 0;
        return (double)NAN;
    }
    const int sudden = yaw_rate_sudden(sensor, yaw_rate_right(sensor, told) - wheels, elapsed);
    if (sudden && !sensor->sudden && sensor->follows && fabs(told - sensor->before) > LEAP_RATE)
        told = sensor->before;             /* a single false one would spoil the integral */
    sensor->sudden = sudden;
    if (sensor->follows)
        yaw_rate_integrate(sensor, told, elapsed);
    sensor->before = told;
    if (isfinite(shown->yaw) && !sensor->follows)
        yaw_rate_follow(sensor, shown);
    else if (isfinite(shown->yaw))
        yaw_rate_compare(sensor, shown, share);
    if (sensor->unexpected > MOST_LEAD * MOST_LEAD || sensor->leaps > 1 || sensor->suddens > TOO_OFTEN)
        yaw_rate_begin(sensor, PATIENCE);
    const double right = yaw_rate_right(sensor, told);
    const int known = sensor->covariance[BIAS][BIAS] < BIAS_KNOWN * BIAS_KNOWN;
    const int alike = known && yaw_rate_alike(sensor, right, wheels, elapsed);
    if (!alike || sudden || sensor->doubted > 0.0)
        return (double)NAN;
    yaw_rate_reckon(sensor, elapsed);
    return right;
}

#endif

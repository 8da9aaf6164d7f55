/* Yaw sensor: two antennas on the tractor, which measure its yaw.
 *
 * The mounting of the antennas differs from the configured one, and the yaw may be older than reported. Where fixes of both
 * bodies and the angles between them give a reference for the yaw, a Kalman filter estimates both: the mounting's error is the
 * same at all yaw rates, and what the age causes is in proportion to the yaw rate. In turns the yaw is used once its age is known:
 * the loop swings by one that is late. Where the tractor has the only receiver both errors are not observable, and the estimated
 * side-slip absorbs them. A yaw outside its gate, as with wrong ambiguities, is rejected. Once the mounting's error is known the
 * references show whether it has changed, as of an antenna that was bumped: the filter follows such a change in minutes only.
 */
#ifndef DRAWBAR_YAW_SENSOR_H
#define DRAWBAR_YAW_SENSOR_H

#include <math.h>
#include "geometry.h"

#define YAW_REFERENCE_GATE 0.15            /* largest innovation of a reference, rad */
#define YAW_REFERENCE_NOISE 0.026          /* standard deviation of one reference, rad */
#define YAW_ERROR_PRIOR 0.015              /* prior standard deviation of the mounting's error, rad */
#define YAW_ERROR_WALK 1.2e-4              /* its random walk, rad per square root of a second */
#define YAW_ERROR_KNOWN 0.003              /* standard deviation of the mounting's error from which on it is known, rad */
#define YAW_CHANGE_TIME 5.0                /* over which its change is averaged, s */
#define YAW_LATENCY_PRIOR 0.1              /* prior standard deviation of the latency, s */
#define YAW_LATE_MOST 0.0087               /* most that an unknown age may make of a yaw that is used beside a reference, rad */
#define YAW_LATENCY_WALK 0.002             /* its random walk, s per square root of a second */

/* What is known of the tractor's yaw without its sensor. */
struct yaw_known {
    double expected, rate;                 /* rad, rad/s */
    double reference;                      /* by fixes and angles, rad; NaN: unknown */
    double fix_latency;                    /* that these fixes are corrected for, s */
};

struct yaw_sensor {
    double gate;                           /* largest innovation, rad */
    double error;                          /* of the mounting, clockwise, rad */
    double latency;                        /* beyond the reported age, and beyond that of the fixes, s */
    double error_variance, latency_variance, covariance;
    double change;                         /* of the error since it is known, as recent references show it, rad */
};

/* By how much the yaw is older than reported, as far as that is significant, s. Below zero the fixes are: the yaw is then taken
 * to their time, as a yaw and fixes that contradict each other cost more than both being late. */
static inline double yaw_unreported_age(const struct yaw_sensor *sensor, double fix_latency)
{
    const double age = fix_latency + sensor->latency;

    return age - clipped(age, sqrt(sensor->latency_variance));
}

static inline void yaw_begin(struct yaw_sensor *sensor)
{
    sensor->error_variance = YAW_ERROR_PRIOR * YAW_ERROR_PRIOR;
    sensor->latency_variance = YAW_LATENCY_PRIOR * YAW_LATENCY_PRIOR;
}

/* Update with the reference for a measured yaw, rad; elapsed: since the last one, s. */
static inline void yaw_compare(struct yaw_sensor *sensor, const struct yaw_known *known, double measured, double elapsed)
{
    const double rate = known->rate, late = rate * (known->fix_latency + sensor->latency);
    const double innovation = wrapped(known->reference - measured - sensor->error - late);

    if (!(fabs(innovation) <= YAW_REFERENCE_GATE))
        return;
    if (sensor->error_variance < YAW_ERROR_KNOWN * YAW_ERROR_KNOWN)
        sensor->change += fmin(elapsed / YAW_CHANGE_TIME, 1.0) * (innovation - sensor->change);
    sensor->error_variance += elapsed * YAW_ERROR_WALK * YAW_ERROR_WALK;
    sensor->latency_variance += elapsed * YAW_LATENCY_WALK * YAW_LATENCY_WALK;
    const double error = sensor->error_variance + rate * sensor->covariance;
    const double latency = sensor->covariance + rate * sensor->latency_variance;
    const double variance = error + rate * latency + YAW_REFERENCE_NOISE * YAW_REFERENCE_NOISE;
    sensor->error += error / variance * innovation;
    sensor->latency += latency / variance * innovation;
    sensor->error_variance -= error / variance * error;
    sensor->latency_variance -= latency / variance * latency;
    sensor->covariance -= error / variance * latency;
}

/* The measured yaw (rad) without the sensor's errors and with the turns of the expected one; NaN where it is rejected. */
static inline double yaw_judged(struct yaw_sensor *sensor, double measured, const struct yaw_known *known, double elapsed)
{
    if (!(sensor->error_variance > 0.0))
        yaw_begin(sensor);
    const double late = known->rate * yaw_unreported_age(sensor, known->fix_latency);
    const double innovation = wrapped(measured + sensor->error + late - known->expected);

    if (!(fabs(innovation) <= sensor->gate))
        return (double)NAN;
    yaw_compare(sensor, known, measured, elapsed);
    if (isfinite(known->reference) && fabs(known->rate) * sqrt(sensor->latency_variance) > YAW_LATE_MOST)
        return (double)NAN;
    return known->expected + innovation;
}

#endif

/* What a yaw-rate sensor tells of the tractor: its bias is found and taken off, and what contradicts the wheels is not believed.
 *
 * A body turns as far as its estimated yaw changes, whatever the sensor says: what the sensor's integral runs ahead of it
 * grows with the bias. A Kalman filter tells both from each other, and until the bias is known the sensor is not used.
 * What it tells beside the wheels' yaw rate is small and short-lived; a mean of that which lasts shows a sensor that is
 * stuck, reversed, or mounted elsewhere.
 */
#ifndef DRAWBAR_YAW_RATE_SENSOR_H
#define DRAWBAR_YAW_RATE_SENSOR_H

#include <math.h>
#include <stdint.h>
#include "geometry.h"

#define DEGREE (DRAWBAR_PI / 180.0)
#define MOST_BIAS (5.0 * DEGREE)           /* rad/s */
#define FIRST_BIAS (2.0 * DEGREE)          /* its deviation before anything is known, rad/s */
#define BIAS_KNOWN (0.5 * DEGREE)          /* deviation from which on the sensor is used, rad/s */
#define BIAS_WALK (0.005 * DEGREE)         /* by which it changes, rad/s per square root of a second */
#define SLOW 0.3                           /* m/s; below, the wheels' yaw rate is known to SLOW_NOISE, rad/s */
#define SLOW_NOISE (0.5 * DEGREE)
#define YAW_NOISE (5.0 * DEGREE)           /* of estimated yaws, which err for seconds, rad times square root of a second */
#define YAW_WALK (0.1 * DEGREE)            /* of the sensor's integral, rad per square root of a second */
#define FIRST_LEAD (2.0 * DEGREE)          /* deviation of the first estimated yaw, rad */
#define CONTRADICTED (5.0 * DEGREE)        /* mean difference to the wheels' yaw rate beyond which nothing is believed, rad/s */
#define SPIKE (20.0 * DEGREE)              /* a single difference beyond which one value is not believed, rad/s */
#define OBSERVED 1.0                       /* time constant of that mean, s */
#define PATIENCE 10.0                      /* for how long nothing is believed afterwards, s */

struct yaw_rate_sensor {
    double bias, lead;                     /* rad/s; how far its integral is ahead of the estimated yaw, rad */
    double of_bias, of_both, of_lead;      /* their covariance */
    double ahead;                          /* the same as `lead`, as it was observed, rad */
    double difference;                     /* mean of what it tells beyond the wheels' yaw rate, rad/s */
    double doubted;                        /* for how much longer nothing is believed, s */
    double last_yaw;                       /* estimated last, rad */
    int32_t begun, follows;                /* is there anything; has the sensor been integrated since the last yaw? */
};

/* Take in that bias * on_bias + lead * on_lead is so much beyond what is expected, with this deviation. */
static inline void yaw_rate_learn(struct yaw_rate_sensor *sensor, double on_bias, double on_lead, double beyond,
                                  double deviation)
{
    const double bias = sensor->of_bias * on_bias + sensor->of_both * on_lead;
    const double lead = sensor->of_both * on_bias + sensor->of_lead * on_lead;
    const double spread = on_bias * bias + on_lead * lead + deviation * deviation;

    sensor->bias = clipped(sensor->bias + bias / spread * beyond, MOST_BIAS);
    sensor->lead += lead / spread * beyond;
    sensor->of_bias -= bias * bias / spread;
    sensor->of_both -= bias * lead / spread;
    sensor->of_lead -= lead * lead / spread;
}

/* Let the sensor's integral go on by a yaw rate (rad/s) while the estimated yaw turns by an angle (rad). */
static inline void yaw_rate_integrate(struct yaw_rate_sensor *sensor, double told, double turned, double elapsed)
{
    if (!sensor->follows || !(fabs(told * elapsed - turned) < SPIKE)) {
        sensor->ahead = sensor->lead = sensor->of_both = 0.0;
        sensor->of_lead = FIRST_LEAD * FIRST_LEAD;
        sensor->follows = 1;
        return;
    }
    sensor->ahead += told * elapsed - turned;
    sensor->lead += sensor->bias * elapsed;
    sensor->of_lead += elapsed * (2.0 * sensor->of_both + elapsed * sensor->of_bias + YAW_WALK * YAW_WALK);
    sensor->of_both += elapsed * sensor->of_bias;
    sensor->of_bias += elapsed * BIAS_WALK * BIAS_WALK;
    yaw_rate_learn(sensor, 0.0, 1.0, sensor->ahead - sensor->lead, YAW_NOISE / sqrt(elapsed));
}

/* Return the yaw rate to be believed, rad/s; NaN: none.
 *
 * told: by the sensor, rad/s; wheels: by the wheels, rad/s; yaw: newest estimate, a sample ago, rad; speed: m/s; elapsed:
 * since that estimate, s. */
static inline double yaw_rate_believed(struct yaw_rate_sensor *sensor, double told, double wheels, double yaw, double speed,
                                       double elapsed)
{
    if (!sensor->begun)
        *sensor = (struct yaw_rate_sensor){.of_bias = FIRST_BIAS * FIRST_BIAS, .last_yaw = yaw, .begun = 1};
    const double turned = wrapped(yaw - sensor->last_yaw), since = fmax(elapsed, 0.0);

    sensor->last_yaw = yaw;
    sensor->doubted = fmax(sensor->doubted - since, 0.0);
    if (!isfinite(told + wheels + turned) || !(elapsed > 0.0)) {
        sensor->follows = 0;
        return NAN;
    }
    if (fabs(speed) < SLOW)
        yaw_rate_learn(sensor, 1.0, 0.0, told - wheels - sensor->bias, SLOW_NOISE);
    if (sensor->doubted > 0.0)
        sensor->follows = 0;
    else
        yaw_rate_integrate(sensor, told, turned, elapsed);
    const double difference = told - sensor->bias - wheels;
    sensor->difference += -expm1(-elapsed / OBSERVED) * (clipped(difference, SPIKE) - sensor->difference);
    if (fabs(sensor->difference) > CONTRADICTED)
        sensor->doubted = PATIENCE;
    return sensor->doubted > 0.0 || fabs(difference) > SPIKE || sensor->of_bias > BIAS_KNOWN * BIAS_KNOWN ? NAN
                                                                                                     : told - sensor->bias;
}

#endif

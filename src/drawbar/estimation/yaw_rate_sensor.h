/* What a yaw-rate sensor tells of the tractor: its bias is found and taken off, and a sensor that contradicts the
 * antennas or the wheels is not believed.
 *
 * A body turns as far as its antennas and angles show, whatever the sensor says: how far the sensor's integral runs ahead
 * of that yaw grows with the bias. A Kalman filter tells both from each other. The sensor is not used until
 * the bias is known and the sensor has told for a while what the wheels tell; where the integral leaves the yaw it is
 * dropped, and begun with anew.
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
#define LEAD_WALK (0.3 * DEGREE)           /* by which the lead changes beside the bias, rad per square root of a second */
#define MOST_LEAD (3.0 * DEGREE)           /* a root mean square of unexpected lead that contradicts, rad */
#define LEAP (6.0 * DEGREE)                /* a single unexpected lead that does, rad */
#define OBSERVED 1.0                       /* time constant of that mean, s */
#define ALIKE 30.0                         /* time over which the sensor is compared with the wheels, s */
#define TURNED 27.0                        /* what the vehicle has turned in that time before it says anything, deg^2 / s */
#define UNLIKE 0.35                        /* by so much more or less than the wheels the sensor may say */
#define SUDDEN 4.0                         /* times its usual difference from the wheels by which it may differ from them, */
#define LEAST_SUDDEN (6.0 * DEGREE)        /* and by so much always, rad/s */
#define PATIENCE 60.0                      /* for how long nothing is believed afterwards, s */

struct yaw_rate_sensor {
    double bias, lead;                     /* rad/s; how far the integral is ahead, rad */
    double of_bias, of_both, of_lead;      /* their covariance */
    double integral;                       /* rad */
    double beyond;                         /* newest lead beyond what was expected, rad */
    double unexpected;                     /* mean square of the lead beyond what was expected */
    double square, product;                /* of the wheels' yaw rate, and with the sensor's, rad^2 / s */
    double apart;                          /* mean square of the difference from the wheels, rad^2 / s^2 */
    double doubted;                        /* for how much longer nothing is believed, s */
    int32_t begun, follows;                /* is there anything; is there an integral? */
};

/* Begin to know the sensor; nothing is believed for a while (s). */
static inline void yaw_rate_begin(struct yaw_rate_sensor *sensor, double doubted)
{
    *sensor = (struct yaw_rate_sensor){.of_bias = FIRST_BIAS * FIRST_BIAS, .doubted = doubted, .begun = 1};
}

/* Begin the integral anew, from a yaw (rad). */
static inline void yaw_rate_follow(struct yaw_rate_sensor *sensor, double yaw)
{
    sensor->integral = yaw;
    sensor->lead = sensor->of_both = sensor->beyond = sensor->unexpected = 0.0;
    sensor->of_lead = FIRST_LEAD * FIRST_LEAD;
    sensor->follows = 1;
}

/* Let the integral go on by a yaw rate (rad/s). */
static inline void yaw_rate_integrate(struct yaw_rate_sensor *sensor, double told, double elapsed)
{
    sensor->integral += told * elapsed;
    sensor->lead += sensor->bias * elapsed;
    sensor->of_lead += elapsed * (2.0 * sensor->of_both + elapsed * sensor->of_bias + LEAD_WALK * LEAD_WALK);
    sensor->of_both += elapsed * sensor->of_bias;
    sensor->of_bias += elapsed * BIAS_WALK * BIAS_WALK;
}

/* Compare the integral with a yaw (rad). */
static inline void yaw_rate_compare(struct yaw_rate_sensor *sensor, double yaw, double share)
{
    const double beyond = sensor->beyond = wrapped(sensor->integral - yaw - sensor->lead);
    const double spread = sensor->of_lead + YAW_NOISE * YAW_NOISE;
    const double on_bias = sensor->of_both / spread, on_lead = sensor->of_lead / spread;

    sensor->unexpected += share * (beyond * beyond - sensor->unexpected);
    sensor->bias = clipped(sensor->bias + on_bias * beyond, MOST_BIAS);
    sensor->lead += on_lead * beyond;
    sensor->of_bias -= on_bias * sensor->of_both;
    sensor->of_both -= on_bias * sensor->of_lead;
    sensor->of_lead -= on_lead * sensor->of_lead;
}

/* Does the sensor say what the wheels say, as far as the vehicle has turned? */
static inline int yaw_rate_alike(struct yaw_rate_sensor *sensor, double told, double wheels, double elapsed)
{
    const double kept = exp(-elapsed / ALIKE);

    sensor->square = kept * sensor->square + elapsed * wheels * wheels;
    sensor->product = kept * sensor->product + elapsed * wheels * told;
    return sensor->square > TURNED * DEGREE * DEGREE && fabs(sensor->product / sensor->square - 1.0) < UNLIKE;
}

/* Does the sensor differ from the wheels as it never does? One that turns round in a curve does, and would bend the
 * estimate before its integral shows it. */
static inline int yaw_rate_sudden(struct yaw_rate_sensor *sensor, double difference, double elapsed)
{
    const double limit = fmax(LEAST_SUDDEN, SUDDEN * sqrt(sensor->apart)), counted = clipped(difference, limit);

    sensor->apart -= expm1(-elapsed / ALIKE) * (counted * counted - sensor->apart);
    return fabs(difference) > limit;
}

/* Return the yaw rate to be believed, rad/s; NaN: none.
 *
 * told: by the sensor, rad/s; wheels: by the wheels, rad/s; yaw: by antennas and angles, rad, NaN: none; elapsed: since the
 * last call, s. */
static inline double yaw_rate_believed(struct yaw_rate_sensor *sensor, double told, double wheels, double yaw, double elapsed)
{
    const double share = -expm1(-fmax(elapsed, 0.0) / OBSERVED);

    if (!sensor->begun)
        yaw_rate_begin(sensor, 0.0);
    sensor->doubted = fmax(sensor->doubted - fmax(elapsed, 0.0), 0.0);
    if (!isfinite(told + wheels) || !(elapsed > 0.0)) {
        sensor->follows = 0;
        return NAN;
    }
    if (sensor->follows)
        yaw_rate_integrate(sensor, told, elapsed);
    if (isfinite(yaw) && !sensor->follows)
        yaw_rate_follow(sensor, yaw);
    else if (isfinite(yaw))
        yaw_rate_compare(sensor, yaw, share);
    if (sensor->unexpected > MOST_LEAD * MOST_LEAD || fabs(sensor->beyond) > LEAP)
        yaw_rate_begin(sensor, PATIENCE);
    const int known = sensor->of_bias < BIAS_KNOWN * BIAS_KNOWN;
    const int alike = known && yaw_rate_alike(sensor, told - sensor->bias, wheels, elapsed);
    const int sudden = yaw_rate_sudden(sensor, told - sensor->bias - wheels, elapsed);
    return alike && !sudden && !(sensor->doubted > 0.0) ? told - sensor->bias : NAN;
}

#endif

/* Body lag: the delay of the tractor's yaw rate behind its steering angle (docs/theory/identification.md).
 *
 * The stated lag per speed, plus that of the ground's creep, is the prior; a yaw-rate sensor identifies the rest. It is the
 * only state of a Kalman filter, whose innovation is the yaw rate minus that of the delayed steering angle: its sensitivity to
 * the lag is the rate of that angle.
 */
#ifndef DRAWBAR_BODY_LAG_H
#define DRAWBAR_BODY_LAG_H

#include <math.h>
#include <stdint.h>
#include <string.h>
#include "geometry.h"
#include "spike_filter.h"
#include "signals.h"

#define MOST_BODY_LAG 0.3                  /* s */
#define ANGLES 18                          /* samples of steering that are kept, more than the longest lag's */
#define LAG_PRIOR 0.1                      /* prior standard deviation of the lag beyond the stated one, s */
#define LAG_MEMORY 240.0                   /* time constant of forgetting, s */
#define LAG_NOISE 0.052                    /* standard deviation of one innovation; several in a row are correlated, rad/s */
#define LAG_HIGH_PASS 3.0                  /* time constant of the high pass that removes constant errors, s */

struct body_lag {
    double per_speed;                      /* on firm ground, s^2/m; 0: the tractor turns as its wheels stand, on any ground */
    double wheelbase, sample_time;         /* m, s */
    double lag;                            /* in effect, s */
    double beyond, variance;               /* estimated lag beyond the stated one, s, s^2 */
    double most_change;                    /* of the angle between two samples, of the spike filter, rad */
    struct spike_filter filter;            /* of the angle */
    double angles[ANGLES];                 /* of the front wheels, newest first, NaN: missing as yet, rad */
    double means[2];                       /* of innovation and sensitivity, rad/s, rad/s^2 */
};

#define BODY_LAG_FIELDS(type, place)                                                                               \
    SETTING(type, place.per_speed, 0, 1, 0, 0) SETTING(type, place.wheelbase, 0, 1, 0, 0)                          \
    SETTING(type, place.sample_time, 0, 1, 0, 0) SETTING(type, place.most_change, 0, 1, 0, 0)                        \
    FIELD(type, place.beyond, 0, 1, 0, 0) FIELD(type, place.variance, 0, 1, 0, 0)

/* Speed over ground, m/s. */
static inline double ground_speed(const struct drawbar_estimate *estimate)
{
    return estimate->longitudinal_slip * estimate->speed;
}

/* The lag of a body at an estimate, s, with so much beyond what is stated: on ground that creeps the yaw rate follows the
 * wheels with the time constant speed creep / g. As much again the path turns later than the yaw, by the side-slip of
 * a curve, which is in the models (side_slip.h). */
static inline double body_lag_with(const struct body_lag *body, const struct drawbar_estimate *at, double beyond)
{
    const double stated = ground_speed(at) * (body->per_speed + at->creep / GRAVITY);

    return clamped(stated + beyond, 0.0, MOST_BODY_LAG);
}

/* Set the lag in effect at an estimate: the identified part counts less by one standard deviation. */
static inline void body_lag_apply(struct body_lag *body, const struct drawbar_estimate *now)
{
    const double significant = body->beyond - clipped(body->beyond, sqrt(body->variance));

    body->lag = body->per_speed > 0.0 && ground_speed(now) > 0.0 ? body_lag_with(body, now, significant) : 0.0;
}

/* Initialise with wheels that rest at an angle, rad. */
static inline void body_lag_begin(struct body_lag *body, double angle)
{
    for (int i = 0; i < ANGLES; ++i)
        body->angles[i] = angle;
    body->beyond = body->means[0] = body->means[1] = 0.0;
    body->variance = LAG_PRIOR * LAG_PRIOR;
}

/* Advance by one sample. */
static inline void body_lag_pass(struct body_lag *body)
{
    memmove(body->angles + 1, body->angles, (ANGLES - 1) * sizeof *body->angles);
    body->angles[0] = (double)NAN;
}

/* Record the newest angle (rad), and interpolate those that are missing just before it. */
static inline void body_lag_record(struct body_lag *body, double angle)
{
    int last = 1;

    while (last < ANGLES && isnan(body->angles[last]))
        ++last;
    const double turned = last < ANGLES ? (body->angles[last] - angle) / last : 0.0;
    for (int i = 0; i < last; ++i)
        body->angles[i] = angle + i * turned;
}

/* The angle at which the wheels stood before a lag, and how fast they turned then; rad, rad/s. A third of the rate is that of
 * the newest sample: over two samples alone, angles that alternate would seem to rest. */
static inline double body_lag_angle(const struct body_lag *body, double lag, double *rate)
{
    const double samples = fmin(lag / body->sample_time, ANGLES - 3.0);
    const int i = (int)samples;

    *rate = (2.0 * body->angles[i] - body->angles[i + 1] - body->angles[i + 2]) / (3.0 * body->sample_time);
    return body->angles[i] + (samples - i) * (body->angles[i + 1] - body->angles[i]);
}

/* Update with a yaw rate (rad/s) that was measured before this age (s), and brought up to now by what the wheels turned since:
 * it differs from theirs by as much as it did then. last: the last estimate. */
static inline void body_lag_learn(struct body_lag *body, const struct drawbar_estimate *last, double yaw_rate, double age)
{
    const double turning = ground_speed(last) * last->tractor_slip / body->wheelbase;
    const double share = body->sample_time / LAG_HIGH_PASS, forgotten = 2.0 * body->sample_time / LAG_MEMORY;
    double rate, rate_now;
    const double lag = body_lag_with(body, last, body->beyond), delayed = body_lag_angle(body, lag, &rate_now);
    (void)body_lag_angle(body, lag + (age > 0.0 ? age : 0.0), &rate);   /* of the time at which it was measured */
    double errors[] = {yaw_rate - turning * delayed, -turning * rate};

    if (!isfinite(errors[0] + errors[1]))
        return;
    for (int i = 0; i < 2; ++i) {
        body->means[i] += share * (errors[i] - body->means[i]);
        errors[i] -= body->means[i];
    }
    body->beyond *= 1.0 - 0.5 * forgotten;
    body->variance += forgotten * (LAG_PRIOR * LAG_PRIOR - body->variance);
    const double cross = body->variance * errors[1], gain = cross / (cross * errors[1] + LAG_NOISE * LAG_NOISE);
    body->beyond = clipped(body->beyond + gain * errors[0], MOST_BODY_LAG);
    body->variance -= gain * cross;
}

/* Replace the measured steering angle by the delayed one, which turns the tractor now. last: the last estimate; share: of the
 * lag that is applied. */
static inline void body_lag_measured(struct body_lag *body, const struct drawbar_estimate *last, double share,
                                     struct drawbar_measurement *m)
{
    double rate;

    if (!(body->per_speed > 0.0))
        return;
    if (!body->filter.initialised && isfinite(m->tractor_steering))
        body_lag_begin(body, m->tractor_steering);
    m->tractor_steering = spike_filtered(&body->filter, body->most_change, m->tractor_steering);
    if (!body->filter.initialised)
        return;
    if (isfinite(m->tractor_steering))
        body_lag_record(body, m->tractor_steering);
    body_lag_learn(body, last, m->tractor_yaw_rate, m->tractor_attitude_age);
    m->tractor_steering = body_lag_angle(body, share * body->lag, &rate);
}

#endif

/* Body lag: by how much the tractor turns later than its wheels stand (docs/theory/identification.md).
 *
 * What is stated per speed, and what the ground's creep adds, is where it begins; a yaw-rate sensor shows the rest. A Kalman
 * filter has it as its only state: by so much more lag the yaw rate is off that of the wheels as they stood before the lag,
 * in proportion to how fast they turned then.
 */
#ifndef DRAWBAR_BODY_LAG_H
#define DRAWBAR_BODY_LAG_H

#include <math.h>
#include <stdint.h>
#include <string.h>
#include "geometry.h"
#include "leap.h"
#include "signals.h"

#define MOST_BODY_LAG 0.3                  /* s */
#define ANGLES 18                          /* samples of steering that are kept, more than the longest lag's */
#define LAG_DEVIATION 0.1                 /* of the lag beyond what is stated, before anything is known, s */
#define LAG_MEMORY 240.0                   /* time in which what was found is forgotten, s */
#define LAG_BLUR 0.052                     /* deviation of one error, of which several in a row say the same, rad/s */
#define LAG_PASS 3.0                       /* time over which errors are none of the lag's, s */

struct body_lag {
    double per_speed;                      /* on firm ground, s^2/m; 0: the tractor turns as its wheels stand, on any ground */
    double wheelbase, sample_time;         /* m, s */
    double lag;                            /* that is reckoned with, s */
    double beyond, variance;               /* what was found beyond what is stated, s, s^2 */
    double most_leap;                      /* of the angle from one sample to the next, unless the next is so, too, rad */
    struct leap leap;                      /* has begun with the first angle */
    double angles[ANGLES];                 /* of the front wheels, newest first, NaN: missing as yet, rad */
    double means[2];                       /* of the error and of what it is per lag, rad/s, rad/s^2 */
};

#define BODY_LAG_FIELDS(type, place)                                                                               \
    SETTING(type, place.per_speed, 0, 1, 0, 0) SETTING(type, place.wheelbase, 0, 1, 0, 0)                          \
    SETTING(type, place.sample_time, 0, 1, 0, 0) SETTING(type, place.most_leap, 0, 1, 0, 0)                        \
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

/* Reckon with the lag at an estimate. What was found counts nearer to zero by its deviation. */
static inline void body_lag_reckon(struct body_lag *body, const struct drawbar_estimate *now)
{
    const double sure = body->beyond - clipped(body->beyond, sqrt(body->variance));

    body->lag = body->per_speed > 0.0 && ground_speed(now) > 0.0 ? body_lag_with(body, now, sure) : 0.0;
}

/* Begin with wheels that rest at an angle, rad. */
static inline void body_lag_begin(struct body_lag *body, double angle)
{
    for (int i = 0; i < ANGLES; ++i)
        body->angles[i] = angle;
    body->beyond = body->means[0] = body->means[1] = 0.0;
    body->variance = LAG_DEVIATION * LAG_DEVIATION;
}

/* Let a sample pass. */
static inline void body_lag_pass(struct body_lag *body)
{
    memmove(body->angles + 1, body->angles, (ANGLES - 1) * sizeof *body->angles);
    body->angles[0] = (double)NAN;
}

/* Let the newest angle (rad) tell those that are missing just before it: till then the wheels turned evenly. */
static inline void body_lag_enter(struct body_lag *body, double angle)
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
static inline double body_lag_stood(const struct body_lag *body, double lag, double *rate)
{
    const double samples = fmin(lag / body->sample_time, ANGLES - 3.0);
    const int i = (int)samples;

    *rate = (2.0 * body->angles[i] - body->angles[i + 1] - body->angles[i + 2]) / (3.0 * body->sample_time);
    return body->angles[i] + (samples - i) * (body->angles[i + 1] - body->angles[i]);
}

/* Learn from a yaw rate (rad/s) that was measured before this age (s), and brought up to now by what the wheels turned since:
 * it differs from theirs by as much as it did then. last: the last estimate. */
static inline void body_lag_learn(struct body_lag *body, const struct drawbar_estimate *last, double yaw_rate, double age)
{
    const double turning = ground_speed(last) * last->tractor_slip / body->wheelbase;
    const double share = body->sample_time / LAG_PASS, forgotten = 2.0 * body->sample_time / LAG_MEMORY;
    double rate;
    const double lag = body_lag_with(body, last, body->beyond), stood = body_lag_stood(body, lag, &rate);
    body_lag_stood(body, lag + (age > 0.0 ? age : 0.0), &rate);
    double errors[] = {yaw_rate - turning * stood, -turning * rate};

    if (!isfinite(errors[0] + errors[1]))
        return;
    for (int i = 0; i < 2; ++i) {
        body->means[i] += share * (errors[i] - body->means[i]);
        errors[i] -= body->means[i];
    }
    body->beyond *= 1.0 - 0.5 * forgotten;
    body->variance += forgotten * (LAG_DEVIATION * LAG_DEVIATION - body->variance);
    const double across = body->variance * errors[1], gain = across / (across * errors[1] + LAG_BLUR * LAG_BLUR);
    body->beyond = clipped(body->beyond + gain * errors[0], MOST_BODY_LAG);
    body->variance -= gain * across;
}

/* Let a measurement have the angle with which the front wheels turn the tractor now. last: the last estimate; share: of the
 * lag that counts. */
static inline void body_lag_take(struct body_lag *body, const struct drawbar_estimate *last, double share,
                                 struct drawbar_measurement *m)
{
    double rate;

    if (!(body->per_speed > 0.0))
        return;
    if (!body->leap.begun && isfinite(m->tractor_steering))
        body_lag_begin(body, m->tractor_steering);
    m->tractor_steering = leap_masked(&body->leap, body->most_leap, m->tractor_steering);
    if (!body->leap.begun)
        return;
    if (isfinite(m->tractor_steering))
        body_lag_enter(body, m->tractor_steering);
    body_lag_learn(body, last, m->tractor_yaw_rate, m->tractor_attitude_age);
    m->tractor_steering = body_lag_stood(body, share * body->lag, &rate);
}

#endif

/* Actuation of both steerings: dead time, lag and rate between command and angle, identified during the run.
 *
 * Plans assume the longer of both dead times and both rates, which are approached gradually, and commands lead the steering
 * by the identified lags: a controller's command is made for an actuator of the stated lag and its predicted angle, and is
 * scaled about that angle for another lag. The mean difference of a measured angle from its commands is subtracted from them:
 * plans are made in the angles that the sensors measure.
 */
#ifndef DRAWBAR_ACTUATION_H
#define DRAWBAR_ACTUATION_H

#include "frozen_signal.h"
#include "lag_bank.h"
#include "signals.h"
#include "unit.h"

#define OFFSET_SETTLING 15.0               /* time constant of the offsets, s; they rest while an angle repeats itself */
#define STUCK_SHARE 0.5                    /* of the residual limit, by which a steering moves while a sensor is stuck */
#define STUCK_FAR 2.0                      /* times that motion from which on a sample counts as so many */

enum { FRONT_WHEELS, TRAILER_JOINT, STEERED };

struct component {
    struct lag_grid grid;
    struct lag_bank banks[STEERED];
    double limits[STEERED];                /* largest commands, rad */
    double sign;                           /* -1 where the joint's actuator is reversed, else 1 */
    double sample_time;                    /* s */
    double settling;                       /* share of a difference by which the planned values change in a sample */
    double dead_time, lags[STEERED], rates[STEERED];   /* that plans assume, s, rad/s */
    double offsets[STEERED];               /* of the measured angles from the commands, rad */
    double residual, patience;             /* limits of the unexplained error, rad, and of its duration, s */
    double unexplained_time[STEERED];      /* for how long the error has exceeded its limit, s */
    struct frozen_signal frozen[STEERED];  /* measured angle, and that of the likeliest member, rad */
    double stuck_time[STEERED];            /* for how long that has moved too far, weighted by the distance, s */
    double ages[STEERED];                  /* of the measured angles, s: a reported age counts as dead time */
    int32_t updates, unprocessed;          /* number of likelihood updates; there are angles that await one */
};

#define COMPONENT_FIELDS                                                                                          \
    LAG_GRID_FIELDS(component, grid) LAG_BANK_FIELDS(component, banks[FRONT_WHEELS])                                   \
    LAG_BANK_FIELDS(component, banks[TRAILER_JOINT]) SETTING(component, limits, 0, STEERED, 0, 0)                      \
    SETTING(component, sign, 0, 1, 0, 0) SETTING(component, sample_time, 0, 1, 0, 0)                                   \
    SETTING(component, settling, 0, 1, 0, 0) SETTING(component, dead_time, 0, 1, 0, 0)                                 \
    SETTING(component, lags, 0, STEERED, 0, 0) SETTING(component, rates, 0, STEERED, 0, 0)                             \
    SETTING(component, residual, 0, 1, 0, 0) SETTING(component, patience, 0, 1, 0, 0)                                  \
    FIELD(component, unexplained_time, 0, STEERED, 0, 0) FIELD(component, stuck_time, 0, STEERED, 0, 0)

/* Move the planned values towards the identified ones. */
static void approach(struct component *actuation)
{
    const struct lag_bank *banks = actuation->banks;
    const double wanted = fmax(fmax(banks[FRONT_WHEELS].dead_time - actuation->ages[FRONT_WHEELS],
                                    banks[TRAILER_JOINT].dead_time - actuation->ages[TRAILER_JOINT]), 0.0);

    actuation->dead_time += actuation->settling * (wanted - actuation->dead_time);
    for (int i = 0; i < STEERED; ++i) {
        actuation->lags[i] += actuation->settling * (banks[i].lag - actuation->lags[i]);
        actuation->rates[i] += actuation->settling * (banks[i].rate - actuation->rates[i]);
        if (actuation->frozen[i].repeated == 0)
            actuation->offsets[i] += actuation->sample_time / OFFSET_SETTLING
                * (bank_offset(&banks[i], &actuation->grid) - actuation->offsets[i]);
    }
}

/* Whether a steering has failed to follow its commands for too long, whatever its dead time and its lag are. */
static int does_not_follow(struct component *actuation, int i, double measured)
{
    const int exceeds = bank_unexplained(&actuation->banks[i], measured) > actuation->residual;

    actuation->unexplained_time[i] = exceeds ? actuation->unexplained_time[i] + actuation->sample_time : 0.0;
    return actuation->unexplained_time[i] > actuation->patience;
}

/* Whether a measured angle has stayed the very same for too long after commands should have moved it. By how much the expected
 * angle was wrong when the sensor last changed, it may only be catching up. */
static int is_stuck(struct component *actuation, int i, double measured, double speed)
{
    struct frozen_signal *frozen = &actuation->frozen[i];

    const struct lag_bank *bank = &actuation->banks[i];
    const double expected = bank->angle[bank_likeliest(bank, &actuation->grid)] + actuation->offsets[i];
    frozen_update(frozen, measured, expected, speed);
    const double least = STUCK_SHARE * actuation->residual, missed = frozen_excess(frozen, least, frozen->error) / least;

    if (!(missed > 1.0)) {
        actuation->stuck_time[i] = 0.0;
        return 0;
    }
    actuation->stuck_time[i] += fmin(missed, STUCK_FAR) * actuation->sample_time;
    return actuation->stuck_time[i] > actuation->patience || frozen_repetition(frozen) >= 1.0;
}

/* Preparation for the next measurement. The likelihoods of one bank are updated here, in turn: they average over a minute and
 * may be a sample late, the command may not. */
int UNIT(ready)(struct component *actuation)
{
    for (int i = 0; i < STEERED; ++i)
        bank_follow(&actuation->banks[i], &actuation->grid);
    if (actuation->unprocessed)
        bank_update(&actuation->banks[actuation->updates++ % STEERED], &actuation->grid);
    actuation->unprocessed = 0;
    return 0;
}

/* Update with the steering angles of a measurement; returns 0 or the status with which the run ends. */
int UNIT(measured)(struct component *actuation, const struct drawbar_measurement *measurement)
{
    const double measured[] = {measurement->tractor_steering, measurement->trailer_steering};
    const double ages[] = {measurement->tractor_steering_age, measurement->trailer_steering_age};

    for (int i = 0; i < STEERED; ++i)
        actuation->ages[i] = ages[i] >= 0.0 && ages[i] <= 1.0 ? ages[i] : 0.0;
    UNIT(ready)(actuation);
    for (int i = 0; i < STEERED; ++i)
        if (actuation->banks[i].initialised)
            bank_measured(&actuation->banks[i], &actuation->grid, measured[i]);
        else
            bank_begin(&actuation->banks[i], measured[i]);
    actuation->unprocessed = 1;
    approach(actuation);
    int faults = 0;
    for (int i = 0; i < STEERED; ++i)
        faults += does_not_follow(actuation, i, measured[i]) + is_stuck(actuation, i, measured[i], measurement->speed);
    return faults ? DRAWBAR_STEERING : 0;
}

/* Record a sent command, and add the offsets: the angle that the sensors will measure. */
int UNIT(sent)(struct component *actuation, struct drawbar_command *command)
{
    if (!actuation->banks[FRONT_WHEELS].initialised)
        return 0;
    bank_command(&actuation->banks[FRONT_WHEELS], &actuation->grid, command->tractor_steering);
    bank_command(&actuation->banks[TRAILER_JOINT], &actuation->grid, actuation->sign * command->trailer_steering);
    command->tractor_steering += actuation->offsets[FRONT_WHEELS];
    command->trailer_steering += actuation->sign * actuation->offsets[TRAILER_JOINT];
    return 0;
}

/* By how much a command leads a lagging steering per angle that it is to move in a sample. */
static inline double lead(double sample_time, double lag)
{
    return -1.0 / expm1(-sample_time / lag);
}

/* Scale a command, made for the stated lag, about the predicted angle of the steering, rad; both and the offset in the
 * command's own sign. scale: error of its sensor. */
static inline double scaled(const struct component *actuation, int i, double command, double found, double scale, double offset)
{
    const double share = lead(actuation->sample_time, actuation->lags[i])
        / lead(actuation->sample_time, actuation->banks[i].stated_lag);
    const double wanted = (found + share * (command - found)) / (1.0 + scale) - offset;

    return isfinite(wanted) ? clamped(wanted, -actuation->limits[i], actuation->limits[i]) : command;
}

/* Convert commands for the stated lags to the identified lags; `then` is the estimate when they begin to act; joint_scale: error
 * of the sensor by which the joint is moved. */
int UNIT(adapt)(const struct component *actuation, const struct drawbar_estimate *then, double joint_scale, double *tractor,
                double *trailer)
{
    const double *const offsets = actuation->offsets, sign = actuation->sign;

    *tractor = scaled(actuation, FRONT_WHEELS, *tractor, then->tractor_steering, 0.0, offsets[FRONT_WHEELS]);
    *trailer = scaled(actuation, TRAILER_JOINT, *trailer, sign * then->trailer_steering, joint_scale,
                      sign * offsets[TRAILER_JOINT]);
    return 0;
}

static inline void report_body(const struct lag_bank *bank, struct drawbar_body_actuation *body)
{
    body->dead_time = bank->dead_time;
    body->dead_time_deviation = bank->dead_time_deviation;
    body->lag = bank->lag;
    body->lag_deviation = bank->lag_deviation;
    body->rate = bank->rate;
    body->rate_deviation = bank->rate_deviation;
}

/* Report the identified values, and those that plans assume. */
int UNIT(report)(const struct component *actuation, struct drawbar_actuation *report)
{
    report_body(&actuation->banks[FRONT_WHEELS], &report->tractor);
    report_body(&actuation->banks[TRAILER_JOINT], &report->trailer);
    report->dead_time = actuation->dead_time;
    report->tractor_lag = actuation->lags[FRONT_WHEELS];
    report->trailer_lag = actuation->lags[TRAILER_JOINT];
    report->tractor_rate = actuation->rates[FRONT_WHEELS];
    report->trailer_rate = actuation->rates[TRAILER_JOINT];
    return 0;
}

#endif

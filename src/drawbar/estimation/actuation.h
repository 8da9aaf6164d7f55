/* Actuation of both steerings: dead time, lag and rate between command and angle as far as they are known, from the run
 * itself.
 *
 * Plans are made for the later of both dead times and for both rates, approached gradually, and commands lead the steering
 * by the lags that were found: a controller's command moves an actuator of the stated lag from the angle at which it will
 * find it, and is stretched about that angle for one of another lag. What a measured angle is off its commands on average is
 * taken off them: the plans are made in what the sensors say.
 */
#ifndef DRAWBAR_ACTUATION_H
#define DRAWBAR_ACTUATION_H

#include "lag_bank.h"
#include "signals.h"
#include "still.h"
#include "unit.h"

#define OFFSET_SETTLING 15.0               /* s; and not while an angle repeats itself: it may be stuck */
#define STUCK_SHARE 0.5                    /* of the error that nothing explains, by which a steering moves beside a stuck sensor */
#define STUCK_FAR 2.0                      /* times as far, and further, a sample counts as so many */

enum { FRONT_WHEELS, TRAILER_JOINT, STEERED };

struct component {
    struct lag_grid grid;
    struct lag_bank banks[STEERED];
    double limits[STEERED];                /* largest commands, rad */
    double sign;                           /* -1 where the joint's actuator is reversed, else 1 */
    double sample_time;                    /* s */
    double settling;                       /* share of a difference by which what is planned with changes in a sample */
    double dead_time, lags[STEERED], rates[STEERED];   /* what is planned with, s, rad/s */
    double offsets[STEERED];               /* of the measured angles from the commands, rad */
    double odd, patience;                  /* error that nothing explains, rad, and for how long it may last, s */
    double odd_for[STEERED];               /* for how long it has, s */
    struct still still[STEERED];           /* the measured angle, and the likeliest member's, rad */
    double stuck_for[STEERED];             /* for how long that has moved too far, longer the further, s */
    double ages[STEERED];                  /* of the measured angles, s: they count as dead time where they are told */
    int32_t judged, unjudged;              /* how often a bank was judged; there are angles that none is judged by yet */
};

#define COMPONENT_FIELDS                                                                                          \
    LAG_GRID_FIELDS(component, grid) LAG_BANK_FIELDS(component, banks[FRONT_WHEELS])                                   \
    LAG_BANK_FIELDS(component, banks[TRAILER_JOINT]) SETTING(component, limits, 0, STEERED, 0, 0)                      \
    SETTING(component, sign, 0, 1, 0, 0) SETTING(component, sample_time, 0, 1, 0, 0)                                   \
    SETTING(component, settling, 0, 1, 0, 0) SETTING(component, dead_time, 0, 1, 0, 0)                                 \
    SETTING(component, lags, 0, STEERED, 0, 0) SETTING(component, rates, 0, STEERED, 0, 0)                             \
    SETTING(component, odd, 0, 1, 0, 0) SETTING(component, patience, 0, 1, 0, 0)                                       \
    FIELD(component, odd_for, 0, STEERED, 0, 0) FIELD(component, stuck_for, 0, STEERED, 0, 0)

/* Let what is planned with approach what is known. */
static void approach(struct component *actuation)
{
    const struct lag_bank *banks = actuation->banks;
    const double wanted = fmax(fmax(banks[FRONT_WHEELS].dead_time - actuation->ages[FRONT_WHEELS],
                                    banks[TRAILER_JOINT].dead_time - actuation->ages[TRAILER_JOINT]), 0.0);

    actuation->dead_time += actuation->settling * (wanted - actuation->dead_time);
    for (int i = 0; i < STEERED; ++i) {
        actuation->lags[i] += actuation->settling * (banks[i].lag - actuation->lags[i]);
        actuation->rates[i] += actuation->settling * (banks[i].rate - actuation->rates[i]);
        if (actuation->still[i].repeated == 0)
            actuation->offsets[i] += actuation->sample_time / OFFSET_SETTLING
                * (bank_offset(&banks[i], &actuation->grid) - actuation->offsets[i]);
    }
}

/* Whether one steering has not followed its commands for too long, whatever its dead time and its lag are. */
static int does_not_follow(struct component *actuation, int i, double measured)
{
    const int odd = bank_unexplained(&actuation->banks[i], measured) > actuation->odd;

    actuation->odd_for[i] = odd ? actuation->odd_for[i] + actuation->sample_time : 0.0;
    return actuation->odd_for[i] > actuation->patience;
}

/* Whether a measured angle has stayed the very same for too long after commands should have moved it. */
static int is_stuck(struct component *actuation, int i, double measured, double speed)
{
    struct still *still = &actuation->still[i];

    const struct lag_bank *bank = &actuation->banks[i];
    still_take(still, measured, bank->angle[bank_likeliest(bank, &actuation->grid)], speed);
    const double least = STUCK_SHARE * actuation->odd, missed = still_missed(still, least) / least;

    if (!(missed > 1.0)) {
        actuation->stuck_for[i] = 0.0;
        return 0;
    }
    actuation->stuck_for[i] += fmin(missed, STUCK_FAR) * actuation->sample_time;
    return actuation->stuck_for[i] > actuation->patience || still_unusual(still) >= 1.0;
}

/* Do what can be done before the next measurement. A bank is judged here, one after the other: what the last angles say
 * about a minute may wait for a sample, the command may not. */
int UNIT(ready)(struct component *actuation)
{
    for (int i = 0; i < STEERED; ++i)
        bank_follow(&actuation->banks[i], &actuation->grid);
    if (actuation->unjudged)
        bank_judge(&actuation->banks[actuation->judged++ % STEERED], &actuation->grid);
    actuation->unjudged = 0;
    return 0;
}

/* Take in the steering angles of a measurement; returns 0 or the status with which the run ends. */
int UNIT(measured)(struct component *actuation, const struct drawbar_measurement *measurement)
{
    const double measured[] = {measurement->tractor_steering, measurement->trailer_steering};
    const double ages[] = {measurement->tractor_steering_age, measurement->trailer_steering_age};

    for (int i = 0; i < STEERED; ++i)
        actuation->ages[i] = ages[i] >= 0.0 && ages[i] <= 1.0 ? ages[i] : 0.0;
    UNIT(ready)(actuation);
    for (int i = 0; i < STEERED; ++i)
        if (actuation->banks[i].begun)
            bank_measured(&actuation->banks[i], &actuation->grid, measured[i]);
        else
            bank_begin(&actuation->banks[i], measured[i]);
    actuation->unjudged = 1;
    approach(actuation);
    int odd = 0;
    for (int i = 0; i < STEERED; ++i)
        odd += does_not_follow(actuation, i, measured[i]) + is_stuck(actuation, i, measured[i], measurement->speed);
    return odd ? DRAWBAR_STEERING : 0;
}

/* Take in the command that was sent, and make it what the sensors will say of it. */
int UNIT(sent)(struct component *actuation, struct drawbar_command *command)
{
    if (!actuation->banks[FRONT_WHEELS].begun)
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

/* Stretch a command, made for the stated lag, about the angle at which it will find the steering, rad; both and the offset
 * in the command's own sign. */
static inline double stretched(const struct component *actuation, int i, double command, double found, double offset)
{
    const double share = lead(actuation->sample_time, actuation->lags[i])
        / lead(actuation->sample_time, actuation->banks[i].prior_lag);
    const double wanted = found + share * (command - found) - offset;

    return isfinite(wanted) ? clamped(wanted, -actuation->limits[i], actuation->limits[i]) : command;
}

/* Make commands for the stated lags ones for the lags that were found; `then` is the estimate when they begin to act. */
int UNIT(adapt)(const struct component *actuation, const struct drawbar_estimate *then, double *tractor, double *trailer)
{
    const double *const offsets = actuation->offsets, sign = actuation->sign;

    *tractor = stretched(actuation, FRONT_WHEELS, *tractor, then->tractor_steering, offsets[FRONT_WHEELS]);
    *trailer = stretched(actuation, TRAILER_JOINT, *trailer, sign * then->trailer_steering, sign * offsets[TRAILER_JOINT]);
    return 0;
}

static inline void tell_body(const struct lag_bank *bank, struct drawbar_body_actuation *body)
{
    body->dead_time = bank->dead_time;
    body->dead_time_deviation = bank->dead_time_deviation;
    body->lag = bank->lag;
    body->lag_deviation = bank->lag_deviation;
    body->rate = bank->rate;
    body->rate_deviation = bank->rate_deviation;
}

/* Tell what is known, and what is planned with. */
int UNIT(tell)(const struct component *actuation, struct drawbar_actuation *told)
{
    tell_body(&actuation->banks[FRONT_WHEELS], &told->tractor);
    tell_body(&actuation->banks[TRAILER_JOINT], &told->trailer);
    told->dead_time = actuation->dead_time;
    told->tractor_lag = actuation->lags[FRONT_WHEELS];
    told->trailer_lag = actuation->lags[TRAILER_JOINT];
    told->tractor_rate = actuation->rates[FRONT_WHEELS];
    told->trailer_rate = actuation->rates[TRAILER_JOINT];
    return 0;
}

#endif

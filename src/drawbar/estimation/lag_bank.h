/* Lag bank of one steering: dead time, lag and rate, identified from commands and measured angles by a bank of models
 * (Magill 1965).
 *
 * Each member is a rate-limited first-order lag behind a dead time, driven by the commands alone. Mean and variance of its
 * error against the measured angle cover the last minute; the mean is the sensor's zero. With unknown noise the likelihood of a
 * member is that variance to the power of minus half the number of independent errors; with a prior it gives the mean and the
 * standard deviation of dead time, lag and rate. Without motion all members are equally likely, and the prior stays.
 *
 * Members are arranged in rows of all lags: a row for each dead time, with the identified rate, and then one for each rate,
 * with the identified dead time. When the identified rate changes, most of the first rows' statistics is discarded.
 */
#ifndef DRAWBAR_LAG_BANK_H
#define DRAWBAR_LAG_BANK_H

#include <math.h>
#include <stdint.h>
#include <string.h>
#include "geometry.h"

#define DEAD_TIMES 17
#define LAGS 12
#define RATES 10
#define ROWS (DEAD_TIMES + RATES)
#define MEMBERS (ROWS * LAGS)
#define PAST 426                           /* parts of samples in the command history: more than the longest dead time */
#define ERROR_LIMIT 0.15                   /* at which an error is clipped: a driver steers, rad */
#define OFFSET_SAMPLES 10.0                /* weight of the prior offset, zero, in samples */
#define RATE_CHANGE 1.15                   /* ratio from which on the identified rate has changed */
#define RATE_KEPT 0.05                     /* share of the statistics that is kept then */
#define NO_SHARE -40.0                     /* logarithm of a probability relative to the largest that is left out: 4e-18 */

/* Settings that both steerings share. */
struct lag_grid {
    double part;                           /* s; a sample has `parts` of them */
    double dead_times[DEAD_TIMES];         /* s */
    double lags[LAGS], shares[LAGS];       /* s; the share of an error that goes in a part, 1 - exp(-part / lag) */
    double slower[RATES];                  /* logarithms of the rates in shares of the stated one, which is the first */
    double memory;                         /* share of the statistics that is kept from sample to sample */
    double repeats;                        /* correlation length of the errors, samples */
    double between[3];                     /* variances of dead time (s2), lag and rate (logarithms) between two members */
    double resolution;                     /* least standard deviation of the errors, rad */
    double prior_dead_time_deviation, prior_lag_deviation;   /* s, of the lag's logarithm */
    double prior_rate;                     /* logarithm of the odds for the prior rate against each other */
    int32_t parts;
    int32_t delays[DEAD_TIMES];            /* dead times in parts */
};

#define LAG_GRID_FIELDS(type, place)                                                                         \
    SETTING(type, place.part, 0, 1, 0, 0) SETTING(type, place.dead_times, 0, DEAD_TIMES, 0, 0)               \
    SETTING(type, place.lags, 0, LAGS, 0, 0) SETTING(type, place.shares, 0, LAGS, 0, 0)                      \
    SETTING(type, place.memory, 0, 1, 0, 0) SETTING(type, place.repeats, 0, 1, 0, 0)                         \
    SETTING(type, place.slower, 0, RATES, 0, 0) SETTING(type, place.between, 0, 3, 0, 0)                     \
    SETTING(type, place.resolution, 0, 1, 0, 0) SETTING(type, place.prior_dead_time_deviation, 0, 1, 0, 0)   \
    SETTING(type, place.prior_lag_deviation, 0, 1, 0, 0) SETTING(type, place.prior_rate, 0, 1, 0, 0)         \
    SETTING(type, place.parts, 1, 1, 0, 0) SETTING(type, place.delays, 1, DEAD_TIMES, 0, 0)

struct lag_bank {
    double stated_lag, stated_rate;        /* s, rad/s */
    double prior_dead_time, prior_lag, prior_rate;   /* as stated or remembered, s, s, rad/s */
    double dead_time, dead_time_deviation, lag, lag_deviation, rate, rate_deviation;   /* as identified, s, rad/s */
    double past[PAST];                     /* commands of the last parts of samples, a ring, rad */
    double angle[MEMBERS];                 /* of each member, rad */
    double driven_rate;                    /* of the rows of dead times, rad/s */
    double weight, rate_weight;            /* weighted number of samples, for rows of dead times and of rates */
    double error[MEMBERS], square[MEMBERS];   /* sums over the samples, rad, rad2 */
    int32_t newest, initialised, pending;  /* pending: parts of samples that the members have still to follow */
};

#define LAG_BANK_FIELDS(type, place)                                                                         \
    SETTING(type, place.stated_lag, 0, 1, 0, 0) SETTING(type, place.stated_rate, 0, 1, 0, 0)                 \
    SETTING(type, place.prior_dead_time, 0, 1, 0, 0) SETTING(type, place.prior_lag, 0, 1, 0, 0)              \
    SETTING(type, place.prior_rate, 0, 1, 0, 0)                                                              \
    SETTING(type, place.dead_time, 0, 1, 0, 0) SETTING(type, place.dead_time_deviation, 0, 1, 0, 0)          \
    SETTING(type, place.lag, 0, 1, 0, 0) SETTING(type, place.lag_deviation, 0, 1, 0, 0)                      \
    SETTING(type, place.rate, 0, 1, 0, 0) SETTING(type, place.rate_deviation, 0, 1, 0, 0)

/* Initialise with a steering that rests at an angle, rad. */
static void bank_begin(struct lag_bank *bank, double angle)
{
    const double first = isfinite(angle) ? angle : 0.0;

    for (int i = 0; i < PAST; ++i)
        bank->past[i] = first;
    for (int i = 0; i < MEMBERS; ++i)
        bank->angle[i] = first;
    bank->driven_rate = bank->rate;
    bank->initialised = 1;
}

/* A value within +-most. The loops over members become SIMD code with it, with fmin and fmax they would not. */
static inline double within(double value, double most)
{
    const double low = value < -most ? -most : value;
    return low > most ? most : low;
}

/* Index of the value (n) that comes nearest to another. */
static inline int nearest_of(const double *values, int n, double wanted)
{
    int nearest = 0;

    for (int i = 1; i < n; ++i)
        if (fabs(values[i] - wanted) < fabs(values[nearest] - wanted))
            nearest = i;
    return nearest;
}

/* Simulate all members over the pending commands. */
static void bank_follow(struct lag_bank *bank, const struct lag_grid *grid)
{
    const int likeliest = nearest_of(grid->dead_times, DEAD_TIMES, bank->dead_time);

    for (int row = 0; bank->pending > 0 && row < ROWS; ++row) {
        const int32_t delay = grid->delays[row < DEAD_TIMES ? row : likeliest];
        const double rate = row < DEAD_TIMES ? bank->driven_rate : bank->stated_rate * exp(grid->slower[row - DEAD_TIMES]);
        double *restrict angle = bank->angle + row * LAGS;
        for (int32_t pending = bank->pending; pending > 0; --pending) {
            const double command = bank->past[(bank->newest + 2 * PAST + 1 - pending - delay) % PAST];
            for (int l = 0; l < LAGS; ++l)
                angle[l] += within(grid->shares[l] * (command - angle[l]), rate * grid->part);
        }
    }
    bank->pending = 0;
}

/* Record a command (rad) for one sample. The members follow later, at the latest before they are evaluated. */
static void bank_command(struct lag_bank *bank, const struct lag_grid *grid, double command)
{
    bank_follow(bank, grid);
    for (int32_t part = 0; part < grid->parts; ++part) {
        bank->newest = (bank->newest + 1) % PAST;
        bank->past[bank->newest] = command;
    }
    bank->pending = grid->parts;
}

/* Update the statistics with a measured angle, rad. */
static void bank_measured(struct lag_bank *bank, const struct lag_grid *grid, double measured)
{
    if (!isfinite(measured))
        return;
    bank->weight = grid->memory * bank->weight + 1.0;
    bank->rate_weight = grid->memory * bank->rate_weight + 1.0;
    for (int i = 0; i < MEMBERS; ++i) {
        const double error = within(measured - bank->angle[i], ERROR_LIMIT);
        bank->error[i] = grid->memory * bank->error[i] + error;
        bank->square[i] = grid->memory * bank->square[i] + error * error;
    }
}

/* The member nearest to the identified dead time and lag. */
static inline int bank_likeliest(const struct lag_bank *bank, const struct lag_grid *grid)
{
    return nearest_of(grid->dead_times, DEAD_TIMES, bank->dead_time) * LAGS + nearest_of(grid->lags, LAGS, bank->lag);
}

/* Mean difference (rad) of the measured angle from the simulated one over the last minute: the sensor's zero, or a steady
 * error of the actuator. */
static inline double bank_offset(const struct lag_bank *bank, const struct lag_grid *grid)
{
    return bank->error[bank_likeliest(bank, grid)] / (bank->weight + OFFSET_SAMPLES);
}

/* Least residual (rad) of a measured angle over all members, each corrected by its mean error: what no dead time and no lag
 * explain. */
static double bank_unexplained(const struct lag_bank *bank, double measured)
{
    const double share = bank->weight > OFFSET_SAMPLES ? 1.0 / bank->weight : 0.0;
    double nearest[LAGS], least = (double)INFINITY;

    if (!isfinite(measured))
        return 0.0;
    for (int l = 0; l < LAGS; ++l)
        nearest[l] = (double)INFINITY;
    for (int d = 0; d < DEAD_TIMES; ++d)
        for (int l = 0; l < LAGS; ++l) {
            const double off = fabs(measured - bank->angle[d * LAGS + l] - share * bank->error[d * LAGS + l]);
            nearest[l] = off < nearest[l] ? off : nearest[l];
        }
    for (int l = 0; l < LAGS; ++l)
        least = nearest[l] < least ? nearest[l] : least;
    return least;
}

/* The logarithms of the members' probabilities, but for a constant. */
static void bank_likelihoods(const struct lag_bank *bank, const struct lag_grid *grid, double *log_probability)
{
    const double least = grid->resolution * grid->resolution;
    const int prior_rate = nearest_of(grid->slower, RATES, log(bank->prior_rate / bank->stated_rate));
    double lag_deviation[LAGS];

    for (int l = 0; l < LAGS; ++l)
        lag_deviation[l] = log(grid->lags[l] / bank->prior_lag) / grid->prior_lag_deviation;
    for (int i = 0; i < MEMBERS; ++i) {
        const int row = i / LAGS;
        const double delay_deviation = row < DEAD_TIMES
            ? (grid->dead_times[row] - bank->prior_dead_time) / grid->prior_dead_time_deviation : 0.0;
        const double weight = row < DEAD_TIMES ? bank->weight : bank->rate_weight;
        const double mean = bank->error[i] / weight, variance = bank->square[i] / weight - mean * mean;
        log_probability[i] = -0.5 * (weight / grid->repeats * log((variance > 0.0 ? variance : 0.0) + least)
                                     + delay_deviation * delay_deviation + lag_deviation[i % LAGS] * lag_deviation[i % LAGS])
            - (row >= DEAD_TIMES && row - DEAD_TIMES != prior_rate ? grid->prior_rate : 0.0);
    }
}

/* Simulate the rows of dead times with the identified rate, if that has changed. */
static void bank_change_rate(struct lag_bank *bank)
{
    if (fmax(bank->rate / bank->driven_rate, bank->driven_rate / bank->rate) < RATE_CHANGE)
        return;
    bank->driven_rate = bank->rate;
    bank->weight *= RATE_KEPT;
    for (int i = 0; i < DEAD_TIMES * LAGS; ++i) {
        bank->error[i] *= RATE_KEPT;
        bank->square[i] *= RATE_KEPT;
    }
}

/* Sums over members: of probabilities, and of their first and second moments by row and by lag. */
struct bank_sums {
    double all, row[2], lag[2];
};

static struct bank_sums bank_sum(const double *log_probability, int rows, const double *values, const double *lags)
{
    struct bank_sums sums = {0.0, {0.0, 0.0}, {0.0, 0.0}};
    double most = -(double)INFINITY, log_lags[LAGS];

    for (int l = 0; l < LAGS; ++l)
        log_lags[l] = log(lags[l]);
    for (int i = 0; i < rows * LAGS; ++i)
        most = log_probability[i] > most ? log_probability[i] : most;
    for (int i = 0; i < rows * LAGS; ++i) {
        const double relative = log_probability[i] - most;
        if (relative < NO_SHARE)
            continue;                      /* most members */
        const double each = exp(relative), value = values[i / LAGS], lag = log_lags[i % LAGS];
        sums.all += each;
        sums.row[0] += each * value;
        sums.row[1] += each * value * value;
        sums.lag[0] += each * lag;
        sums.lag[1] += each * lag * lag;
    }
    return sums;
}

/* Mean and standard deviation of a value from its moments; between: its variance between two members. */
static inline double bank_mean(double all, const double *sums, double between, double *deviation)
{
    const double mean = sums[0] / all, variance = sums[1] / all - mean * mean;

    *deviation = sqrt((variance > 0.0 ? variance : 0.0) + between);
    return mean;
}

/* Update the estimates of dead time, lag and rate. */
static void bank_update(struct lag_bank *bank, const struct lag_grid *grid)
{
    double log_probability[MEMBERS];

    if (!(bank->weight > 0.0))
        return;
    bank_likelihoods(bank, grid, log_probability);
    const struct bank_sums first = bank_sum(log_probability, DEAD_TIMES, grid->dead_times, grid->lags);
    const struct bank_sums second = bank_sum(log_probability + DEAD_TIMES * LAGS, RATES, grid->slower, grid->lags);
    bank->dead_time = bank_mean(first.all, first.row, grid->between[0], &bank->dead_time_deviation);
    bank->lag = exp(bank_mean(first.all, first.lag, grid->between[1], &bank->lag_deviation));
    bank->lag_deviation *= bank->lag;
    bank->rate = bank->stated_rate * exp(bank_mean(second.all, second.row, grid->between[2], &bank->rate_deviation));
    bank->rate_deviation *= bank->rate;
    bank_change_rate(bank);
}

#endif

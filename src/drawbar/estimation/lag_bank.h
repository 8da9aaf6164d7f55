/* Lag bank of one steering: dead time and lag, from what it was commanded and what it did, by a bank of models (Magill
 * 1965).
 *
 * Each member is a lag of limited rate behind a dead time, driven by the commands alone. The errors of its angle against the
 * measured one are averaged over the last minute; a constant error is nobody's fault (the sensor's zero). With unknown
 * noise the likelihood of a member is its error's variance to the power of minus half the number of independent errors;
 * with a prior it gives the mean and the deviation of dead time and lag. While nothing moves all members are right alike,
 * and the prior stays.
 */
#ifndef DRAWBAR_LAG_BANK_H
#define DRAWBAR_LAG_BANK_H

#include <math.h>
#include <stdint.h>
#include <string.h>
#include "geometry.h"

#define DEAD_TIMES 17
#define LAGS 12
#define MEMBERS (DEAD_TIMES * LAGS)
#define PAST 512                           /* parts of samples that are kept: more than the longest dead time's */
#define NO_STEERING 0.15                   /* errors beyond are somebody else's steering, rad */
#define KNOWN_ZERO 10.0                    /* samples after which the sensor's zero is known */

/* What is the same for both steerings. */
struct lag_grid {
    double part;                           /* s; a sample has `parts` of them */
    double dead_times[DEAD_TIMES];         /* s */
    double lags[LAGS], shares[LAGS];       /* s; the share of an error that goes in a part, 1 - exp(-part / lag) */
    double memory;                         /* share of what is known that is kept from sample to sample */
    double repeats;                        /* how many errors in a row say the same */
    double between[2];                     /* variances of dead time (s2) and of the lag's logarithm between two members */
    double resolution;                     /* least standard deviation of the errors, rad */
    double prior_dead_time, prior_dead_time_deviation, prior_lag_deviation;   /* s, s, of the lag's logarithm */
    int32_t parts;
    int32_t delays[DEAD_TIMES];            /* dead times in parts */
};

#define LAG_GRID_FIELDS(type, place)                                                                         \
    SETTING(type, place.part, 0, 1, 0, 0) SETTING(type, place.dead_times, 0, DEAD_TIMES, 0, 0)               \
    SETTING(type, place.lags, 0, LAGS, 0, 0) SETTING(type, place.shares, 0, LAGS, 0, 0)                      \
    SETTING(type, place.memory, 0, 1, 0, 0) SETTING(type, place.repeats, 0, 1, 0, 0)                         \
    SETTING(type, place.between, 0, 2, 0, 0)                                                                 \
    SETTING(type, place.resolution, 0, 1, 0, 0) SETTING(type, place.prior_dead_time, 0, 1, 0, 0)             \
    SETTING(type, place.prior_dead_time_deviation, 0, 1, 0, 0)                                               \
    SETTING(type, place.prior_lag_deviation, 0, 1, 0, 0) SETTING(type, place.parts, 1, 1, 0, 0)              \
    SETTING(type, place.delays, 1, DEAD_TIMES, 0, 0)

struct lag_bank {
    double prior_lag, rate;                /* s; of the steering at most, rad/s */
    double dead_time, dead_time_deviation, lag, lag_deviation;   /* what is known, s */
    double past[PAST];                     /* commands of the last parts of samples, a ring, rad */
    double angle[MEMBERS];                 /* of each member, rad */
    double weight, error[MEMBERS], square[MEMBERS];   /* sums over the samples: 1, rad, rad2 */
    int32_t newest, begun, behind;         /* behind: parts of samples that the members have still to follow */
};

#define LAG_BANK_FIELDS(type, place)                                                                         \
    SETTING(type, place.prior_lag, 0, 1, 0, 0) SETTING(type, place.rate, 0, 1, 0, 0)                         \
    SETTING(type, place.dead_time, 0, 1, 0, 0) SETTING(type, place.dead_time_deviation, 0, 1, 0, 0)          \
    SETTING(type, place.lag, 0, 1, 0, 0) SETTING(type, place.lag_deviation, 0, 1, 0, 0)

/* Begin with a steering that rests at an angle, rad. */
static void bank_begin(struct lag_bank *bank, double angle)
{
    const double first = isfinite(angle) ? angle : 0.0;

    for (int i = 0; i < PAST; ++i)
        bank->past[i] = first;
    for (int i = 0; i < MEMBERS; ++i)
        bank->angle[i] = first;
    bank->begun = 1;
}

/* A value within +-most. The loops over members become SIMD code with it, with fmin and fmax they would not. */
static inline double within(double value, double most)
{
    const double low = value < -most ? -most : value;
    return low > most ? most : low;
}

/* Let all members follow the commands that they are behind of. */
static void bank_follow(struct lag_bank *bank, const struct lag_grid *grid)
{
    const double most = bank->rate * grid->part;

    for (; bank->behind > 0; --bank->behind)
        for (int d = 0; d < DEAD_TIMES; ++d) {
            const double command = bank->past[(bank->newest + 2 * PAST + 1 - bank->behind - grid->delays[d]) % PAST];
            double *restrict angle = bank->angle + d * LAGS;
            for (int l = 0; l < LAGS; ++l)
                angle[l] += within(grid->shares[l] * (command - angle[l]), most);
        }
}

/* Let a sample pass under a command, rad. The members follow when there is time, at the latest before they are looked at. */
static void bank_command(struct lag_bank *bank, const struct lag_grid *grid, double command)
{
    bank_follow(bank, grid);
    for (int32_t part = 0; part < grid->parts; ++part) {
        bank->newest = (bank->newest + 1) % PAST;
        bank->past[bank->newest] = command;
    }
    bank->behind = grid->parts;
}

/* Take in a measured angle, rad. */
static void bank_measured(struct lag_bank *bank, const struct lag_grid *grid, double measured)
{
    if (!isfinite(measured))
        return;
    bank->weight = grid->memory * bank->weight + 1.0;
    for (int i = 0; i < MEMBERS; ++i) {
        const double error = within(measured - bank->angle[i], NO_STEERING);
        bank->error[i] = grid->memory * bank->error[i] + error;
        bank->square[i] = grid->memory * bank->square[i] + error * error;
    }
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

/* The angle of the member whose dead time and lag are nearest to those found, rad. */
static double bank_likeliest(const struct lag_bank *bank, const struct lag_grid *grid)
{
    return bank->angle[nearest_of(grid->dead_times, DEAD_TIMES, bank->dead_time) * LAGS
                       + nearest_of(grid->lags, LAGS, bank->lag)];
}

/* By how much (rad) a measured angle is off that of the member which comes nearest to it, each with the mean error that it
 * has had: what no dead time and no lag explain. */
static double bank_unexplained(const struct lag_bank *bank, double measured)
{
    const double known = bank->weight > KNOWN_ZERO ? 1.0 : 0.0, weight = known > 0.0 ? bank->weight : 1.0;
    double nearest[LAGS], least = INFINITY;

    if (!isfinite(measured))
        return 0.0;
    for (int l = 0; l < LAGS; ++l)
        nearest[l] = INFINITY;
    for (int d = 0; d < DEAD_TIMES; ++d)
        for (int l = 0; l < LAGS; ++l) {
            const double off = fabs(measured - bank->angle[d * LAGS + l] - known * (bank->error[d * LAGS + l] / weight));
            nearest[l] = off < nearest[l] ? off : nearest[l];
        }
    for (int l = 0; l < LAGS; ++l)
        least = nearest[l] < least ? nearest[l] : least;
    return least;
}

/* The logarithms of the members' probabilities, but for a constant; returns the largest. */
static double bank_likelihoods(const struct lag_bank *bank, const struct lag_grid *grid, double *log_probability)
{
    const double samples = bank->weight / grid->repeats, least = grid->resolution * grid->resolution;
    double slow[LAGS], most = -INFINITY;

    for (int l = 0; l < LAGS; ++l)
        slow[l] = log(grid->lags[l] / bank->prior_lag) / grid->prior_lag_deviation;
    for (int i = 0; i < MEMBERS; ++i) {
        const double early = (grid->dead_times[i / LAGS] - grid->prior_dead_time) / grid->prior_dead_time_deviation;
        const double mean = bank->error[i] / bank->weight, spread = bank->square[i] / bank->weight - mean * mean;
        log_probability[i] = -0.5 * (samples * log((spread > 0.0 ? spread : 0.0) + least)
                                     + early * early + slow[i % LAGS] * slow[i % LAGS]);
        most = log_probability[i] > most ? log_probability[i] : most;
    }
    return most;
}

/* Find what is known of dead time and lag. */
static void bank_judge(struct lag_bank *bank, const struct lag_grid *grid)
{
    double log_probability[MEMBERS], lags[LAGS], sum = 0.0, moments[4] = {0.0, 0.0, 0.0, 0.0};

    if (!(bank->weight > 0.0))
        return;
    const double most = bank_likelihoods(bank, grid, log_probability);
    for (int l = 0; l < LAGS; ++l)
        lags[l] = log(grid->lags[l]);
    for (int i = 0; i < MEMBERS; ++i) {
        const double probability = exp(log_probability[i] - most);
        const double dead_time = grid->dead_times[i / LAGS], lag = lags[i % LAGS];
        sum += probability;
        moments[0] += probability * dead_time;
        moments[1] += probability * dead_time * dead_time;
        moments[2] += probability * lag;
        moments[3] += probability * lag * lag;
    }
    const double dead_time = moments[0] / sum, lag = moments[2] / sum;
    bank->dead_time = dead_time;
    bank->dead_time_deviation = sqrt(fmax(moments[1] / sum - dead_time * dead_time, 0.0) + grid->between[0]);
    bank->lag = exp(lag);
    bank->lag_deviation = bank->lag * sqrt(fmax(moments[3] / sum - lag * lag, 0.0) + grid->between[1]);
}

#endif

/* Lean bank: the ground's slope and the zeros of both attitude sensors, and whether a roll sensor is reversed, by a bank of
 * Kalman filters (multiple-model estimation, Magill 1965).
 *
 * On a slope a body that turns leans another way: roll and pitch of both bodies, in all headings, are those of one slope, beside
 * the zeros of the sensors, which turn with neither (lean_on in ground_record.h). One Kalman filter for each hypothesis
 * about the signs of both rolls estimates the slope, a random walk along the path, and the zeros; unevenness is its measurement
 * noise. A hypothesis changes nothing but the signs of the measurements, so all share one covariance.
 */
#ifndef DRAWBAR_LEAN_BANK_H
#define DRAWBAR_LEAN_BANK_H

#include <math.h>
#include <stdint.h>
#include "geometry.h"

enum { SLOPE_EAST, SLOPE_NORTH, ZEROS, LEANS = ZEROS + 4 };   /* zeros: roll and pitch of the tractor, of the trailer */
enum { ROLL, PITCH };

#define SIGNS 4                            /* hypotheses: bit 0, the tractor's roll is reversed; bit 1, the trailer's */
#define SLOPE_PRIOR (8.0 * DRAWBAR_PI / 180.0)   /* its prior standard deviation, rad */
#define SLOPE_WALK (0.2 * DRAWBAR_PI / 180.0)   /* least random walk of the slope, rad per square root of a metre */
#define WALK_FALL 0.1                      /* share of a decrease of its variance that one piece may cause */
#define ZERO_PRIOR (1.5 * DRAWBAR_PI / 180.0)   /* prior standard deviation of a zero, rad */
#define ZERO_WALK (0.01 * DRAWBAR_PI / 180.0)   /* its random walk, rad per square root of a metre */
#define LEAN_NOISE (1.0 * DRAWBAR_PI / 180.0)   /* least standard deviation of a measured angle, rad */
#define LEAN_CORRELATION 3.0               /* correlation length of the unevenness, m */
#define LEAN_AVERAGE 30.0                  /* distance over which the residual variance is averaged, m */
#define LEAN_OUTLIER 3.0                   /* standard deviations at which an innovation is clipped */
#define LEAN_CERTAIN 7.0                   /* logarithm of the odds beyond which a hypothesis is rejected, */
#define LEAN_CLOSE 2.0                     /* below which it is as likely as the best, */
#define LEAN_MOST 16.0                     /* and at which it restarts from the best: a sign that changes now */

struct lean_bank {
    double states[SIGNS][LEANS];           /* of each hypothesis; zeros with its signs, rad */
    double covariance[LEANS][LEANS];
    double log_odds[SIGNS];                /* logarithm of the odds of the likeliest to each */
    double residual_variance;              /* mean square of the residuals, rad2 */
    double walk;                           /* variance per metre of the slope's random walk, rad2/m */
    double corrected[ZEROS], expected;     /* corrections of the slope on this piece, and their expected square, rad, rad2 */
    double piece;                          /* its length as yet, m */
};

static inline void lean_bank_begin(struct lean_bank *bank)
{
    *bank = (struct lean_bank){.residual_variance = LEAN_NOISE * LEAN_NOISE, .walk = SLOPE_WALK * SLOPE_WALK};
    for (int i = 0; i < LEANS; ++i)
        bank->covariance[i][i] = i < ZEROS ? SLOPE_PRIOR * SLOPE_PRIOR : ZERO_PRIOR * ZERO_PRIOR;
}

/* Whether it has begun: before that all is zero. */
static inline int lean_bank_begun(const struct lean_bank *bank)
{
    return bank->walk > 0.0;
}

/* Adapt the variance of the slope's walk after each piece: its corrections there, squared, are expected to be the decrease of its
 * variance by them; what is beyond that the walk has left out (covariance matching, Mehra 1972). The two corrections of one piece
 * are often small by chance, so the walk decreases slowly. */
static inline void lean_bank_adapt(struct lean_bank *bank)
{
    const double east = bank->corrected[SLOPE_EAST], north = bank->corrected[SLOPE_NORTH];
    const double beyond = east * east + north * north - bank->expected;

    if (bank->piece < LEAN_CORRELATION)
        return;
    bank->walk += (beyond > 0.0 ? 1.0 : WALK_FALL) * beyond / (2.0 * bank->piece);
    bank->walk = fmax(bank->walk, SLOPE_WALK * SLOPE_WALK);
    bank->corrected[SLOPE_EAST] = bank->corrected[SLOPE_NORTH] = bank->expected = bank->piece = 0.0;
}

/* Propagate the covariance over a travelled distance, m. */
static inline void lean_bank_propagate(struct lean_bank *bank, double travelled)
{
    bank->piece += travelled;
    lean_bank_adapt(bank);
    for (int i = 0; i < LEANS; ++i)
        bank->covariance[i][i] += travelled * (i < ZEROS ? bank->walk : ZERO_WALK * ZERO_WALK);
}

/* The measurement row of an angle: coefficients of the slope's components, and the index of the zero. */
struct lean_row {
    double east, north;
    int zero;
};

/* The measurement row of an angle of a body with this yaw, rad. */
static inline struct lean_row lean_row(int body, int angle, double yaw)
{
    const double along = cos(yaw), across = sin(yaw);

    return (struct lean_row){angle == ROLL ? -across : along, angle == ROLL ? along : across, ZEROS + 2 * body + angle};
}

/* The sign of a measurement under a hypothesis. */
static inline double lean_sign(int hypothesis, int body, int angle)
{
    return angle == ROLL && (hypothesis >> body & 1) ? -1.0 : 1.0;
}

static inline double lean_of(const struct lean_row *row, const double *state)
{
    return row->east * state[SLOPE_EAST] + row->north * state[SLOPE_NORTH] + state[row->zero];
}

static inline int lean_bank_likeliest(const struct lean_bank *bank)
{
    int likeliest = 0;

    for (int h = 1; h < SIGNS; ++h)
        likeliest = bank->log_odds[h] < bank->log_odds[likeliest] ? h : likeliest;
    return likeliest;
}

/* Update all hypotheses with a measured angle (rad), after a travelled distance (m). */
static inline void lean_bank_update_angle(struct lean_bank *bank, int body, int angle, double yaw, double measured,
                                          double travelled)
{
    const struct lean_row row = lean_row(body, angle, yaw);
    const int likeliest = lean_bank_likeliest(bank);
    double gain[LEANS], variance = bank->residual_variance * fmax(LEAN_CORRELATION / travelled, 1.0), least = (double)INFINITY;

    for (int i = 0; i < LEANS; ++i)
        gain[i] = lean_of(&row, bank->covariance[i]);
    variance += lean_of(&row, gain);
    for (int h = 0; h < SIGNS; ++h) {
        const double innovation = lean_sign(h, body, angle) * measured - lean_of(&row, bank->states[h]);
        bank->log_odds[h] += 0.5 * innovation * innovation / variance;
        least = fmin(least, innovation * innovation);
        const double clipped_innovation = clamped(innovation, -LEAN_OUTLIER * sqrt(variance), LEAN_OUTLIER * sqrt(variance));
        for (int i = 0; i < LEANS; ++i)
            bank->states[h][i] += gain[i] / variance * clipped_innovation;
        for (int i = 0; h == likeliest && i < ZEROS; ++i)
            bank->corrected[i] += gain[i] / variance * clipped_innovation;
    }
    bank->expected += (gain[SLOPE_EAST] * gain[SLOPE_EAST] + gain[SLOPE_NORTH] * gain[SLOPE_NORTH]) / variance;
    for (int i = 0; i < LEANS; ++i)
        for (int j = 0; j < LEANS; ++j)
            bank->covariance[i][j] -= gain[i] * gain[j] / variance;
    const double residual = fmin(least, LEAN_OUTLIER * LEAN_OUTLIER * bank->residual_variance);
    bank->residual_variance += fmin(travelled / LEAN_AVERAGE, 1.0) * (residual - bank->residual_variance);
    bank->residual_variance = fmax(bank->residual_variance, LEAN_NOISE * LEAN_NOISE);
}

/* Restart a hypothesis from another's estimate: the signs change now. */
static inline void lean_bank_switch(struct lean_bank *bank, int from, int to)
{
    for (int i = 0; i < LEANS; ++i)
        bank->states[to][i] = bank->states[from][i];
    for (int body = 0; body < 2; ++body)
        bank->states[to][ZEROS + 2 * body + ROLL] *= lean_sign(from ^ to, body, ROLL);
}

/* Normalise the odds to the likeliest hypothesis; restart those that are at LEAN_MOST. */
static inline void lean_bank_compare(struct lean_bank *bank)
{
    const int likeliest = lean_bank_likeliest(bank);
    const double least = bank->log_odds[likeliest];

    for (int h = 0; h < SIGNS; ++h) {
        bank->log_odds[h] -= least;
        if (bank->log_odds[h] >= LEAN_MOST) {
            bank->log_odds[h] = LEAN_MOST;
            lean_bank_switch(bank, likeliest, h);
        }
    }
}

/* Update with the attitude of a body, rad, a travelled distance (m) after its last one; a missing angle is NaN. */
static inline void lean_bank_update(struct lean_bank *bank, int body, double yaw, double roll, double pitch, double travelled)
{
    if (isfinite(roll) && travelled > 0.0)
        lean_bank_update_angle(bank, body, ROLL, yaw, roll, travelled);
    if (isfinite(pitch) && travelled > 0.0)
        lean_bank_update_angle(bank, body, PITCH, yaw, pitch, travelled);
    lean_bank_compare(bank);
}

/* The roll (rad) that the sensor of a body with this yaw is expected to report, by the likeliest hypothesis. */
static inline double lean_bank_roll(const struct lean_bank *bank, int body, double yaw)
{
    const int likeliest = lean_bank_likeliest(bank);
    const struct lean_row row = lean_row(body, ROLL, yaw);

    return lean_sign(likeliest, body, ROLL) * lean_of(&row, bank->states[likeliest]);
}

struct roll_zero {
    double value, deviation;               /* estimate and standard deviation, rad */
};

/* The zero of a body's roll sensor: the bank's estimate, with the stated standard deviation of the mounting (rad) in place of
 * the bank's own prior (docs/theory/lever-arm.md). */
static inline struct roll_zero lean_bank_zero(const struct lean_bank *bank, int body, double prior)
{
    const int place = ZEROS + 2 * body + ROLL, likeliest = lean_bank_likeliest(bank);
    const double filtered = lean_sign(likeliest, body, ROLL) * bank->states[likeliest][place];
    const double variance = bank->covariance[place][place], information = 1.0 / variance - 1.0 / (ZERO_PRIOR * ZERO_PRIOR);

    if (!lean_bank_begun(bank) || !(prior > 0.0) || !(information > 0.0))
        return (struct roll_zero){0.0, prior};
    const double posterior = 1.0 / (information + 1.0 / (prior * prior));
    return (struct roll_zero){filtered / variance * posterior, sqrt(posterior)};
}

/* The correction by an estimated zero, rad: none within one standard deviation, nearly all of it at several. */
static inline double roll_zero_correction(struct roll_zero zero)
{
    return fabs(zero.value) > zero.deviation ? zero.value - zero.deviation * zero.deviation / zero.value : 0.0;
}

/* Whether the roll of a body is reversed; bodies whose signs cannot be distinguished are all named. */
static inline int lean_bank_reversed(const struct lean_bank *bank, int body)
{
    int reversed = 0;

    if (!(bank->log_odds[0] > LEAN_CERTAIN))
        return 0;
    for (int h = 1; h < SIGNS; ++h)
        reversed |= (h >> body & 1) && bank->log_odds[h] < LEAN_CLOSE;
    return reversed;
}

#endif

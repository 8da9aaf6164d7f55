/* Lean bank: what both attitude sensors show of the ground's slope in all headings, and whether one shows it the wrong way
 * round, by a bank of models (Magill 1965).
 *
 * On a slope a body that turns leans another way: roll and pitch of both bodies, in all headings, are those of one slope, beside
 * the zeros of the sensors, which turn with neither (lean_on in ground_record.h). One Kalman filter for each hypothesis
 * about the signs of both rolls finds the slope, which changes slowly along the way, and the zeros; unevenness is its noise. A sign
 * changes nothing but the sign of the sensor's values, so all hypotheses share one covariance.
 */
#ifndef DRAWBAR_LEAN_BANK_H
#define DRAWBAR_LEAN_BANK_H

#include <math.h>
#include <stdint.h>
#include "geometry.h"

enum { SLOPE_EAST, SLOPE_NORTH, ZEROS, LEANS = ZEROS + 4 };   /* zeros: roll and pitch of the tractor, of the trailer */
enum { ROLL, PITCH };

#define SIGNS 4                            /* hypotheses: bit 0, the tractor's roll is reversed; bit 1, the trailer's */
#define SLOPE_FIRST (8.0 * DRAWBAR_PI / 180.0)      /* its deviation before anything is known, rad */
#define SLOPE_WALK (0.2 * DRAWBAR_PI / 180.0)       /* by which it changes, rad per square root of a metre */
#define ZERO_FIRST (1.5 * DRAWBAR_PI / 180.0)       /* deviation of a zero before anything is known, rad */
#define ZERO_WALK (0.01 * DRAWBAR_PI / 180.0)       /* by which it changes, rad per square root of a metre */
#define LEAN_NOISE (1.0 * DRAWBAR_PI / 180.0)       /* deviation of a lean from the slope's, at least, rad */
#define LEAN_ALIKE 3.0                     /* way on which leans are alike, m */
#define LEAN_LATELY 30.0                   /* way over which their deviation is averaged, m */
#define LEAN_SURGE 3.0                     /* times its deviation that one counts at most */
#define LEAN_CERTAIN 7.0                   /* logarithm of odds from which on a hypothesis holds, */
#define LEAN_CLOSE 2.0                     /* and by which another is as good, */
#define LEAN_MOST 16.0                     /* and from which on it stands for a sign that changes now */

struct lean_bank {
    double states[SIGNS][LEANS];           /* by hypothesis; its zeros with its signs, rad */
    double covariance[LEANS][LEANS];
    double against[SIGNS];                 /* logarithm of the odds against it, beside the likeliest */
    double spread;                         /* mean square of what leans are off the slope's, rad2 */
    int32_t begun;
};

static inline void lean_bank_begin(struct lean_bank *bank)
{
    *bank = (struct lean_bank){.spread = LEAN_NOISE * LEAN_NOISE, .begun = 1};
    for (int i = 0; i < LEANS; ++i)
        bank->covariance[i][i] = i < ZEROS ? SLOPE_FIRST * SLOPE_FIRST : ZERO_FIRST * ZERO_FIRST;
}

/* Let the vehicle move on, m. */
static inline void lean_bank_move(struct lean_bank *bank, double moved)
{
    for (int i = 0; i < LEANS; ++i)
        bank->covariance[i][i] += moved * (i < ZEROS ? SLOPE_WALK * SLOPE_WALK : ZERO_WALK * ZERO_WALK);
}

/* An angle of a body as a sum of states: so much of the slope to the east and to the north, and the zero at a place. */
struct lean_row {
    double east, north;
    int zero;
};

/* The row of an angle of a body that faces so, rad. */
static inline struct lean_row lean_row(int body, int angle, double yaw)
{
    const double along = cos(yaw), across = sin(yaw);

    return (struct lean_row){angle == ROLL ? -across : along, angle == ROLL ? along : across, ZEROS + 2 * body + angle};
}

/* The sign of what a sensor reports, by a hypothesis. */
static inline double lean_sign(int hypothesis, int body, int angle)
{
    return angle == ROLL && (hypothesis >> body & 1) ? -1.0 : 1.0;
}

static inline double lean_of(const struct lean_row *row, const double *state)
{
    return row->east * state[SLOPE_EAST] + row->north * state[SLOPE_NORTH] + state[row->zero];
}

/* Take in an angle (rad) that stands for so much of the way (m). */
static inline void lean_bank_angle(struct lean_bank *bank, int body, int angle, double yaw, double told, double way)
{
    const struct lean_row row = lean_row(body, angle, yaw);
    double gain[LEANS], variance = bank->spread * fmax(LEAN_ALIKE / way, 1.0), least = (double)INFINITY;

    for (int i = 0; i < LEANS; ++i)
        gain[i] = lean_of(&row, bank->covariance[i]);
    variance += lean_of(&row, gain);
    for (int h = 0; h < SIGNS; ++h) {
        const double error = lean_sign(h, body, angle) * told - lean_of(&row, bank->states[h]);
        bank->against[h] += 0.5 * error * error / variance;
        least = fmin(least, error * error);
        const double counts = clamped(error, -LEAN_SURGE * sqrt(variance), LEAN_SURGE * sqrt(variance));
        for (int i = 0; i < LEANS; ++i)
            bank->states[h][i] += gain[i] / variance * counts;
    }
    for (int i = 0; i < LEANS; ++i)
        for (int j = 0; j < LEANS; ++j)
            bank->covariance[i][j] -= gain[i] * gain[j] / variance;
    const double counts = fmin(least, LEAN_SURGE * LEAN_SURGE * bank->spread);
    bank->spread += fmin(way / LEAN_LATELY, 1.0) * (counts - bank->spread);
    bank->spread = fmax(bank->spread, LEAN_NOISE * LEAN_NOISE);
}

static inline int lean_bank_likeliest(const struct lean_bank *bank)
{
    int likeliest = 0;

    for (int h = 1; h < SIGNS; ++h)
        likeliest = bank->against[h] < bank->against[likeliest] ? h : likeliest;
    return likeliest;
}

/* Let a hypothesis begin from what another has found: the signs change now. */
static inline void lean_bank_switch(struct lean_bank *bank, int from, int to)
{
    for (int i = 0; i < LEANS; ++i)
        bank->states[to][i] = bank->states[from][i];
    for (int body = 0; body < 2; ++body)
        bank->states[to][ZEROS + 2 * body + ROLL] *= lean_sign(from ^ to, body, ROLL);
}

/* Compare all hypotheses with the likeliest. */
static inline void lean_bank_compare(struct lean_bank *bank)
{
    const int likeliest = lean_bank_likeliest(bank);
    const double least = bank->against[likeliest];

    for (int h = 0; h < SIGNS; ++h) {
        bank->against[h] -= least;
        if (bank->against[h] >= LEAN_MOST) {
            bank->against[h] = LEAN_MOST;
            lean_bank_switch(bank, likeliest, h);
        }
    }
}

/* Take in the attitude of a body that has moved by so much (m) since its last one; an angle that is not there is NaN. */
static inline void lean_bank_take(struct lean_bank *bank, int body, double yaw, double roll, double pitch, double way)
{
    if (isfinite(roll) && way > 0.0)
        lean_bank_angle(bank, body, ROLL, yaw, roll, way);
    if (isfinite(pitch) && way > 0.0)
        lean_bank_angle(bank, body, PITCH, yaw, pitch, way);
    lean_bank_compare(bank);
}

/* The roll (rad) that the sensor of a body which faces so would report, by the likeliest hypothesis. */
static inline double lean_bank_roll(const struct lean_bank *bank, int body, double yaw)
{
    const int likeliest = lean_bank_likeliest(bank);
    const struct lean_row row = lean_row(body, ROLL, yaw);

    return lean_sign(likeliest, body, ROLL) * lean_of(&row, bank->states[likeliest]);
}

struct roll_zero {
    double value, deviation;               /* rad */
};

/* What the roll sensor of a body shows while it stands level, where it was mounted level but for a deviation (rad): what the
 * bank has found, with that in the place of its own first deviation (docs/theory/lever-arm.md). */
static inline struct roll_zero lean_bank_zero(const struct lean_bank *bank, int body, double stated)
{
    const int place = ZEROS + 2 * body + ROLL, likeliest = lean_bank_likeliest(bank);
    const double found = lean_sign(likeliest, body, ROLL) * bank->states[likeliest][place];
    const double variance = bank->covariance[place][place], shown = 1.0 / variance - 1.0 / (ZERO_FIRST * ZERO_FIRST);

    if (!bank->begun || !(stated > 0.0) || !(shown > 0.0))
        return (struct roll_zero){0.0, stated};
    const double known = 1.0 / (shown + 1.0 / (stated * stated));
    return (struct roll_zero){found / variance * known, sqrt(known)};
}

/* What of it is taken off: nothing where it may as well be nothing, nearly all where it is some deviations, rad. */
static inline double roll_zero_shown(struct roll_zero zero)
{
    return fabs(zero.value) > zero.deviation ? zero.value - zero.deviation * zero.deviation / zero.value : 0.0;
}

/* Whether the roll of a body is reversed: bodies whose signs do not show apart from each other are all named. */
static inline int lean_bank_reversed(const struct lean_bank *bank, int body)
{
    int reversed = 0;

    if (!(bank->against[0] > LEAN_CERTAIN))
        return 0;
    for (int h = 1; h < SIGNS; ++h)
        reversed |= (h >> body & 1) && bank->against[h] < LEAN_CLOSE;
    return reversed;
}

#endif

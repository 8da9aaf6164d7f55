/* Lean watch: whether a body's roll sensor is reversed or stuck.
 *
 * Reversed: it contradicts the slope estimated from all attitudes (lean_bank.h), or the motion of the body's own antenna
 * (mast_swing.h). Stuck: it repeats one value to the bit while the antenna's innovations exceed their variance, while the body
 * turns on a slope, which changes its roll, or while the other body's roll changes. On level ground a fault of a roll sensor
 * cannot be detected, and has no effect.
 */
#ifndef DRAWBAR_LEAN_WATCH_H
#define DRAWBAR_LEAN_WATCH_H

#include "drawbar_signals.h"
#include "lean_bank.h"
#include "mast_swing.h"
#include "status.h"

#define LEAN_BODIES 2                      /* bodies: tractor, trailer */
#define CONSTANT_LEAST 1.0                 /* for how long a roll is constant before it may be stuck, s */
#define CONSTANT_TURN (2.0 * DRAWBAR_PI / 180.0)   /* change of the expected roll that a working sensor reports, rad */
#define CONSTANT_OTHER (3.0 * DRAWBAR_PI / 180.0)   /* the same of the other body's roll, rad */
#define LEAN_PATIENCE 0.5                  /* for how long a sensor is contradicted before the run ends, s */

enum roll_fault { ROLL_PLAUSIBLE, ROLL_REVERSED, ROLL_STUCK };

/* Least and largest value of a signal, rad. */
struct span {
    double least, most;
};

struct constant_roll {
    double roll;                           /* reported, rad */
    double duration;                       /* for how long it has been constant, s */
    double expected;                       /* by the slope, rad */
    struct span expected_rolls, other_rolls; /* meanwhile: expected, and of the other body */
};

struct lean_watch {
    struct lean_bank bank;
    struct mast_swing swings[LEAN_BODIES];
    struct constant_roll constant[LEAN_BODIES];
    double travelled[LEAN_BODIES];         /* since the body's last attitude, m */
    double contradicted[LEAN_BODIES]; /* for how long, s */
    int32_t faults[LEAN_BODIES];           /* enum roll_fault */
};

/* Extend a span by a value; where it does not continue, it starts with the value. */
static inline void span_extend(struct span *span, double value, int continues)
{
    span->least = continues ? fmin(span->least, value) : value;
    span->most = continues ? fmax(span->most, value) : value;
}

static inline double span_of(const struct span *span)
{
    return span->most - span->least;
}

/* Propagate by a travelled distance, m. */
static inline void lean_watch_propagate(struct lean_watch *watch, double distance)
{
    if (!lean_bank_begun(&watch->bank)) {
        lean_bank_begin(&watch->bank);
        for (int i = 0; i < LEAN_BODIES; ++i) {
            watch->travelled[i] = LEAN_CORRELATION;
            watch->constant[i].roll = (double)NAN;
        }
    }
    lean_bank_propagate(&watch->bank, distance);
    for (int i = 0; i < LEAN_BODIES; ++i)
        watch->travelled[i] += distance;
}

/* Whether a roll has been constant for so long that it carries no information. */
static inline int lean_is_constant(const struct constant_roll *constant)
{
    return constant->duration > CONSTANT_LEAST;
}

/* Update with a new attitude of a body with this yaw, rad; elapsed: since the last sample, s. */
static inline void lean_watch_attitude(struct lean_watch *watch, int body, double yaw, double roll, double pitch,
                                       double elapsed)
{
    struct constant_roll *constant = &watch->constant[body];

    constant->duration = roll == constant->roll ? constant->duration + elapsed : 0.0;
    constant->roll = roll;
    lean_bank_update(&watch->bank, body, yaw, lean_is_constant(constant) ? (double)NAN : roll, pitch, watch->travelled[body]);
    watch->travelled[body] = 0.0;
    constant->expected = lean_bank_roll(&watch->bank, body, yaw);
    span_extend(&constant->expected_rolls, constant->expected, lean_is_constant(constant));
    span_extend(&constant->other_rolls, watch->constant[!body].roll, lean_is_constant(constant));
}

/* Whether a roll is constant while the body's own has changed. */
static inline int lean_is_stuck(const struct lean_watch *watch, int body)
{
    const struct constant_roll *constant = &watch->constant[body];
    const int turned = span_of(&constant->expected_rolls) > CONSTANT_TURN
        && fabs(constant->expected - constant->roll) > 0.5 * CONSTANT_TURN;

    return lean_is_constant(constant)
        && (turned || span_of(&constant->other_rolls) > CONSTANT_OTHER || swing_excessive(&watch->swings[body]));
}

/* Judge a sample: 0, or the status with which the run ends. present: which bodies have a roll; elapsed in s. */
static inline int lean_watch_judge(struct lean_watch *watch, const int *present, double elapsed)
{
    int faulty = 0;

    for (int i = 0; i < LEAN_BODIES; ++i) {
        const int stuck = lean_is_stuck(watch, i);
        const int reversed = lean_bank_reversed(&watch->bank, i) || swing_reversed(&watch->swings[i]);
        watch->contradicted[i] = present[i] && (stuck || reversed) ? watch->contradicted[i] + elapsed : 0.0;
        watch->faults[i] = !(watch->contradicted[i] > LEAN_PATIENCE) ? ROLL_PLAUSIBLE : stuck ? ROLL_STUCK : ROLL_REVERSED;
        faulty |= watch->faults[i] != ROLL_PLAUSIBLE;
    }
    return faulty ? DRAWBAR_ROLL : 0;
}

#endif

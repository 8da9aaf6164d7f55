/* Lean watch: whether a body's roll sensor is reversed or stuck.
 *
 * Reversed: against the slope that all attitudes show together (lean_bank.h), or against the swing of the body's own antenna
 * (mast_swing.h). Stuck: the very same roll, to the bit, while the antenna swings more than usual, while the body turns on a
 * slope on which it must lean another way, or while the other body leans now this way and now that. Where the ground is level
 * nothing is seen of a roll, and it does not matter.
 */
#ifndef DRAWBAR_LEAN_WATCH_H
#define DRAWBAR_LEAN_WATCH_H

#include "drawbar_signals.h"
#include "lean_bank.h"
#include "mast_swing.h"
#include "status.h"

#define LEANING 2                          /* bodies: tractor, trailer */
#define STILL_LEAST 1.0                    /* for how long a roll stands still before it may be stuck, s */
#define STILL_TURN (2.0 * DRAWBAR_PI / 180.0)       /* change of the slope across that a roll does not miss, rad */
#define STILL_OTHER (3.0 * DRAWBAR_PI / 180.0)      /* and of the other body's roll, rad */
#define LEAN_PATIENCE 0.5                  /* for how long a sensor is wrong before it is told, s */

enum lean_doubt { LEAN_BELIEVED, LEAN_REVERSED, LEAN_STUCK };

/* Between which values something has been, rad. */
struct span {
    double least, most;
};

struct still_roll {
    double roll;                           /* as it is reported, rad */
    double since;                          /* for so long, s */
    double slope;                          /* as the slope has it, rad */
    struct span slopes, others;            /* meanwhile: by the slope, and of the other body */
};

struct lean_watch {
    struct lean_bank bank;
    struct mast_swing swings[LEANING];
    struct still_roll still[LEANING];
    double ways[LEANING];                  /* since its last attitude, m */
    double wrong[LEANING];                 /* for how long, s */
    int32_t doubts[LEANING];               /* enum lean_doubt */
};

/* Take in a value; where it does not go on, the span begins with it. */
static inline void span_take(struct span *span, double value, int goes_on)
{
    span->least = goes_on ? fmin(span->least, value) : value;
    span->most = goes_on ? fmax(span->most, value) : value;
}

static inline double span_of(const struct span *span)
{
    return span->most - span->least;
}

/* Let the vehicle move on, m. */
static inline void lean_watch_move(struct lean_watch *watch, double moved)
{
    if (!watch->bank.begun) {
        lean_bank_begin(&watch->bank);
        for (int i = 0; i < LEANING; ++i) {
            watch->ways[i] = LEAN_ALIKE;
            watch->still[i].roll = (double)NAN;
        }
    }
    lean_bank_move(&watch->bank, moved);
    for (int i = 0; i < LEANING; ++i)
        watch->ways[i] += moved;
}

/* Whether a roll has stood still for so long that it says nothing. */
static inline int lean_is_still(const struct still_roll *still)
{
    return still->since > STILL_LEAST;
}

/* Take in a new attitude of a body that faces so, rad; elapsed: since the last sample, s. */
static inline void lean_watch_attitude(struct lean_watch *watch, int body, double yaw, double roll, double pitch,
                                       double elapsed)
{
    struct still_roll *still = &watch->still[body];

    still->since = roll == still->roll ? still->since + elapsed : 0.0;
    still->roll = roll;
    lean_bank_take(&watch->bank, body, yaw, lean_is_still(still) ? (double)NAN : roll, pitch, watch->ways[body]);
    watch->ways[body] = 0.0;
    still->slope = lean_bank_roll(&watch->bank, body, yaw);
    span_take(&still->slopes, still->slope, lean_is_still(still));
    span_take(&still->others, watch->still[!body].roll, lean_is_still(still));
}

/* Whether a roll stands still that the body does not have all the time. */
static inline int lean_is_stuck(const struct lean_watch *watch, int body)
{
    const struct still_roll *still = &watch->still[body];
    const int turned = span_of(&still->slopes) > STILL_TURN && fabs(still->slope - still->roll) > 0.5 * STILL_TURN;

    return lean_is_still(still)
        && (turned || span_of(&still->others) > STILL_OTHER || swing_odd(&watch->swings[body]));
}

/* Look at a sample: 0, or the status with which the run ends. present: which bodies have a roll, elapsed in s. */
static inline int lean_watch_look(struct lean_watch *watch, const int *present, double elapsed)
{
    int told = 0;

    for (int i = 0; i < LEANING; ++i) {
        const int stuck = lean_is_stuck(watch, i);
        const int reversed = lean_bank_reversed(&watch->bank, i) || swing_reversed(&watch->swings[i]);
        watch->wrong[i] = present[i] && (stuck || reversed) ? watch->wrong[i] + elapsed : 0.0;
        watch->doubts[i] = !(watch->wrong[i] > LEAN_PATIENCE) ? LEAN_BELIEVED : stuck ? LEAN_STUCK : LEAN_REVERSED;
        told |= watch->doubts[i] != LEAN_BELIEVED;
    }
    return told ? DRAWBAR_ROLL : 0;
}

#endif

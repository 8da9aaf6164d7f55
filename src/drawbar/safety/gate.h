/* Gate: the last check of a command before it leaves, small and independent of all that made it.
 *
 * A command within the limits passes, its steering clamped where that changes no motion. An actuator that follows with the
 * lag tau and the largest rate R has its valve fully open during the whole sample for every command beyond R (tau + dt)
 * from the wheels: all those become the one at that distance, which moves the wheels just as far. So a limited command
 * changes nothing about the motion, and two commands in a row are never further apart than R (2 tau + dt). Where the
 * wheels are is what the commands so far make of such an actuator, from where they were measured first.
 *
 * Otherwise the last command that passed is repeated, for a few samples, and then the vehicle stops: speed zero and the
 * mean of the recent steering, so that the vehicle rolls out along the curve on which it is and its wheels do
 * not swing while it stands. A single command holds the noise of one sample: in a curve at 2 m/s that costs twice as much
 * until the vehicle stands. Both samples and time are counted: neither a clock that stands still nor a caller who is late can keep a
 * command alive.
 */
#ifndef DRAWBAR_GATE_H
#define DRAWBAR_GATE_H

#include <math.h>
#include <string.h>
#include "geometry.h"
#include "signals.h"
#include "unit.h"

#define SETTLING 0.5                       /* time constant of the mean steering that a stop holds, s */

enum { FRONT, JOINT, STEERINGS };

struct component {
    double limits[STEERINGS];              /* largest steering angles, rad */
    double signs[STEERINGS];               /* -1 where the actuator is reversed, else 1 */
    double rates[STEERINGS];               /* fastest the steering turns, R, rad/s */
    double lag;                            /* of both actuators, tau, s */
    double sample_time;                    /* dt, s */
    double speed_limit;                    /* m/s */
    double patience;                       /* time for which a command may act without a new one, s */
    int32_t repeats;                       /* samples for which it may be repeated */
    int32_t refused;                       /* samples since a command has passed */
    int32_t initialised;                   /* there is a last command */
    struct drawbar_command last;           /* the last one that passed; at first: stand, with the wheels as they are */
    double settled[STEERINGS];             /* mean of the commands, rad */
    double wheels[STEERINGS];              /* where the steering will be at the next command, in its own sign, rad */
};

#define COMPONENT_FIELDS                                                                                          \
    SETTING(component, limits, 0, STEERINGS, 0, 0) SETTING(component, signs, 0, STEERINGS, 0, 0)                       \
    SETTING(component, rates, 0, STEERINGS, 0, 0) SETTING(component, lag, 0, 1, 0, 0)                                  \
    SETTING(component, sample_time, 0, 1, 0, 0) SETTING(component, speed_limit, 0, 1, 0, 0)                            \
    SETTING(component, patience, 0, 1, 0, 0) SETTING(component, repeats, 1, 1, 0, 0)

/* `not (|x| <= limit)` also catches NaN, which would walk through a clamp. */
static inline int gate_admits(const struct component *gate, const struct drawbar_command *wanted)
{
    return fabs(wanted->tractor_steering) <= gate->limits[FRONT]
        && fabs(wanted->trailer_steering) <= gate->limits[JOINT] && fabs(wanted->speed) <= gate->speed_limit;
}

/* The angle, clamped to where the valve is already fully open, rad. */
static inline double gate_limited(const struct component *gate, int i, double wanted)
{
    const double reach = gate->rates[i] * (gate->lag + gate->sample_time);
    return clamped(wanted, gate->wheels[i] - reach, gate->wheels[i] + reach);
}

/* Simulate a sample under a steering command (rad): with the valve fully open at first, then by the lag. */
static inline void gate_follow(struct component *gate, int i, double command)
{
    const double rate = gate->rates[i], gap = fabs(command - gate->wheels[i]);
    const double open = clamped(gap / rate - gate->lag, 0.0, gate->sample_time);
    const double rest = (gap - rate * open) * exp((open - gate->sample_time) / gate->lag);

    gate->wheels[i] = command - copysign(rest, command - gate->wheels[i]);
    gate->settled[i] += (1.0 - exp(-gate->sample_time / SETTLING)) * (command - gate->settled[i]);
}

/* Pass on the last admitted command, which continues to act. */
static inline void gate_pass(struct component *gate, double time, struct drawbar_command *given)
{
    gate_follow(gate, FRONT, gate->last.tractor_steering);
    gate_follow(gate, JOINT, gate->last.trailer_steering);
    *given = gate->last;
    given->time = time;
}

/* The first steering angle (rad) by its measurement; straight where that is missing. */
static inline double gate_first(const struct component *gate, int i, double measured)
{
    return isfinite(measured) ? clamped(gate->signs[i] * measured, -gate->limits[i], gate->limits[i]) : 0.0;
}

/* Initialise with a vehicle at rest. */
int UNIT(begin)(struct component *gate, const struct drawbar_measurement *first)
{
    gate->wheels[FRONT] = gate_first(gate, FRONT, first->tractor_steering);
    gate->wheels[JOINT] = gate_first(gate, JOINT, first->trailer_steering);
    memcpy(gate->settled, gate->wheels, sizeof gate->settled);
    gate->last = (struct drawbar_command){first->time, gate->wheels[FRONT], gate->wheels[JOINT], 0.0};
    gate->refused = 0;
    gate->initialised = 1;
    return 0;
}

/* Stop the vehicle: its steering stays at the mean of its commands, and only a new one makes it move again. */
int UNIT(stop)(struct component *gate, double time, struct drawbar_command *given)
{
    gate->refused = gate->repeats;
    gate->last.tractor_steering = gate->settled[FRONT] = gate_limited(gate, FRONT, gate->settled[FRONT]);
    gate->last.trailer_steering = gate->settled[JOINT] = gate_limited(gate, JOINT, gate->settled[JOINT]);
    gate_pass(gate, time, given);
    given->speed = 0.0;
    return DRAWBAR_GATE_STOPPED;
}

/* The command for a wrong call, which is no sample: speed zero, with the steering as it is. Nothing changes. */
int UNIT(stand)(const struct component *gate, double time, struct drawbar_command *given)
{
    *given = gate->last;
    given->time = time;
    given->speed = 0.0;
    return DRAWBAR_GATE_STOPPED;
}

/* Without a command: repeat the last valid one as long as that is allowed, then stop. */
int UNIT(hold)(struct component *gate, double time, struct drawbar_command *given)
{
    const double age = time - gate->last.time + 0.5 * gate->sample_time;   /* it acts until the next sample */

    if (!gate->initialised || gate->refused >= gate->repeats || !(age <= gate->patience))
        return UNIT(stop)(gate, time, given);
    ++gate->refused;
    gate_pass(gate, time, given);
    return DRAWBAR_GATE_REPEATED;
}

/* Advance by a sample that was left out: the last command continued to act. */
int UNIT(skip)(struct component *gate, struct drawbar_command *given)
{
    gate_pass(gate, gate->last.time, given);
    return 0;
}

/* Check a wanted command: `given` becomes that or its replacement; returns the verdict. */
int UNIT(check)(struct component *gate, const struct drawbar_command *wanted, struct drawbar_command *given)
{
    if (!gate_admits(gate, wanted))
        return UNIT(hold)(gate, wanted->time, given);
    gate->last = *wanted;
    gate->last.tractor_steering = gate_limited(gate, FRONT, wanted->tractor_steering);
    gate->last.trailer_steering = gate_limited(gate, JOINT, wanted->trailer_steering);
    gate->refused = 0;
    gate_pass(gate, wanted->time, given);
    return given->tractor_steering != wanted->tractor_steering || given->trailer_steering != wanted->trailer_steering
        ? DRAWBAR_GATE_LIMITED : DRAWBAR_GATE_PASSED;
}

#endif

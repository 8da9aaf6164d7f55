/* Dead-time compensation: plan from where the commands under way will have taken the vehicle (Smith 1957; Findeisen and
 * Allgoewer 2004 for predictive control).
 *
 * The including unit defines MOST_COMMANDS, how many are remembered; FIRST_LAG, where the lags are among the constants;
 * MOTION_STEPS, in how many steps the vehicle moves; STATES, INPUTS, PARAMETERS, OUTPUTS and CONSTANTS, the sizes of the
 * model with its actuators; what its elements are called (U_TRACTOR_TARGET, for one); and its functions take_estimate,
 * motion, outputs and give_estimate, generated from that model.
 */
#ifndef DRAWBAR_DEAD_TIME_H
#define DRAWBAR_DEAD_TIME_H

#include <math.h>
#include <string.h>
#include "body_lag.h"
#include "lanes.h"
#include "signals.h"
#include "unit.h"

/* Both steering angles that a command asks for, rad. */
struct steerings {
    double tractor, trailer;
};

struct component {
    double dead_time;                      /* s */
    double stated_lag, stated_rate;        /* of the front wheels, s, rad/s */
    struct body_lag body;                  /* delay of the tractor's yaw rate behind its wheels */
    double sign;                           /* -1 where the joint's actuator is reversed, else 1 */
    double constants[CONSTANTS];           /* of the model with its actuators */
    int32_t sent;                          /* commands so far, up to MOST_COMMANDS */
    struct steerings under_way[MOST_COMMANDS];   /* oldest first; the newest `sent` are valid */
    double x[1][STATES], u[1][INPUTS], p[1][PARAMETERS], duration[1][1], y[1][OUTPUTS];
};

#define WHOLE_SAMPLES 1e-9                 /* a dead time that is longer by less is a whole number of samples */

#define COMPONENT_FIELDS                                                                                               \
    SETTING(component, dead_time, 0, 1, 0, 0) SETTING(component, stated_lag, 0, 1, 0, 0)                               \
    SETTING(component, stated_rate, 0, 1, 0, 0) BODY_LAG_FIELDS(component, body)                                       \
    SETTING(component, sign, 0, 1, 0, 0) SETTING(component, constants, 0, CONSTANTS, 0, 0)

/* From a command until it turns the tractor, s. */
static inline double ahead_by(const struct component *component)
{
    return component->dead_time + component->body.lag;
}

/* Number of commands under way within that time, all but the oldest for a whole sample. */
static inline int32_t commands_under_way(const struct component *component)
{
    const double samples = ceil(ahead_by(component) / component->body.sample_time - WHOLE_SAMPLES);
    return (int32_t)fmin(fmax(samples, 0.0), MOST_COMMANDS - 1.0);
}

/* States and parameters of the model from an estimate. */
static void take_estimate(struct component *work, const struct drawbar_estimate *estimate);
/* States after the duration, in one step, with the inputs held. */
static void motion(struct component *work, int first, int count);
/* The outputs then. */
static void outputs(struct component *work, int first, int count);
/* The predicted part of an estimate, from states and outputs of the model. */
static void give_estimate(const struct component *work, struct drawbar_estimate *estimate);

/* Simulate a duration (s) in which front wheels and joint are driven to these angles, rad. */
static void move(struct component *component, double duration, double tractor, double trailer)
{
    component->u[0][U_TRACTOR_TARGET] = tractor;
    component->u[0][U_TRAILER_TARGET] = trailer;
    component->duration[0][0] = duration / MOTION_STEPS;
    for (int i = 0; i < MOTION_STEPS; ++i)
        motion(component, 0, 1);
}

/* The estimate for the moment at which the next command begins to turn the tractor. The joint turns the trailer at once: it
 * waits where it is for the tractor. The speed stays as it is estimated: a drive is slower than any dead time. Before any
 * command the wheels stay as they are. */
int UNIT(ahead)(struct component *component, const struct drawbar_estimate *now, struct drawbar_estimate *then)
{
    body_lag_apply(&component->body, now);
    const int32_t count = commands_under_way(component);
    double moved = 0.0;

    *then = *now;
    then->time += ahead_by(component);
    if (count == 0)
        return 0;
    take_estimate(component, now);
    for (int i = 0; i < count; ++i) {
        const struct steerings *command = &component->under_way[MOST_COMMANDS - count + i];
        const int known = i >= count - component->sent;
        const double tractor = known ? command->tractor : now->tractor_steering;
        const double trailer = known ? component->sign * command->trailer : now->trailer_steering;
        const double end = ahead_by(component) - (count - 1 - i) * component->body.sample_time;
        if (moved < component->body.lag) {
            const double waiting = fmin(end, component->body.lag) - moved;
            move(component, waiting, tractor, now->trailer_steering);
            moved += waiting;
        }
        if (moved < end)
            move(component, end - moved, tractor, trailer);
        moved = end;
    }
    outputs(component, 0, 1);
    give_estimate(component, then);
    return 0;
}

/* The command that acts in the mean of the sample that now begins, where commands act so long after they are sent, s: two
 * act, one after the other, unless that is a whole number of samples. NaN as long as none has arrived. */
static struct steerings acting_in_the_mean(const struct component *component, double after)
{
    const double samples = fmin(after / component->body.sample_time, MOST_COMMANDS - 2.0);
    const int32_t whole = (int32_t)(samples + WHOLE_SAMPLES);
    const double share = fmax(samples - whole, 0.0);
    const struct steerings *later = &component->under_way[MOST_COMMANDS - 1 - whole], *earlier = later - 1;
    struct steerings mean = *later;

    if (component->sent <= whole) {
        mean.tractor = mean.trailer = (double)NAN;
    } else if (component->sent > whole + 1) {
        mean.tractor += share * (earlier->tractor - later->tractor);
        mean.trailer += share * (earlier->trailer - later->trailer);
    }
    return mean;
}

/* Remember the newest command, and give the one that acts on the bodies during the sample that now begins: on the tractor by
 * its wheels, later than on the trailer by its joint. Its time and speed are the newest one's. */
int UNIT(sent)(struct component *component, const struct drawbar_command *newest, struct drawbar_command *acting)
{
    struct steerings *commands = component->under_way;

    memmove(&commands[0], &commands[1], (MOST_COMMANDS - 1) * sizeof *commands);
    commands[MOST_COMMANDS - 1] = (struct steerings){newest->tractor_steering, newest->trailer_steering};
    component->sent += component->sent < MOST_COMMANDS;
    body_lag_pass(&component->body);
    *acting = *newest;
    acting->tractor_steering = acting_in_the_mean(component, ahead_by(component)).tractor;
    acting->trailer_steering = acting_in_the_mean(component, component->dead_time).trailer;
    return 0;
}

/* Replace the measured steering angle by the one that turns the tractor now, and report the lag. Commands for wheels slower than
 * stated already lead by the newest angle: the lag is applied less by as much. last: the last estimate. */
int UNIT(measured)(struct component *component, const struct drawbar_estimate *last,
                   struct drawbar_measurement *measurement, struct drawbar_actuation *report)
{
    const double *const found = component->constants + FIRST_LAG;
    const double share = fmin(fmin(component->stated_lag / found[0], found[2] / component->stated_rate), 1.0);

    body_lag_measured(&component->body, last, share, measurement);
    report->body_lag = component->body.lag;
    report->body_lag_deviation = sqrt(component->body.variance);
    return 0;
}

/* Use identified values of the actuators from now on. */
int UNIT(actuation)(struct component *component, const struct drawbar_actuation *known)
{
    double *const actuators = component->constants + FIRST_LAG;

    component->dead_time = known->dead_time;
    actuators[0] = known->tractor_lag;
    actuators[1] = known->trailer_lag;
    actuators[2] = known->tractor_rate;
    actuators[3] = known->trailer_rate;
    return 0;
}

#endif

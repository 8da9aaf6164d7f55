/* Dead-time compensation: plan from where the commands under way will have taken the vehicle (Smith 1957; Findeisen and
 * Allgoewer 2004 for predictive control).
 *
 * The including unit defines MOST_COMMANDS, how many are remembered; FIRST_LAG, where the lags are among the constants; STATES, INPUTS, PARAMETERS, OUTPUTS and CONSTANTS,
 * the sizes of the model with its actuators; what its elements are called (U_TRACTOR_TARGET, for one); and its functions
 * take_estimate, motion and give_estimate, generated from that model.
 */
#ifndef DRAWBAR_DEAD_TIME_H
#define DRAWBAR_DEAD_TIME_H

#include <math.h>
#include <string.h>
#include "lanes.h"
#include "signals.h"
#include "unit.h"

struct component {
    double dead_time, sample_time;         /* s */
    double body_lag;                       /* by how much bodies turn later than their wheels stand, s */
    double sign;                           /* -1 where the joint's actuator is reversed, else 1 */
    double constants[CONSTANTS];           /* of the model with its actuators */
    int32_t sent;                          /* commands so far, up to MOST_COMMANDS */
    struct drawbar_command under_way[MOST_COMMANDS];   /* oldest first; the newest `sent` are valid */
    double x[1][STATES], u[1][INPUTS], p[1][PARAMETERS], duration[1][1], y[1][OUTPUTS];
};

#define WHOLE_SAMPLES 1e-9                 /* a dead time that is longer by less is a whole number of samples */

#define COMPONENT_FIELDS                                                                                          \
    SETTING(component, dead_time, 0, 1, 0, 0) SETTING(component, sample_time, 0, 1, 0, 0)                              \
    SETTING(component, body_lag, 0, 1, 0, 0)                                                                           \
    SETTING(component, sign, 0, 1, 0, 0) SETTING(component, constants, 0, CONSTANTS, 0, 0)

/* How many commands are under way within the dead time, all but the oldest for a whole sample. */
static inline int32_t commands_under_way(const struct component *component)
{
    const double samples = ceil(component->dead_time / component->sample_time - WHOLE_SAMPLES);
    return (int32_t)fmin(fmax(samples, 0.0), MOST_COMMANDS - 1.0);
}

/* For how long the oldest of so many commands acts within the dead time, s. */
static inline double oldest_acts(const struct component *component, int32_t count)
{
    return component->dead_time - (count - 1) * component->sample_time;
}

/* States and parameters of the model from an estimate. */
static void take_estimate(struct component *work, const struct drawbar_estimate *estimate);
/* States after the duration with the inputs held, and the outputs then. */
static void motion(struct component *work, int first, int count);
/* What of an estimate moves, from states and outputs of the model. */
static void give_estimate(const struct component *work, struct drawbar_estimate *estimate);

/* Let the bodies move for a duration (s) while the wheels are driven to these angles, rad. */
static void move(struct component *component, double duration, double tractor, double trailer)
{
    component->u[0][U_TRACTOR_TARGET] = tractor;
    component->u[0][U_TRAILER_TARGET] = trailer;
    component->duration[0][0] = duration;
    motion(component, 0, 1);
}

/* The estimate for the moment at which the next command begins to turn the bodies. They turn later than their wheels
 * stand: as the wheels stand now, first, and then as the commands under way move them. The speed stays as it is estimated:
 * a drive is slower than any dead time. Before any command the wheels stay as they are. */
int UNIT(ahead)(struct component *component, const struct drawbar_estimate *now, struct drawbar_estimate *then)
{
    const int32_t count = commands_under_way(component);

    *then = *now;
    then->time += component->dead_time + component->body_lag;
    if (!(component->dead_time + component->body_lag > 0.0))
        return 0;
    take_estimate(component, now);
    if (component->body_lag > 0.0)
        move(component, component->body_lag, now->tractor_steering, now->trailer_steering);
    for (int i = 0; i < count; ++i) {
        const struct drawbar_command *command = &component->under_way[MOST_COMMANDS - count + i];
        const int known = i >= count - component->sent;
        move(component, i == 0 ? oldest_acts(component, count) : component->sample_time,
             known ? command->tractor_steering : now->tractor_steering,
             known ? component->sign * command->trailer_steering : now->trailer_steering);
    }
    give_estimate(component, then);
    return 0;
}

/* A command of so many samples ago, 0 for the newest. */
static inline const struct drawbar_command *sent_before(const struct component *component, int32_t samples)
{
    return &component->under_way[MOST_COMMANDS - 1 - samples];
}

/* Remember the newest command, and give the one that acts in the mean of the sample that now begins: two commands act, one
 * after the other, unless the dead time is a whole number of samples. All NaN as long as none has arrived at the actuators. */
int UNIT(sent)(struct component *component, const struct drawbar_command *newest, struct drawbar_command *acting)
{
    static const struct drawbar_command nothing = {(double)NAN, (double)NAN, (double)NAN, (double)NAN};
    struct drawbar_command *commands = component->under_way;
    const double samples = fmin(component->dead_time / component->sample_time, MOST_COMMANDS - 2.0);
    const int32_t later = (int32_t)(samples + WHOLE_SAMPLES);
    const double share = fmax(samples - later, 0.0);

    memmove(&commands[0], &commands[1], (MOST_COMMANDS - 1) * sizeof *commands);
    commands[MOST_COMMANDS - 1] = *newest;
    component->sent += component->sent < MOST_COMMANDS;
    *acting = component->sent > later ? *sent_before(component, later) : nothing;
    if (component->sent > later + 1) {
        const struct drawbar_command *earlier = sent_before(component, later + 1);
        acting->tractor_steering += share * (earlier->tractor_steering - acting->tractor_steering);
        acting->trailer_steering += share * (earlier->trailer_steering - acting->trailer_steering);
        acting->speed += share * (earlier->speed - acting->speed);
    }
    return 0;
}

/* From now on reckon with another dead time and other lags of tractor and trailer, s. */
int UNIT(actuation)(struct component *component, double dead_time, double tractor_lag, double trailer_lag)
{
    component->dead_time = dead_time;
    component->constants[FIRST_LAG] = tractor_lag;
    component->constants[FIRST_LAG + 1] = trailer_lag;
    return 0;
}

#endif

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
    double sign;                           /* -1 where the joint's actuator is reversed, else 1 */
    double constants[CONSTANTS];           /* of the model with its actuators */
    int32_t sent;                          /* commands so far, up to MOST_COMMANDS */
    struct drawbar_command under_way[MOST_COMMANDS];   /* oldest first; the newest `sent` are valid */
    double x[1][STATES], u[1][INPUTS], p[1][PARAMETERS], duration[1][1], y[1][OUTPUTS];
};

#define WHOLE_SAMPLES 1e-9                 /* a dead time that is longer by less is a whole number of samples */

#define COMPONENT_FIELDS                                                                                          \
    SETTING(component, dead_time, 0, 1, 0, 0) SETTING(component, sample_time, 0, 1, 0, 0)                              \
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

/* The estimate for the moment at which the next command begins to act. The speed stays as it is estimated: a drive is
 * slower than any dead time. Before any command the wheels stay as they are. */
int UNIT(ahead)(struct component *component, const struct drawbar_estimate *now, struct drawbar_estimate *then)
{
    const int32_t count = commands_under_way(component);

    *then = *now;
    then->time += component->dead_time;
    if (count == 0)
        return 0;
    take_estimate(component, now);
    for (int i = 0; i < count; ++i) {
        const struct drawbar_command *command = &component->under_way[MOST_COMMANDS - count + i];
        const int known = i >= count - component->sent;
        component->u[0][U_TRACTOR_TARGET] = known ? command->tractor_steering : now->tractor_steering;
        component->u[0][U_TRAILER_TARGET] = known ? component->sign * command->trailer_steering : now->trailer_steering;
        component->duration[0][0] = i == 0 ? oldest_acts(component, count) : component->sample_time;
        motion(component, 0, 1);
    }
    give_estimate(component, then);
    return 0;
}

/* Remember the newest command, and give the one that acts during most of the sample that now begins: all NaN as long as
 * none has arrived at the actuators. */
int UNIT(sent)(struct component *component, const struct drawbar_command *newest, struct drawbar_command *acting)
{
    static const struct drawbar_command nothing = {(double)NAN, (double)NAN, (double)NAN, (double)NAN};
    struct drawbar_command *commands = component->under_way;
    const int32_t count = commands_under_way(component);
    const int soon = count > 0 && oldest_acts(component, count) < 0.5 * component->sample_time;
    const int32_t back = count - soon;     /* the one that acts was sent so many samples ago */

    memmove(&commands[0], &commands[1], (MOST_COMMANDS - 1) * sizeof *commands);
    commands[MOST_COMMANDS - 1] = *newest;
    component->sent += component->sent < MOST_COMMANDS;
    *acting = component->sent > back ? commands[MOST_COMMANDS - 1 - back] : nothing;
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

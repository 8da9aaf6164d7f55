/* Dead-time compensation: plan from where the commands under way will have taken the vehicle (Smith 1957; Findeisen and
 * Allgoewer 2004 for predictive control).
 *
 * The including unit defines COMMANDS, how many are under way; STATES, PARAMETERS and OUTPUTS, the sizes of the model
 * with its actuators; and by MOTION its functions take_estimate, motion and give_estimate, generated from that model.
 */
#ifndef DRAWBAR_DEAD_TIME_H
#define DRAWBAR_DEAD_TIME_H

#include <math.h>
#include <string.h>
#include "lanes.h"
#include "signals.h"
#include "unit.h"

struct component {
    double dead_time;                      /* s */
    double sign;                           /* -1 where the joint's actuator is reversed, else 1 */
    double durations[COMMANDS];            /* for how long each command under way acts within the dead time, s */
    int32_t soon;                          /* the oldest acts for less than half a sample: then comes the next */
    int32_t sent;                          /* commands so far, up to COMMANDS + 1 */
    struct drawbar_command under_way[COMMANDS]; /* oldest first; the newest `sent` of them are valid */
    double x[1][STATES], u[1][2], p[1][PARAMETERS], duration[1][1], y[1][OUTPUTS];
};

#define COMPONENT_FIELDS                                                                                          \
    SETTING(component, dead_time, 0, 1, 0, 0) SETTING(component, sign, 0, 1, 0, 0)                                     \
    SETTING(component, durations, 0, COMMANDS, 0, 0) SETTING(component, soon, 1, 1, 0, 0)

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
    *then = *now;
    then->time += component->dead_time;
    take_estimate(component, now);
    for (int i = 0; i < COMMANDS; ++i) {
        const struct drawbar_command *command = &component->under_way[i];
        const int known = i >= COMMANDS - component->sent;
        component->u[0][0] = known ? command->tractor_steering : now->tractor_steering;
        component->u[0][1] = known ? component->sign * command->trailer_steering : now->trailer_steering;
        component->duration[0][0] = component->durations[i];
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
    const struct drawbar_command oldest = component->under_way[0];

    memmove(&component->under_way[0], &component->under_way[1], (COMMANDS - 1) * sizeof oldest);
    component->under_way[COMMANDS - 1] = *newest;
    component->sent += component->sent <= COMMANDS;
    if (component->sent + component->soon <= COMMANDS)
        *acting = nothing;
    else
        *acting = component->soon ? component->under_way[0] : oldest;
    return 0;
}

#endif

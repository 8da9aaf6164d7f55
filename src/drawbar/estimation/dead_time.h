/* Dead-time compensation: plan from where the commands under way will have taken the vehicle (Smith 1957; Findeisen and
 * Allgoewer 2004 for predictive control).
 *
 * The including unit defines MOST_COMMANDS, how many can be under way; STATES, INPUTS, PARAMETERS, OUTPUTS and CONSTANTS,
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
    double dead_time;                      /* s */
    double sign;                           /* -1 where the joint's actuator is reversed, else 1 */
    double constants[CONSTANTS];           /* of the model with its actuators */
    double durations[MOST_COMMANDS];       /* for how long each command under way acts within the dead time, s */
    int32_t count;                         /* how many are under way, at least one */
    int32_t soon;                          /* the oldest acts for less than half a sample: then comes the next */
    int32_t sent;                          /* commands so far, up to count + 1 */
    struct drawbar_command under_way[MOST_COMMANDS];   /* oldest first; the newest `sent` of the count are valid */
    double x[1][STATES], u[1][INPUTS], p[1][PARAMETERS], duration[1][1], y[1][OUTPUTS];
};

#define COMPONENT_FIELDS                                                                                          \
    SETTING(component, dead_time, 0, 1, 0, 0) SETTING(component, sign, 0, 1, 0, 0)                                     \
    SETTING(component, constants, 0, CONSTANTS, 0, 0) SETTING(component, durations, 0, MOST_COMMANDS, 0, 0)            \
    SETTING(component, count, 1, 1, 0, 0) SETTING(component, soon, 1, 1, 0, 0)

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
    for (int i = 0; i < component->count; ++i) {
        const struct drawbar_command *command = &component->under_way[i];
        const int known = i >= component->count - component->sent;
        component->u[0][U_TRACTOR_TARGET] = known ? command->tractor_steering : now->tractor_steering;
        component->u[0][U_TRAILER_TARGET] = known ? component->sign * command->trailer_steering : now->trailer_steering;
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
    struct drawbar_command *under_way = component->under_way;
    const struct drawbar_command oldest = under_way[0];
    const int32_t last = component->count - 1;

    memmove(&under_way[0], &under_way[1], (size_t)last * sizeof oldest);
    under_way[last] = *newest;
    component->sent += component->sent <= component->count;
    if (component->sent + component->soon <= component->count)
        *acting = nothing;
    else
        *acting = component->soon ? under_way[0] : oldest;
    return 0;
}

#endif

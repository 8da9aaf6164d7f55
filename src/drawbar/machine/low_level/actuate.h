/* The low level as the library offers it: what is checked, what is remembered, what happens at a fault. The laws are in
 * position_loop.h and speed_loop.h, the promises in drawbar_actuate.h. */
#ifndef DRAWBAR_ACTUATE_LOOPS_H
#define DRAWBAR_ACTUATE_LOOPS_H

#include <math.h>
#include <stddef.h>
#include <string.h>
#include "ieee.h"
#include "position_loop.h"
#include "speed_loop.h"

#define ACTUATE_INITIALISED 0x61637475u    /* "actu" */
#define POSSIBLE_SPEED 2.0                 /* in full speeds: more no wheel can turn */

struct low_level {
    struct drawbar_actuate_settings settings;
    struct position_memory positions[DRAWBAR_ACTUATORS];
    struct speed_memory speed;
    double held;                           /* sign of the pedal's drive while it is the largest, else 0 */
    double time;                           /* of the last call, s */
    double stood;                          /* for how long standing tyres have been turned, s */
    int32_t faults[DRAWBAR_ACTUATORS];     /* enum drawbar_actuate_status, or 0 */
    int32_t active[DRAWBAR_ACTUATORS];     /* asked for in the last call */
    int32_t called;
    uint32_t magic;
};

/* What all actuators of one call have in common. */
struct moment {
    double dt;                             /* since the last call, s; 0 in the first */
    int late;                              /* that is no time to reckon with */
    int standing;
};

typedef char low_level_fits[sizeof(struct low_level) <= sizeof(struct drawbar_actuate_state) ? 1 : -1];

static int settings_are_sound(const struct drawbar_actuate_settings *s)
{
    int sound = setting_within(s->longest_period, 1.0 / LARGEST_SETTING, 1.0)
        && setting_within(s->standstill, 1.0 / LARGEST_SETTING, LARGEST_SETTING)
        && setting_within(s->standing_time, 0.0, LARGEST_SETTING);

    for (int i = 0; i < DRAWBAR_ACTUATORS; ++i)
        if (s->present[i])
            sound = sound && sensor_is_sound(&s->sensors[i]) && position_loop_is_sound(&s->loops[i]);
    return sound && (!s->present[DRAWBAR_ACTUATOR_PEDAL] || speed_loop_is_sound(&s->speed));
}

struct placed_low_level {
    char before;
    struct low_level low;
};

struct placed_input {                      /* with its time stamp, which is a double in single precision, too */
    char before;
    struct drawbar_actuate_input input;
};

struct placed_setting {
    char before;
    double number;
};

/* What is wrong with a pointer, or 0. Some processors cannot even read numbers that are not aligned. */
static int misplaced(const void *pointer, size_t alignment)
{
    if (pointer == NULL)
        return DRAWBAR_ACTUATE_NULL;
    return (uintptr_t)pointer % alignment == 0 ? 0 : DRAWBAR_ACTUATE_UNALIGNED;
}

static int misplaced_state(const struct drawbar_actuate_state *state)
{
    return misplaced(state, offsetof(struct placed_low_level, low));
}

static int misplaced_input(const struct drawbar_actuate_input *input)
{
    return misplaced(input, offsetof(struct placed_input, input));
}

static int misplaced_numbers(const void *numbers)
{
    return misplaced(numbers, offsetof(struct placed_setting, number));
}

int drawbar_actuate_init(struct drawbar_actuate_state *state, const struct drawbar_actuate_settings *settings)
{
    struct low_level *low = (struct low_level *)state;
    const int refused = misplaced_state(state), unread = misplaced_numbers(settings);

    if (refused)
        return refused;
    memset(low, 0, sizeof *low);
    if (unread)
        return unread;
    if (!ieee_knows_missing())
        return DRAWBAR_ACTUATE_ARITHMETIC;
    if (!settings_are_sound(settings))
        return DRAWBAR_ACTUATE_SETTINGS;
    low->settings = *settings;
    low->magic = ACTUATE_INITIALISED;
    return DRAWBAR_ACTUATE_FINE;
}

/* Everything off: the output of a call that was wrong. */
static int nothing(struct drawbar_actuate_output *output, int status)
{
    memset(output, 0, sizeof *output);
    for (int i = 0; i < DRAWBAR_ACTUATORS; ++i) {
        output->positions[i] = (double)NAN;
        output->statuses[i] = status;
    }
    return status;
}

static struct moment moment_of(struct low_level *low, const struct drawbar_actuate_input *input)
{
    const double dt = low->called ? input->time - low->time : 0.0;
    struct moment moment = {dt, !isfinite(input->time), !(fabs(input->measured_speed) >= low->settings.standstill)};

    if (low->called && !(dt > 0.0 && dt <= low->settings.longest_period))
        moment.late = 1;
    if (moment.late)
        moment.dt = 0.0;
    if (isfinite(input->time)) {           /* else there is nothing from which to reckon the next */
        low->time = input->time;
        low->called = 1;
    }
    return moment;
}

/* Start, continue or release; a fault lasts until a release. A gap before the beginning is none. */
static void note_wanted(struct low_level *low, int i, int wanted, int fault, int late)
{
    if (!wanted) {
        low->faults[i] = low->active[i] = 0;
        return;
    }
    if (low->faults[i] == 0)
        low->faults[i] = late && low->active[i] ? DRAWBAR_ACTUATE_TIME : fault;
    if (!low->active[i] || low->faults[i])
        low->positions[i].integral = 0.0;
    low->active[i] = 1;
}

/* What is wrong with a position's measurement or set point, or 0. */
static int position_fault(const struct low_level *low, int i, double position, double target, double time)
{
    if (!isfinite(time))
        return DRAWBAR_ACTUATE_TIME;
    if (isnan(position))
        return DRAWBAR_ACTUATE_SENSOR;
    return fabs(target) <= low->settings.loops[i].limit ? 0 : DRAWBAR_ACTUATE_SET_POINT;
}

static double drive_to(struct low_level *low, int i, double error, double dt, double *saturated)
{
    return position_drive(&low->settings.loops[i], &low->positions[i], error, dt, saturated);
}

static void steer(struct low_level *low, int i, const struct drawbar_actuate_input *input, const struct moment *moment,
                  struct drawbar_actuate_output *output)
{
    const double position = output->positions[i];
    double saturated;

    note_wanted(low, i, input->steer[i], position_fault(low, i, position, input->steering[i], input->time), moment->late);
    if (!low->active[i] || low->faults[i]) {
        output->statuses[i] = low->active[i] ? low->faults[i] : DRAWBAR_ACTUATE_OFF;
        return;
    }
    if (moment->standing) {
        low->positions[i].integral = 0.0;
        if (low->stood >= low->settings.standing_time) {
            output->statuses[i] = DRAWBAR_ACTUATE_STANDING;
            return;
        }
    }
    output->drives[i] = drive_to(low, i, input->steering[i] - position, moment->standing ? 0.0 : moment->dt, &saturated);
}

static int speed_fault(const struct low_level *low, const struct drawbar_actuate_input *input, double position)
{
    const double full = low->settings.speed.full_speed;

    if (!isfinite(input->time))
        return DRAWBAR_ACTUATE_TIME;
    if (isnan(position))
        return DRAWBAR_ACTUATE_SENSOR;
    if (!(fabs(input->measured_speed) <= POSSIBLE_SPEED * full))
        return DRAWBAR_ACTUATE_SPEED;
    return input->speed >= 0.0 && input->speed <= full ? 0 : DRAWBAR_ACTUATE_SET_POINT;
}

static void drive(struct low_level *low, const struct drawbar_actuate_input *input, const struct moment *moment,
                  struct drawbar_actuate_output *output)
{
    const int pedal = DRAWBAR_ACTUATOR_PEDAL, begins = !low->active[pedal];
    const double position = output->positions[pedal];

    note_wanted(low, pedal, input->drive, speed_fault(low, input, position), moment->late);
    if (begins || low->faults[pedal])
        speed_begin(&low->settings.speed, &low->speed, isfinite(input->measured_speed) ? input->measured_speed : 0.0);
    if (!low->active[pedal]) {
        output->statuses[pedal] = DRAWBAR_ACTUATE_OFF;
        low->held = 0.0;
        return;
    }
    if (low->faults[pedal] == 0
        && speed_is_unmoved(&low->settings.speed, &low->speed, position, moment->standing, moment->dt))
        low->faults[pedal] = DRAWBAR_ACTUATE_NO_FEEDBACK;
    if (low->faults[pedal] == 0)
        output->pedal = speed_pedal(&low->settings.speed, &low->speed, input->speed, input->measured_speed, low->held,
                                    moment->dt);
    output->statuses[pedal] = low->faults[pedal];
    if (!isnan(position))                  /* with a fault, too: back to 0 */
        output->drives[pedal] = drive_to(low, pedal, output->pedal - position, moment->dt, &low->held);
}

/* For how long standing tyres have been turned, both together: a rest in between makes up for nothing. */
static void note_standing(struct low_level *low, const struct moment *moment, const double *drives)
{
    if (!moment->standing)
        low->stood = 0.0;
    else if (drives[DRAWBAR_ACTUATOR_FRONT] != 0.0 || drives[DRAWBAR_ACTUATOR_JOINT] != 0.0)
        low->stood += moment->dt;
}

int drawbar_actuate(struct drawbar_actuate_state *state, const struct drawbar_actuate_input *input,
                    struct drawbar_actuate_output *output)
{
    struct low_level *low = (struct low_level *)state;
    const int unwritten = misplaced_numbers(output), unread = misplaced_input(input), refused = misplaced_state(state);
    int worst = DRAWBAR_ACTUATE_FINE;

    if (unwritten)
        return unwritten;
    if (refused || unread)
        return nothing(output, refused ? refused : unread);
    if (low->magic != ACTUATE_INITIALISED)
        return nothing(output, DRAWBAR_ACTUATE_NOT_INITIALISED);
    nothing(output, DRAWBAR_ACTUATE_OFF);
    const struct moment moment = moment_of(low, input);
    for (int i = 0; i < DRAWBAR_ACTUATORS; ++i) {
        if (!low->settings.present[i])
            continue;
        output->positions[i] = linearised(&low->settings.sensors[i], input->counts[i]);
        output->statuses[i] = DRAWBAR_ACTUATE_FINE;
        if (i == DRAWBAR_ACTUATOR_PEDAL)
            drive(low, input, &moment, output);
        else
            steer(low, i, input, &moment, output);
        worst = output->statuses[i] > worst ? output->statuses[i] : worst;
    }
    note_standing(low, &moment, output->drives);
    return worst;
}

const char *drawbar_actuate_status_text(int status)
{
    switch (status) {
    case DRAWBAR_ACTUATE_FINE:
        return "as asked";
    case DRAWBAR_ACTUATE_OFF:
        return "off: nothing is asked of it";
    case DRAWBAR_ACTUATE_STANDING:
        return "not steered any further: the vehicle stands";
    case DRAWBAR_ACTUATE_TIME:
        return "fault: the time is not finite, does not increase, or a call came too late";
    case DRAWBAR_ACTUATE_SET_POINT:
        return "fault: the set point is not finite or beyond its limit";
    case DRAWBAR_ACTUATE_SENSOR:
        return "fault: the sensor's counts are not finite or outside its electrical range";
    case DRAWBAR_ACTUATE_SPEED:
        return "fault: the measured speed is not finite or beyond what the vehicle can do";
    case DRAWBAR_ACTUATE_NO_FEEDBACK:
        return "fault: the pedal is pressed and the wheels report that they stand";
    case DRAWBAR_ACTUATE_NULL:
        return "wrong call: a pointer is NULL";
    case DRAWBAR_ACTUATE_UNALIGNED:
        return "wrong call: a pointer is not aligned as a double";
    case DRAWBAR_ACTUATE_NOT_INITIALISED:
        return "wrong call: drawbar_actuate_init has not been called with success";
    case DRAWBAR_ACTUATE_SETTINGS:
        return "wrong call: a setting is not finite or beyond what is allowed";
    case DRAWBAR_ACTUATE_ARITHMETIC:
        return "wrong build: NaN passes for a number";
    default:
        return "no status of the low level";
    }
}

#endif

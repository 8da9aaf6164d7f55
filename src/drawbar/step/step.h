/* Step, as a library offers it to the world: every pointer and the order of calls are checked here, the rest is in
 * control_step.h. */
#ifndef DRAWBAR_STEP_H
#define DRAWBAR_STEP_H

#include <string.h>
#include "arithmetic.h"
#include "control_step.h"
#include "path.h"
#include "status_text.h"
#ifdef DRAWBAR_HOSTED
#include "hosted_step.h"
#endif

#ifdef DRAWBAR_MARK                        /* of this very export: the state of another is none here */
#define INITIALISED DRAWBAR_MARK
#else
#define INITIALISED 0x64726177u            /* "draw" */
#endif

/* How a structure of the interface is aligned: in single precision those with a time stamp otherwise than the others. */
#define PLACED(name) struct placed_##name { char before; struct drawbar_##name it; }
#define ALIGNMENT(name) offsetof(struct placed_##name, it)

PLACED(state);
PLACED(path_node);
PLACED(measurement);
PLACED(command);
PLACED(estimate);
PLACED(diagnostics);
PLACED(actuation);

typedef char state_has_room[sizeof(struct autopilot) <= sizeof(struct drawbar_state) ? 1 : -1];

static int is_aligned(const void *pointer, size_t alignment)
{
    return (uintptr_t)pointer % alignment == 0;
}

/* What is wrong with pointers: DRAWBAR_OK where a state and what is given can lie there. Some processors cannot even read others. */
static int placed(const struct drawbar_state *state, const void *given, size_t alignment)
{
    if (state == NULL || given == NULL)
        return DRAWBAR_NULL;
    return is_aligned(state, ALIGNMENT(state)) && is_aligned(given, alignment) ? DRAWBAR_OK : DRAWBAR_UNALIGNED;
}

/* What is wrong with a call: DRAWBAR_OK where the state holds an initialised autopilot and what it needs is given. */
static int usable(const struct drawbar_state *state, const void *given, size_t alignment)
{
    const int refused = placed(state, given, alignment);

    if (refused)
        return refused;
    return ((const struct autopilot *)state)->magic == INITIALISED ? DRAWBAR_OK : DRAWBAR_NOT_INITIALISED;
}

/* The command of a call that was wrong: stand. */
static int stand(struct drawbar_command *command, int status)
{
    memset(command, 0, sizeof *command);
    return status;
}

/* Forget everything but what the caller of a hosted library gave. */
static void forget(struct autopilot *a)
{
#ifdef DRAWBAR_HOSTED
    memset(a, 0, offsetof(struct autopilot, settings));
    memset(&a->path, 0, offsetof(struct autopilot, alignment) - offsetof(struct autopilot, path));
#else
    memset(a, 0, sizeof *a);
    a->settings = (struct step_settings)DRAWBAR_STEP_SETTINGS;
#endif
}

int drawbar_init(struct drawbar_state *state)
{
    struct autopilot *a = (struct autopilot *)state;
    const int refused = placed(state, state, ALIGNMENT(state));

    if (refused)
        return refused;
    if (!arithmetic_is_sound())
        return DRAWBAR_ARITHMETIC;
    forget(a);
    a->magic = INITIALISED;
    a->wanted_speed = a->settings.speed;
    drawbar_gate_initialise(COMPONENT(a->gate));
    return DRAWBAR_OK;
}

/* Let the line be the path itself. */
static void follow_path(struct autopilot *a)
{
    memset(&a->offset, 0, sizeof a->offset);
}

int drawbar_set_path(struct drawbar_state *state, const struct drawbar_path_node *nodes, int32_t count)
{
    const struct path path = {nodes, count, NULL};
    struct autopilot *a = (struct autopilot *)state;
    const int refused = usable(state, nodes, ALIGNMENT(path_node));

    if (refused)
        return refused;
    if (drawbar_path_check(&path) >= 0)
        return DRAWBAR_PATH;
    a->path = path;
    follow_path(a);
    a->start = 0.0;
    a->started = a->ended = a->called = a->due = 0;
    return DRAWBAR_OK;
}

int drawbar_begin_at(struct drawbar_state *state, double arc_length)
{
    struct autopilot *a = (struct autopilot *)state;
    const int refused = usable(state, state, ALIGNMENT(state));

    if (refused)
        return refused;
    if (a->path.count == 0 || a->started)
        return a->started ? DRAWBAR_ORDER : DRAWBAR_NO_PATH;
    if (!(arc_length >= 0.0 && arc_length < path_length(&a->path)))
        return DRAWBAR_RANGE;
    a->start = arc_length;
    return DRAWBAR_OK;
}

int drawbar_change_path(struct drawbar_state *state, const struct drawbar_path_node *nodes, int32_t count,
                        double arc_length)
{
    const struct path path = {nodes, count, NULL};
    struct autopilot *a = (struct autopilot *)state;
    const int refused = usable(state, nodes, ALIGNMENT(path_node));

    if (refused)
        return refused;
    if (!a->started || a->ended)
        return DRAWBAR_NO_RUN;
    if (drawbar_path_check(&path) >= 0)
        return DRAWBAR_PATH;
    if (!(arc_length >= 0.0 && arc_length < path_length(&path)))
        return DRAWBAR_RANGE;
    if (drawbar_guidance_change(COMPONENT(a->guidance), &path, arc_length, &a->made.estimate)
        != DRAWBAR_GUIDANCE_FINE)
        return DRAWBAR_ELSEWHERE;
    drawbar_run_monitor_rejoin(COMPONENT(a->run_monitor));
    a->path = path;
    follow_path(a);
    return DRAWBAR_OK;
}

int drawbar_set_offset(struct drawbar_state *state, double offset)
{
    struct autopilot *a = (struct autopilot *)state;
    const int refused = usable(state, state, ALIGNMENT(state));

    if (refused)
        return refused;
    if (a->path.count == 0)
        return DRAWBAR_NO_PATH;
    if (!(fabs(offset) <= OFFSET_LARGEST && path_has_beside(&a->path, offset, a->settings.curvature)))
        return DRAWBAR_RANGE;
    a->offset.wanted = offset;
    return DRAWBAR_OK;
}

int drawbar_set_speed(struct drawbar_state *state, double speed)
{
    struct autopilot *a = (struct autopilot *)state;
    const int refused = usable(state, state, ALIGNMENT(state));

    if (refused)
        return refused;
    if (!(speed >= 0.0 && speed <= a->settings.speed))
        return DRAWBAR_RANGE;
    a->wanted_speed = speed;
    return DRAWBAR_OK;
}

int drawbar_set_engaged(struct drawbar_state *state, int32_t engaged)
{
    struct autopilot *a = (struct autopilot *)state;
    const int refused = usable(state, state, ALIGNMENT(state));

    if (refused)
        return refused;
    a->released = !engaged;
    return DRAWBAR_OK;
}

/* Both phases; static, so that drawbar_step calls them, and not those of another library in the same program. */
static int feedback_phase(struct drawbar_state *state, const struct drawbar_measurement *measurement,
                          struct drawbar_command *command)
{
    struct autopilot *a = (struct autopilot *)state;
    const int refused = usable(state, command, ALIGNMENT(command));
    const int unread = placed(state, measurement, ALIGNMENT(measurement));

    if (command == NULL || !is_aligned(command, ALIGNMENT(command)))
        return command == NULL ? DRAWBAR_NULL : DRAWBAR_UNALIGNED;
    if (refused)
        return stand(command, refused);
    if (unread) {
        drawbar_gate_stand(COMPONENT(a->gate), a->time, command);
        return unread;
    }
    if (a->path.count == 0 || a->called) {
        drawbar_gate_stand(COMPONENT(a->gate), a->time, command);
        return a->called ? DRAWBAR_ORDER : DRAWBAR_NO_PATH;
    }
    a->called = 1;
    const int status = feed_back(a, measurement, command);
    a->diagnostics.status = status < DRAWBAR_REFUSED ? DRAWBAR_OK : status;
    return status;
}

static int preparation_phase(struct drawbar_state *state)
{
    struct autopilot *a = (struct autopilot *)state;
    const int refused = usable(state, state, ALIGNMENT(state));

    if (refused)
        return refused;
    if (!a->called)
        return DRAWBAR_ORDER;
    if (a->due)
        prepare(a);
    a->called = a->due = 0;
    return DRAWBAR_OK;
}

int drawbar_feedback(struct drawbar_state *state, const struct drawbar_measurement *measurement,
                     struct drawbar_command *command)
{
    return feedback_phase(state, measurement, command);
}

int drawbar_prepare(struct drawbar_state *state)
{
    return preparation_phase(state);
}

int drawbar_step(struct drawbar_state *state, const struct drawbar_measurement *measurement,
                 struct drawbar_command *command)
{
    const int status = feedback_phase(state, measurement, command);

    if (status < DRAWBAR_NULL)
        preparation_phase(state);
    return status;
}

int drawbar_get_estimate(const struct drawbar_state *state, struct drawbar_estimate *estimate)
{
    const int status = usable(state, estimate, ALIGNMENT(estimate));

    if (status == DRAWBAR_OK)
        *estimate = ((const struct autopilot *)state)->made.estimate;
    return status;
}

int drawbar_get_diagnostics(const struct drawbar_state *state, struct drawbar_diagnostics *diagnostics)
{
    const int status = usable(state, diagnostics, ALIGNMENT(diagnostics));

    if (status == DRAWBAR_OK)
        *diagnostics = ((const struct autopilot *)state)->diagnostics;
    return status;
}

int drawbar_get_actuation(const struct drawbar_state *state, struct drawbar_actuation *actuation)
{
    const int status = usable(state, actuation, ALIGNMENT(actuation));

    if (status == DRAWBAR_OK)
        *actuation = ((const struct autopilot *)state)->known;
    return status;
}

const char *drawbar_version(void)
{
    return DRAWBAR_VERSION;
}

int32_t drawbar_state_size(void)
{
    return (int32_t)sizeof(struct drawbar_state);
}

#endif

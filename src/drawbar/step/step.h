/* What an exported library offers to the world: every pointer and the order of calls are checked here, the rest is in
 * control_step.h. */
#ifndef DRAWBAR_STEP_H
#define DRAWBAR_STEP_H

#include <string.h>
#include "control_step.h"
#include "path_check.h"
#include "status_text.h"

#define INITIALISED 0x64726177u            /* "draw" */

typedef char state_has_room[sizeof(struct autopilot) <= sizeof(struct drawbar_state) ? 1 : -1];

/* The autopilot in a state, or NULL where there is none. */
static struct autopilot *autopilot_in(struct drawbar_state *state)
{
    struct autopilot *a = (struct autopilot *)state;
    return a->magic == INITIALISED ? a : NULL;
}

/* The command of a call that was wrong: stand. */
static int stand(struct drawbar_command *command, int status)
{
    memset(command, 0, sizeof *command);
    return status;
}

int drawbar_init(struct drawbar_state *state)
{
    struct autopilot *a = (struct autopilot *)state;

    if (state == NULL)
        return DRAWBAR_NULL;
    memset(state, 0, sizeof *state);
    a->magic = INITIALISED;
    drawbar_gate_initialise(COMPONENT(a->gate));
    return DRAWBAR_OK;
}

int drawbar_set_path(struct drawbar_state *state, const struct drawbar_path_node *nodes, int32_t count)
{
    const struct path path = {nodes, count};
    struct autopilot *a;

    if (state == NULL || nodes == NULL)
        return DRAWBAR_NULL;
    if ((a = autopilot_in(state)) == NULL)
        return DRAWBAR_NOT_INITIALISED;
    if (path_check(&path) >= 0)
        return DRAWBAR_PATH;
    a->path = path;
    a->begun = a->ended = a->called = a->due = 0;
    return DRAWBAR_OK;
}

int drawbar_feedback(struct drawbar_state *state, const struct drawbar_measurement *measurement,
                     struct drawbar_command *command)
{
    struct autopilot *a;

    if (command == NULL)
        return DRAWBAR_NULL;
    if (state == NULL)
        return stand(command, DRAWBAR_NULL);
    if ((a = autopilot_in(state)) == NULL)
        return stand(command, DRAWBAR_NOT_INITIALISED);
    if (measurement == NULL) {
        drawbar_gate_stand(COMPONENT(a->gate), a->time, command);
        return DRAWBAR_NULL;
    }
    if (a->path.count == 0 || a->called) {
        drawbar_gate_stand(COMPONENT(a->gate), a->time, command);
        return a->called ? DRAWBAR_ORDER : DRAWBAR_NO_PATH;
    }
    a->called = 1;
    return a->diagnostics.status = feed_back(a, measurement, command);
}

int drawbar_prepare(struct drawbar_state *state)
{
    struct autopilot *a;

    if (state == NULL)
        return DRAWBAR_NULL;
    if ((a = autopilot_in(state)) == NULL)
        return DRAWBAR_NOT_INITIALISED;
    if (!a->called)
        return DRAWBAR_ORDER;
    if (a->due)
        prepare(a);
    a->called = a->due = 0;
    return DRAWBAR_OK;
}

int drawbar_step(struct drawbar_state *state, const struct drawbar_measurement *measurement,
                 struct drawbar_command *command)
{
    const int status = drawbar_feedback(state, measurement, command);

    if (status < DRAWBAR_NULL)
        drawbar_prepare(state);
    return status;
}

int drawbar_get_estimate(const struct drawbar_state *state, struct drawbar_estimate *estimate)
{
    const struct autopilot *a = (const struct autopilot *)state;

    if (state == NULL || estimate == NULL)
        return DRAWBAR_NULL;
    if (a->magic != INITIALISED)
        return DRAWBAR_NOT_INITIALISED;
    *estimate = a->estimate;
    return DRAWBAR_OK;
}

int drawbar_get_diagnostics(const struct drawbar_state *state, struct drawbar_diagnostics *diagnostics)
{
    const struct autopilot *a = (const struct autopilot *)state;

    if (state == NULL || diagnostics == NULL)
        return DRAWBAR_NULL;
    if (a->magic != INITIALISED)
        return DRAWBAR_NOT_INITIALISED;
    *diagnostics = a->diagnostics;
    return DRAWBAR_OK;
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

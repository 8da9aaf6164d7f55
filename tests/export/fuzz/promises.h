/* What drawbar.h promises of every command, whatever went in. */
#ifndef PROMISES_H
#define PROMISES_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "drawbar.h"

/* TRACTOR_LIMIT, TRAILER_LIMIT (rad), SPEED_LIMIT (m/s), TRACTOR_CHANGE, TRAILER_CHANGE (rad, from command to command)
 * are those of the configuration. */
#define ROUNDING 1e-12

#define PROMISED(condition)                                                                                  \
    do {                                                                                                     \
        if (!(condition)) {                                                                                  \
            fprintf(stderr, "broken promise: %s\n", #condition);                                             \
            abort();                                                                                         \
        }                                                                                                    \
    } while (0)

/* The last command of the run; known only once it has begun, from wherever the wheels are. */
struct given {
    struct drawbar_command command;
    int known;
};

static void promise_bounds(const struct drawbar_command *command)
{
    PROMISED(fabs(command->tractor_steering) <= TRACTOR_LIMIT);
    PROMISED(fabs(command->trailer_steering) <= TRAILER_LIMIT);
    PROMISED(command->speed >= 0.0 && command->speed <= SPEED_LIMIT);
    PROMISED(isfinite(command->time));
}

static void promise_rates(const struct given *last, const struct drawbar_command *command)
{
    const double tractor = fabs(command->tractor_steering - last->command.tractor_steering);
    const double trailer = fabs(command->trailer_steering - last->command.trailer_steering);

    PROMISED(tractor <= TRACTOR_CHANGE + ROUNDING && trailer <= TRAILER_CHANGE + ROUNDING);
}

static void promise_held(const struct given *last, const struct drawbar_command *command)
{
    PROMISED(command->tractor_steering == last->command.tractor_steering);
    PROMISED(command->trailer_steering == last->command.trailer_steering);
}

static int has_begun(int status)
{
    return status != DRAWBAR_TIME && status != DRAWBAR_POSITION && status != DRAWBAR_START && status < DRAWBAR_NULL;
}

/* A command that came with this status, after the last one. */
static void promise(struct given *last, int status, const struct drawbar_command *command)
{
    PROMISED(strcmp(drawbar_status_text(status), drawbar_status_text(-1)) != 0);
    promise_bounds(command);
    if (status >= DRAWBAR_FINISHED)
        PROMISED(command->speed == 0.0);
    if (last->known && status >= DRAWBAR_REFUSED)
        promise_held(last, command);
    else if (last->known)
        promise_rates(last, command);
    last->known |= has_begun(status);
    last->command = *command;
}

#endif

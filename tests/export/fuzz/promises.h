/* What drawbar.h promises of every command, whatever went in. */
#ifndef PROMISES_H
#define PROMISES_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "drawbar.h"
#include "geometry.h"

/* TRACTOR_LIMIT, TRAILER_LIMIT (rad), SPEED_LIMIT (m/s), TRACTOR_CHANGE, TRAILER_CHANGE (rad, from command to command),
 * ACCELERATION (m/s^2) are those of the configuration; LEEWAY is what rounding may add to any of them. */
#define PATIENCE 1.0                       /* for how long a command is repeated, s */
#define KEPT 0.5                           /* for how long the speed stays where solvers fail or samples come late, s */
#define ENDURANCE 3.0                      /* after how long of that the vehicle stands, s */
#define CLOCKS 0.05                        /* share of the time by which clocks may differ */
#define COUNTED 5.0                        /* sample times by which counted and passed time may differ beyond that */
#define FLAGS                                                                                                \
    (DRAWBAR_MEASUREMENT | DRAWBAR_LATE | DRAWBAR_LIMITED | DRAWBAR_SOLVER | DRAWBAR_SLOWED \
     | DRAWBAR_RELEASED)

#define PROMISED(condition)                                                                                  \
    do {                                                                                                     \
        if (!(condition)) {                                                                                  \
            fprintf(stderr, "broken promise: %s\n", #condition);                                             \
            abort();                                                                                         \
        }                                                                                                    \
    } while (0)

/* What has come of a run so far. */
struct run {
    int begun;
    int ended;                             /* enum drawbar_status with which it did, or 0 */
    int stopped;                           /* its newest command was a stop of the gate */
    int given;                             /* there is a last command, be it of the run before */
    struct drawbar_command last;           /* the newest command */
    int repeats;                           /* samples since a new command */
    time_stamp renewed;                    /* time of the newest command that was new, s */
    time_stamp taken;                      /* time of the newest sample that was taken, s */
    double unsolved;                       /* since all solvers had solutions; a sample counts for its length, or more, s */
    double overdue;                        /* by which samples came late, less half of the time in order since, s */
    double counted;                        /* by how much samples were taken for longer than has passed, s */
    double wanted;                         /* set speed, m/s */
    double speed;                          /* of the newest command that was new, m/s; SPEED_LIMIT: somebody else drove */
    int released;                          /* somebody else drives */
};

/* One sample: what went in, and what came out. */
struct answer {
    double time;                           /* of the measurement, s */
    int absurd;                            /* one of its values was infinite */
    int unsolved;                          /* a solver was made to fail */
    int status;
    struct drawbar_command command;
    struct drawbar_diagnostics diagnostics;
};

static void promise_bounds(const struct drawbar_command *command)
{
    PROMISED(fabs(command->tractor_steering) <= TRACTOR_LIMIT);
    PROMISED(fabs(command->trailer_steering) <= TRAILER_LIMIT);
    PROMISED(command->speed >= 0.0 && command->speed <= SPEED_LIMIT);
    PROMISED(isfinite(command->time));
}

static void promise_rates(const struct run *run, const struct drawbar_command *command)
{
    const double tractor = fabs(command->tractor_steering - run->last.tractor_steering);
    const double trailer = fabs(command->trailer_steering - run->last.trailer_steering);

    PROMISED(tractor <= TRACTOR_CHANGE + LEEWAY && trailer <= TRAILER_CHANGE + LEEWAY);
}

/* The steering of the last command, but for the sample at which the vehicle is first stopped: near it. */
static void promise_held(const struct run *run, const struct answer *answer)
{
    const struct drawbar_command *command = &answer->command;

    if (answer->status < DRAWBAR_NULL && answer->diagnostics.gate == DRAWBAR_GATE_STOPPED && !run->stopped) {
        promise_rates(run, command);
        return;
    }
    PROMISED(command->tractor_steering == run->last.tractor_steering);
    PROMISED(command->trailer_steering == run->last.trailer_steering);
}

/* Slower the longer solvers have failed or samples have come late, and never for longer than the endurance. */
static void promise_pace(const struct run *run, const struct answer *answer)
{
    const double doubt = fmax(answer->status & DRAWBAR_SOLVER ? run->unsolved : 0.0, run->overdue);
    const double share = (ENDURANCE - doubt) / (ENDURANCE - KEPT);
    const double speed = answer->command.speed, change = ACCELERATION * DRAWBAR_SAMPLE_TIME;

    PROMISED(speed <= fmax(run->wanted, run->speed - change) + LEEWAY);
    PROMISED(speed <= run->speed + (run->repeats + 1) * change + LEEWAY);
    PROMISED(doubt < ENDURANCE + LEEWAY);
    PROMISED(speed <= fmax(share, 0.0) * SPEED_LIMIT + LEEWAY);
    PROMISED(answer->status & DRAWBAR_SLOWED || doubt <= KEPT + LEEWAY);
    /* without such a doubt: coarse fixes or an oscillation, which leave at most this part of the speed */
    PROMISED(!(answer->status & DRAWBAR_SLOWED) || doubt >= KEPT - LEEWAY
             || speed <= fmax(SANITY_SHARE * SPEED_LIMIT, run->speed - change) + LEEWAY);
}

static void promise_new(const struct run *run, const struct answer *answer)
{
    const struct drawbar_diagnostics *d = &answer->diagnostics;
    const int status = answer->status, late = run->begun && answer->time - run->taken > 1.5 * DRAWBAR_SAMPLE_TIME;

    PROMISED((status & ~FLAGS) == 0);
    PROMISED(answer->command.time == answer->time);
    PROMISED(!(status & DRAWBAR_LATE) == !late);
    PROMISED(!(status & DRAWBAR_MEASUREMENT) == !d->missing && (d->missing || !answer->absurd));
    PROMISED(status & DRAWBAR_SOLVER || !answer->unsolved);
    PROMISED(!(status & DRAWBAR_RELEASED) == !run->released);
    if (run->released)
        PROMISED(d->gate == DRAWBAR_GATE_STOPPED && answer->command.speed == 0.0 && !(status & DRAWBAR_LIMITED));
    else
        PROMISED(d->gate == (status & DRAWBAR_LIMITED ? DRAWBAR_GATE_LIMITED : DRAWBAR_GATE_PASSED));
    PROMISED(d->flags == status && d->speed == answer->command.speed);
    promise_pace(run, answer);
}

/* The last command again, for at most one second by the clock and by count; where a run cannot begin the vehicle stands. */
static void promise_repeated(const struct run *run, const struct answer *answer)
{
    const struct drawbar_command *command = &answer->command;
    const int status = answer->status;

    PROMISED(status >= DRAWBAR_REFUSED && status <= (run->begun ? DRAWBAR_TIME : DRAWBAR_START));
    if (!run->begun && command->speed == 0.0)
        return;
    PROMISED(status == DRAWBAR_REFUSED || status == DRAWBAR_TIME);
    PROMISED(run->given && command->speed == run->last.speed);
    PROMISED(command->time - run->renewed < PATIENCE);
    PROMISED((run->repeats + 1) * DRAWBAR_SAMPLE_TIME < PATIENCE);
}

/* Whether a sample with this status is one of the run, or begins it. */
static int is_of_run(int status)
{
    return status != DRAWBAR_TIME && status != DRAWBAR_POSITION && status != DRAWBAR_START;
}

/* Whether the sample's time stamp is one. */
static int is_in_time(const struct run *run, double time)
{
    return isfinite(time) && (!run->begun || time > run->taken);
}

/* A time stamp that is none is not taken; a gap that is longer than a command may act ends the run. */
static void promise_time(const struct run *run, const struct answer *answer)
{
    const int in_time = is_in_time(run, answer->time);
    const double longest = PATIENCE + 0.5 * DRAWBAR_SAMPLE_TIME;

    PROMISED(answer->status != DRAWBAR_TIME || !in_time);
    PROMISED(in_time || answer->status == DRAWBAR_TIME || answer->status == DRAWBAR_STOPPED);
    PROMISED((answer->status == DRAWBAR_GAP) == (in_time && run->begun && answer->time - run->taken > longest));
}

/* Note what a sample means for the run, before its answer. */
static void note_sample(struct run *run, const struct answer *answer)
{
    const double elapsed = answer->time - run->taken;

    if (run->ended || !is_in_time(run, answer->time))
        return;
    run->unsolved += run->begun ? fmax(elapsed, DRAWBAR_SAMPLE_TIME) : DRAWBAR_SAMPLE_TIME;
    if (!run->begun)
        return;
    const int late = elapsed > 1.5 * DRAWBAR_SAMPLE_TIME;
    run->overdue = late ? run->overdue + elapsed - DRAWBAR_SAMPLE_TIME
                        : fmax(run->overdue - 0.5 * DRAWBAR_SAMPLE_TIME, 0.0);
    const double due = (elapsed - fmax(run->counted, 0.0)) / DRAWBAR_SAMPLE_TIME;
    run->counted += (late ? fmax(floor(due + 0.5), 1.0) : 1.0) * DRAWBAR_SAMPLE_TIME - elapsed;
    run->counted -= fmax(-CLOCKS * elapsed, fmin(run->counted, CLOCKS * elapsed));
}

/* Samples at another rate than the library's end the run. */
static void promise_rate(const struct run *run, const struct answer *answer)
{
    const double most = COUNTED * DRAWBAR_SAMPLE_TIME;

    PROMISED(answer->status != DRAWBAR_RATE || fabs(run->counted) >= most - LEEWAY);
    PROMISED(answer->status == DRAWBAR_RATE || answer->status == DRAWBAR_GAP || fabs(run->counted) <= most + LEEWAY);
}

/* Note a sample and its answer. */
static void note_answer(struct run *run, const struct answer *answer)
{
    const int status = answer->status;
    const int goes_on = is_of_run(status);

    if (!run->begun && goes_on) {
        run->renewed = answer->time;
        run->repeats = 0;
    }
    run->begun |= goes_on;
    run->ended = status >= DRAWBAR_FINISHED ? status : 0;
    run->repeats = status < DRAWBAR_REFUSED ? 0 : run->repeats + 1;
    if (status != DRAWBAR_TIME)
        run->taken = answer->time;
    if (status < DRAWBAR_REFUSED) {
        run->renewed = answer->time;
        run->speed = run->released ? SPEED_LIMIT : answer->command.speed;
    }
    if (goes_on && !(answer->diagnostics.flags & DRAWBAR_SOLVER))
        run->unsolved = 0.0;
    run->stopped = answer->diagnostics.gate == DRAWBAR_GATE_STOPPED;
    run->last = answer->command;
    run->given = 1;
}

/* Another run is announced, which does not begin before the next sample. */
static void announce(struct run *run)
{
    run->begun = run->ended = 0;
    run->unsolved = run->overdue = run->counted = 0.0;
}

/* Hold an answer against all that is promised, and note it. */
static void promise(struct run *run, const struct answer *answer)
{
    const int status = answer->status;
    const struct drawbar_command *command = &answer->command;

    PROMISED(strcmp(drawbar_status_text(status), drawbar_status_text(-1)) != 0);
    promise_bounds(command);
    if (status >= DRAWBAR_FINISHED)
        PROMISED(command->speed == 0.0);
    if (status >= DRAWBAR_REFUSED && (run->begun || (run->given && !is_of_run(status))))
        promise_held(run, answer);
    else if (run->begun && !(status < DRAWBAR_REFUSED && status & DRAWBAR_RELEASED))
        promise_rates(run, command);
    if (status >= DRAWBAR_NULL)
        return;
    PROMISED(answer->diagnostics.status == (status < DRAWBAR_REFUSED ? DRAWBAR_OK : status));
    if (run->ended) {
        PROMISED(status == run->ended);
        return;
    }
    if (!run->begun) {
        run->speed = run->wanted;
        run->unsolved = 0.0;
    }
    promise_time(run, answer);
    note_sample(run, answer);
    promise_rate(run, answer);
    if (status < DRAWBAR_REFUSED)
        promise_new(run, answer);
    else if (status < DRAWBAR_FINISHED)
        promise_repeated(run, answer);
    note_answer(run, answer);
}

#endif

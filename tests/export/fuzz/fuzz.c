/* libFuzzer's target: a vehicle that the library drives along fuzzed paths, with fuzzed faults of its sensors, solvers,
 * clock and caller, and the promises held against every command. Prints at the end how many steps were made, by status. */
#include "mishaps.h"

#define MOST_STEPS 4096                    /* of one input */
#define MOST_STATUSES 512

static struct fuzz fuzz;
static struct drawbar_state before;
static long counts[MOST_STATUSES];        /* of steps */
static long changes;                      /* of paths in a run */

static void print_counts(void)
{
    long steps = 0;

    for (int i = 0; i < MOST_STATUSES; ++i)
        steps += counts[i];
    fprintf(stderr, "steps %ld\nchanges %ld\n", steps, changes);
    for (int i = 0; i < MOST_STATUSES; ++i)
        if (counts[i])
            fprintf(stderr, "status %d: %ld  %s\n", i, counts[i], drawbar_status_text(i));
}

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc;
    (void)argv;
    return atexit(print_counts);
}

static void check_answers(const struct fuzz *f, struct drawbar_diagnostics *diagnostics)
{
    struct drawbar_estimate estimate;

    PROMISED(drawbar_get_estimate(f->state, &estimate) == DRAWBAR_OK);
    PROMISED(drawbar_get_diagnostics(f->state, diagnostics) == DRAWBAR_OK);
    PROMISED(isfinite(estimate.time));
}

/* One sample: measure, ask, obey. */
static void ask(struct fuzz *f, int (*library)(struct drawbar_state *, const struct drawbar_measurement *,
                                               struct drawbar_command *))
{
    struct drawbar_measurement measurement;
    struct answer answer = {.absurd = measure(f, &measurement)};

    answer.time = measurement.time;
    solver_faults.happened = 0;
    answer.status = library(f->state, &measurement, &answer.command);
    answer.unsolved = solver_faults.happened && solver_faults.status != DRAWBAR_SOLVER_SOLVED;
    ++counts[answer.status % MOST_STATUSES];
    check_answers(f, &answer.diagnostics);
    promise(&f->run, &answer);
    vehicle_drive(&f->vehicle, &answer.command, f->sample_time);
}

static void remember(const struct fuzz *f)
{
    before = *f->state;
}

static void promise_nothing_changed(const struct fuzz *f)
{
    PROMISED(memcmp(&before, f->state, sizeof before) == 0);
}

/* The course's nodes on the heap. */
static struct drawbar_path_node *nodes_of(const struct course *course)
{
    const size_t size = (size_t)course->count * sizeof *course->nodes;

    return memcpy(malloc(size), course->nodes, size);
}

/* Take other nodes for the library's own, or leave it with those that it has. */
static void settle(struct fuzz *f, int taken, struct drawbar_path_node *nodes)
{
    if (!taken) {
        promise_nothing_changed(f);
        free(nodes);
        return;
    }
    free(f->nodes);
    f->nodes = nodes;
    f->count = f->course.count;
    f->length = nodes[f->count - 1].arc_length;
}

/* Let the run begin elsewhere: where the vehicle is, or anywhere. */
static void begin_at(struct fuzz *f, double arc_length)
{
    remember(f);
    const int status = drawbar_begin_at(f->state, arc_length);

    if (f->nodes == NULL)
        PROMISED(status == DRAWBAR_NO_PATH);
    else if (f->run.begun)
        PROMISED(status == DRAWBAR_ORDER);
    else
        PROMISED(status == (arc_length >= 0.0 && arc_length < f->length ? DRAWBAR_OK : DRAWBAR_RANGE));
    if (status != DRAWBAR_OK)
        promise_nothing_changed(f);
}

/* Another run; a table that is no path leaves the present one as it is. */
static void set_path(struct fuzz *f)
{
    const int choice = next_byte(&f->bytes), behind = choice < 128 ? 0 : choice % 64;

    course_make(&f->course, &f->vehicle, behind, 2.0, &f->bytes);
    struct drawbar_path_node *nodes = nodes_of(&f->course);
    remember(f);
    const int status = drawbar_set_path(f->state, nodes, f->course.count);
    PROMISED(status == DRAWBAR_OK || status == DRAWBAR_PATH);
    settle(f, status == DRAWBAR_OK, nodes);
    if (status != DRAWBAR_OK)
        return;
    announce(&f->run);
    if (behind)
        begin_at(f, PIECE * behind);
    if (choice % 32 == 1)
        begin_at(f, next_number(&f->bytes, f->length));
}

/* Another path, on which the run goes on. */
static void change_path(struct fuzz *f)
{
    const int choice = next_byte(&f->bytes), behind = choice % 64;
    const double at = choice < 224 ? PIECE * behind : next_number(&f->bytes, PIECE * NODES);

    course_make(&f->course, &f->vehicle, behind, 0.7, &f->bytes);
    struct drawbar_path_node *nodes = nodes_of(&f->course);
    remember(f);
    const int status = drawbar_change_path(f->state, nodes, f->course.count, at);
    PROMISED((status == DRAWBAR_NO_RUN) == (!f->run.begun || f->run.ended));
    PROMISED(status == DRAWBAR_OK || status == DRAWBAR_PATH || status == DRAWBAR_RANGE || status == DRAWBAR_ELSEWHERE
             || status == DRAWBAR_NO_RUN);
    changes += status == DRAWBAR_OK;
    settle(f, status == DRAWBAR_OK, nodes);
}

/* Another set speed, m/s. */
static void set_speed(struct fuzz *f)
{
    const int choice = next_byte(&f->bytes);
    const double speed = choice < 192 ? SPEED_LIMIT * (choice % 16) / 15.0 : next_number(&f->bytes, SPEED_LIMIT);

    remember(f);
    const int status = drawbar_set_speed(f->state, speed), allowed = speed >= 0.0 && speed <= SPEED_LIMIT;
    PROMISED(status == (allowed ? DRAWBAR_OK : DRAWBAR_RANGE));
    if (allowed)
        f->run.wanted = speed;
    else
        promise_nothing_changed(f);
}

/* Another line beside the path, m. */
static void set_offset(struct fuzz *f)
{
    const double offset = next_number(&f->bytes, next_byte(&f->bytes) < 192 ? 2.0 : 150.0);

    remember(f);
    const int status = drawbar_set_offset(f->state, offset);
    PROMISED(status == DRAWBAR_OK || status == (f->nodes ? DRAWBAR_RANGE : DRAWBAR_NO_PATH));
    if (status != DRAWBAR_OK)
        promise_nothing_changed(f);
}

/* Somebody else drives from now on, or the autopilot again. */
static void set_engaged(struct fuzz *f)
{
    f->run.released = next_choice(&f->bytes, 2);
    PROMISED(drawbar_set_engaged(f->state, !f->run.released) == DRAWBAR_OK);
}

/* Samples one after the other, few where the run has ended; then another one begins. */
static void drive(struct fuzz *f)
{
    if (f->run.ended || f->nodes == NULL)
        set_path(f);
    for (int steps = 1 + next_choice(&f->bytes, 64); steps > 0; steps -= f->run.ended ? 16 : 1)
        if (++f->steps <= MOST_STEPS)
            ask(f, drawbar_step);
}

/* What shows only after a while: drive on, if there is a run and until it ends. */
static void go_on(struct fuzz *f)
{
    for (int i = 0; i < 6 && f->run.begun && !f->run.ended; ++i)
        drive(f);
}

/* A wrong call says so and stops the vehicle. */
static void promise_refusal(struct fuzz *f, int status, int expected, const struct drawbar_command *command)
{
    struct drawbar_diagnostics diagnostics;

    PROMISED(status == expected);
    promise_bounds(command);
    PROMISED(command->speed == 0.0);
    check_answers(f, &diagnostics);
}

/* Numbers that are just beyond what is allowed, or none, are out of range wherever they are looked at. */
static void promise_ranges(struct fuzz *f)
{
    const int runs = f->run.begun && !f->run.ended, begins = f->nodes && !f->run.begun;
    const double speeds[] = {-1e-9, nextafter(SPEED_LIMIT, INFINITY), (double)NAN};
    const double places[] = {-1e-9, f->length, (double)NAN}, offsets[] = {-101.0, INFINITY, (double)NAN};

    for (int i = 0; i < 3; ++i) {
        PROMISED(drawbar_set_speed(f->state, speeds[i]) == DRAWBAR_RANGE);
        PROMISED(!f->nodes || drawbar_set_offset(f->state, offsets[i]) == DRAWBAR_RANGE);
        PROMISED(!begins || drawbar_begin_at(f->state, places[i]) == DRAWBAR_RANGE);
        PROMISED(!runs || drawbar_change_path(f->state, f->nodes, f->count, places[i]) == DRAWBAR_RANGE);
    }
}

/* Wrong calls change nothing. */
static void call_wrongly(struct fuzz *f)
{
    struct drawbar_measurement measurement = vehicle_measure(&f->vehicle);
    struct drawbar_command command;

    remember(f);
    PROMISED(drawbar_prepare(f->state) == DRAWBAR_ORDER);
    PROMISED(drawbar_feedback(f->state, &measurement, NULL) == DRAWBAR_NULL);
    PROMISED(drawbar_set_path(f->state, NULL, 3) == DRAWBAR_NULL);
    PROMISED(drawbar_set_path(f->state, f->course.nodes, -next_byte(&f->bytes)) == DRAWBAR_PATH);
    PROMISED(drawbar_change_path(f->state, NULL, 3, 0.0) == DRAWBAR_NULL);
    promise_ranges(f);
    PROMISED(drawbar_set_speed(NULL, 0.0) == DRAWBAR_NULL && drawbar_begin_at(NULL, 0.0) == DRAWBAR_NULL);
    promise_refusal(f, drawbar_feedback(f->state, NULL, &command), DRAWBAR_NULL, &command);
    promise_refusal(f, drawbar_feedback(NULL, &measurement, &command), DRAWBAR_NULL, &command);
    promise_nothing_changed(f);
}

/* The caller's other wishes, in any order. */
static void wish(struct fuzz *f)
{
    switch (next_choice(&f->bytes, 6)) {
    case 0: set_speed(f); break;
    case 1: begin_at(f, next_number(&f->bytes, f->length)); break;
    case 2: set_engaged(f); break;
    case 3: set_offset(f); break;
    default: change_path(f);
    }
}

/* Feedback and preparation apart, with something in between; feedback twice is wrong. */
static void call_apart(struct fuzz *f)
{
    struct drawbar_measurement measurement = vehicle_measure(&f->vehicle);
    struct drawbar_command again;

    if (f->nodes == NULL)
        return;
    ask(f, drawbar_feedback);
    promise_refusal(f, drawbar_feedback(f->state, &measurement, &again), DRAWBAR_ORDER, &again);
    if (next_choice(&f->bytes, 4) == 0)
        wish(f);
    PROMISED(drawbar_prepare(f->state) == DRAWBAR_OK);
}

/* As a vehicle is delivered. */
static void initialise(struct fuzz *f)
{
    repair(f);
    drawbar_init(f->state);
    free(f->nodes);
    f->nodes = NULL;
    f->run = (struct run){.wanted = SPEED_LIMIT};
    set_path(f);
}

static void act(struct fuzz *f)
{
    switch (next_choice(&f->bytes, 25)) {
    case 0: add_fault(f); break;
    case 1: replace(f); break;
    case 2: fail(f); break;
    case 3: be_late(f); break;
    case 4: repair(f); break;
    case 5: push(f); break;
    case 6: let_time_pass(f); break;
    case 7: call_wrongly(f); break;
    case 8: call_apart(f); break;
    case 9: set_path(f); break;
    case 10: initialise(f); break;
    case 11: f->noise_level = 2.0 + 2.0 * next_fraction(&f->bytes); break;
    case 12: wish(f); break;
    case 13: change_path(f); break;
    case 14: repair(f); break;
    case 15: lose_fixes(f); break;
    case 16: float_fixes(f), go_on(f); break;
    case 17: f->sway = next_fraction(&f->bytes), go_on(f); break;
    case 18: carry_away(f), go_on(f); break;
    case 19: f->is_askew = !f->is_askew, go_on(f); break;
    default: drive(f);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    memset(&fuzz, 0, sizeof fuzz);
    fuzz.bytes = (struct bytes){data, size};
    fuzz.vehicle.speed = SPEED_LIMIT;
    fuzz.state = malloc(sizeof *fuzz.state);
    initialise(&fuzz);
    while (fuzz.bytes.left)
        act(&fuzz);
    free(fuzz.nodes);
    free(fuzz.state);
    return 0;
}

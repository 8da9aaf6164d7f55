/* libFuzzer's target: a vehicle that the library drives along fuzzed paths, with fuzzed faults of its sensors, clock and
 * caller, and the promises held against every command. Prints at the end how many steps were made, by status. */
#include "bytes.h"
#include "course.h"
#include "promises.h"
#include "vehicle.h"

#define VALUES 9                           /* of a measurement */
#define MOST_STEPS 4096                    /* of one input */

struct fuzz {
    struct bytes bytes;
    struct vehicle vehicle;
    struct course course;
    struct drawbar_path_node *nodes;       /* of the run, on the heap, where the sanitizer sees their end */
    struct drawbar_state *state;           /* likewise */
    int ended;
    struct given last;
    double added[VALUES], replaced[VALUES];  /* faults of the sensors; replaced: NaN where it is not */
    int is_replaced[VALUES];
    uint32_t noise;
    double noise_level;
    int steps;
};

static struct fuzz fuzz;
static long counts[128];

static void print_counts(void)
{
    long steps = 0;

    for (int i = 0; i < 128; ++i)
        steps += counts[i];
    fprintf(stderr, "steps %ld\n", steps);
    for (int i = 0; i < 128; ++i)
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

/* Uniform in [-1, 1), reproducible. */
static double noise(struct fuzz *f)
{
    f->noise = f->noise * 1664525u + 1013904223u;
    return f->noise / 2147483648.0 - 1.0;
}

static void measure(struct fuzz *f, struct drawbar_measurement *measurement)
{
    static const double scale[VALUES] = {0.0, 0.03, 0.03, 0.03, 0.03, 0.02, 0.05, 0.02, 0.02};
    double values[VALUES];

    *measurement = vehicle_measure(&f->vehicle);
    memcpy(values, measurement, sizeof values);
    for (int i = 0; i < VALUES; ++i)
        values[i] = f->is_replaced[i] ? f->replaced[i] : values[i] + f->added[i] + f->noise_level * scale[i] * noise(f);
    memcpy(measurement, values, sizeof values);
}

static void check_answers(const struct fuzz *f)
{
    struct drawbar_estimate estimate;
    struct drawbar_diagnostics diagnostics;

    PROMISED(drawbar_get_estimate(f->state, &estimate) == DRAWBAR_OK);
    PROMISED(drawbar_get_diagnostics(f->state, &diagnostics) == DRAWBAR_OK);
    PROMISED(isfinite(estimate.time));
}

/* One sample: measure, step, obey. */
static void step(struct fuzz *f)
{
    struct drawbar_measurement measurement;
    struct drawbar_command command;

    if (++f->steps > MOST_STEPS)
        return;
    measure(f, &measurement);
    const int status = drawbar_step(f->state, &measurement, &command);
    ++counts[status & 127];
    promise(&f->last, status, &command);
    check_answers(f);
    f->ended = status >= DRAWBAR_FINISHED;
    vehicle_drive(&f->vehicle, &command, DRAWBAR_SAMPLE_TIME);
}

/* Another path; a table that is none leaves the run as it is. */
static void set_path(struct fuzz *f)
{
    struct drawbar_path_node *nodes;

    course_make(&f->course, &f->vehicle, &f->bytes);
    const size_t size = (size_t)f->course.count * sizeof *nodes;
    nodes = memcpy(malloc(size), f->course.nodes, size);
    if (drawbar_set_path(f->state, nodes, f->course.count) != DRAWBAR_OK) {
        free(nodes);
        return;
    }
    free(f->nodes);
    f->nodes = nodes;
    f->ended = f->last.known = 0;
}

static void drive(struct fuzz *f)
{
    if (f->ended)
        set_path(f);
    for (int steps = 1 + next_byte(&f->bytes) % 64; steps > 0; --steps)
        step(f);
}

static void repair(struct fuzz *f)
{
    memset(f->added, 0, sizeof f->added);
    memset(f->is_replaced, 0, sizeof f->is_replaced);
}

static void add_fault(struct fuzz *f)
{
    const int value = next_byte(&f->bytes) % VALUES;

    f->added[value] = pow(10.0, 3.0 * next_fraction(&f->bytes)) * next_fraction(&f->bytes);
}

/* A sensor stands still: on any number, or on none. */
static void replace(struct fuzz *f)
{
    const int value = next_byte(&f->bytes) % VALUES;

    f->is_replaced[value] = 1;
    f->replaced[value] = next_byte(&f->bytes) % 2 ? (double)NAN : next_double(&f->bytes);
}

/* A blow, or the driver turns the vehicle by hand. */
static void push(struct fuzz *f)
{
    f->vehicle.x += next_fraction(&f->bytes);
    f->vehicle.y += next_fraction(&f->bytes);
    f->vehicle.yaw += next_fraction(&f->bytes);
    f->vehicle.trailer_yaw += next_fraction(&f->bytes);
}

static void let_time_pass(struct fuzz *f)
{
    f->vehicle.time += 2.0 * next_fraction(&f->bytes);
}

/* A wrong call says so, changes nothing and stops the vehicle. */
static void promise_refusal(struct fuzz *f, int status, int expected, const struct drawbar_command *command)
{
    PROMISED(status == expected);
    promise_bounds(command);
    PROMISED(command->speed == 0.0);
    check_answers(f);
}

static void call_wrongly(struct fuzz *f)
{
    static struct drawbar_state before;
    struct drawbar_measurement measurement = vehicle_measure(&f->vehicle);
    struct drawbar_command command;

    before = *f->state;
    PROMISED(drawbar_prepare(f->state) == DRAWBAR_ORDER);
    PROMISED(drawbar_feedback(f->state, &measurement, NULL) == DRAWBAR_NULL);
    PROMISED(drawbar_set_path(f->state, NULL, 3) == DRAWBAR_NULL);
    PROMISED(drawbar_set_path(f->state, f->course.nodes, -next_byte(&f->bytes)) == DRAWBAR_PATH);
    promise_refusal(f, drawbar_feedback(f->state, NULL, &command), DRAWBAR_NULL, &command);
    promise_refusal(f, drawbar_feedback(NULL, &measurement, &command), DRAWBAR_NULL, &command);
    PROMISED(memcmp(&before, f->state, sizeof before) == 0);
}

/* Feedback and preparation apart, and feedback twice. */
static void call_apart(struct fuzz *f)
{
    struct drawbar_measurement measurement;
    struct drawbar_command command, again;

    measure(f, &measurement);
    const int status = drawbar_feedback(f->state, &measurement, &command);
    ++counts[status & 127];
    promise(&f->last, status, &command);
    if (status < DRAWBAR_NULL) {
        promise_refusal(f, drawbar_feedback(f->state, &measurement, &again), DRAWBAR_ORDER, &again);
        PROMISED(drawbar_prepare(f->state) == DRAWBAR_OK);
    }
    vehicle_drive(&f->vehicle, &command, DRAWBAR_SAMPLE_TIME);
}

/* As a vehicle is delivered. */
static void initialise(struct fuzz *f)
{
    repair(f);
    drawbar_init(f->state);
    f->ended = f->last.known = 0;
    set_path(f);
}

static void act(struct fuzz *f)
{
    switch (next_byte(&f->bytes) % 12) {
    case 0: add_fault(f); break;
    case 1: replace(f); break;
    case 2: repair(f); break;
    case 3: push(f); break;
    case 4: let_time_pass(f); break;
    case 5: call_wrongly(f); break;
    case 6: call_apart(f); break;
    case 7: set_path(f); break;
    case 8: initialise(f); break;
    case 9: f->noise_level = 2.0 + 2.0 * next_fraction(&f->bytes); break;
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

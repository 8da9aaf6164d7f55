/* The low level under fuzzed settings, moments and faults, against the promises of drawbar_actuate.h.
 *
 * libFuzzer's target where there is one; with RANDOM defined a program of its own that feeds so many random inputs, for
 * compilers without libFuzzer and for counting instructions. Prints at its end how many calls were made, by status. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "drawbar_actuate.h"

#define PROMISED(what) ((what) ? (void)0 : broken(#what, __LINE__))
#define MOST_CALLS 200
#define STATUSES 128

struct bytes {
    const uint8_t *at;
    size_t left;
};

static long counts[STATUSES];

static void broken(const char *what, int line)
{
    fprintf(stderr, "broken promise: %s (line %d)\n", what, line);
    abort();
}

static int next_byte(struct bytes *b)
{
    if (b->left == 0)
        return 0;
    --b->left;
    return *b->at++;
}

/* Mostly a number of a sensible size; sometimes any double there is. */
static double next_number(struct bytes *b, double scale)
{
    const int choice = next_byte(b);
    double any = 0.0;

    if (choice < 250)
        return scale * (next_byte(b) - 128) / 100.0;
    uint8_t raw[sizeof any];
    for (size_t i = 0; i < sizeof raw; ++i)
        raw[i] = (uint8_t)next_byte(b);
    memcpy(&any, raw, sizeof any);
    return choice == 250 ? (double)NAN : choice == 251 ? (double)INFINITY : any;
}

static double next_positive(struct bytes *b, double scale)
{
    return fabs(next_number(b, scale)) + 0.001 * scale;
}

static struct drawbar_sensor next_sensor(struct bytes *b)
{
    struct drawbar_sensor sensor = {.lowest = -200.0, .highest = 200.0, .points = next_byte(b) % 18};
    double counts_at = -180.0, value = -1.0;

    for (int i = 0; i < DRAWBAR_TABLE_POINTS; ++i) {
        sensor.counts[i] = counts_at;
        sensor.values[i] = value;
        counts_at += 1.0 + next_byte(b) / 5.0;
        value += next_byte(b) / 1000.0;
    }
    sensor.cubic[0] = next_number(b, 0.1);
    sensor.cubic[1] = next_number(b, 0.01);
    if (next_byte(b) < 32) {
        sensor.cubic[2] = next_number(b, 1e-5);
        sensor.cubic[3] = next_number(b, 1e-8);
    }
    return sensor;
}

static struct drawbar_position_loop next_loop(struct bytes *b)
{
    struct drawbar_position_loop loop;

    loop.proportional = next_positive(b, 5.0);
    loop.integral = next_byte(b) < 64 ? next_positive(b, 1.0) : 0.0;
    loop.integral_limit = next_byte(b) / 255.0;
    loop.stop_zone = next_byte(b) / 20000.0;
    loop.limit = next_positive(b, 1.0);
    loop.compensation = next_byte(b) / 255.0;
    loop.drive_limit = (1 + next_byte(b)) / 256.0;
    for (int side = 0; side < 2; ++side) {
        loop.dead_band[side] = loop.drive_limit * next_byte(b) / 256.0;
        loop.full_rate[side] = next_positive(b, 0.5);
    }
    return loop;
}

static struct drawbar_actuate_settings next_settings(struct bytes *b)
{
    struct drawbar_actuate_settings settings;

    memset(&settings, 0, sizeof settings);
    for (int i = 0; i < DRAWBAR_ACTUATORS; ++i) {
        settings.sensors[i] = next_sensor(b);
        settings.loops[i] = next_loop(b);
        settings.present[i] = next_byte(b) % 8 != 0;
    }
    settings.speed = (struct drawbar_speed_loop){
        next_positive(b, 1.0), next_positive(b, 1.0), next_positive(b, 3.0), next_positive(b, 1.0), next_positive(b, 1.0),
        next_positive(b, 2.0), (1 + next_byte(b)) / 256.0, (1 + next_byte(b)) / 256.0, next_positive(b, 1.0)};
    settings.longest_period = 0.1;
    settings.standstill = 0.05;
    settings.standing_time = next_byte(b) / 100.0;
    return settings;
}

static struct drawbar_actuate_input next_input(struct bytes *b, const struct drawbar_actuate_input *last)
{
    struct drawbar_actuate_input input = *last;

    input.time += next_byte(b) < 250 ? 0.02 : next_number(b, 0.1);
    for (int i = 0; i < DRAWBAR_ACTUATORS; ++i)
        input.counts[i] = next_byte(b) < 250 ? next_number(b, 150.0) : next_number(b, 1e300);
    for (int i = 0; i < 2; ++i) {
        input.steering[i] = next_number(b, 0.4);
        input.steer[i] = next_byte(b) < 240;
    }
    input.drive = next_byte(b) < 240;
    input.speed = fabs(next_number(b, 1.0));
    input.measured_speed = next_number(b, 1.0);
    return input;
}

static void promise_output(const struct drawbar_actuate_settings *settings, const struct drawbar_actuate_input *input,
                           const struct drawbar_actuate_output *output, int status)
{
    int worst = DRAWBAR_ACTUATE_FINE;

    for (int i = 0; i < DRAWBAR_ACTUATORS; ++i) {
        const int own = output->statuses[i], pedal = i == DRAWBAR_ACTUATOR_PEDAL;
        const int wanted = pedal ? input->drive : input->steer[i];
        ++counts[own % STATUSES];
        PROMISED(isfinite(output->drives[i]) && fabs(output->drives[i]) <= settings->loops[i].drive_limit);
        if (!settings->present[i]) {
            PROMISED(output->drives[i] == 0.0 && own == DRAWBAR_ACTUATE_OFF);
            continue;
        }
        worst = own > worst ? own : worst;
        PROMISED((own == DRAWBAR_ACTUATE_OFF) == !wanted);
        if (own != DRAWBAR_ACTUATE_FINE && !(pedal && own >= DRAWBAR_ACTUATE_FAULT))
            PROMISED(output->drives[i] == 0.0);
        if (isnan(output->positions[i]))
            PROMISED(output->drives[i] == 0.0);
        if (pedal && own >= DRAWBAR_ACTUATE_FAULT)
            PROMISED(output->pedal == 0.0);
        if (own == DRAWBAR_ACTUATE_FINE && !pedal) {
            const double error = input->steering[i] - output->positions[i];
            PROMISED(fabs(input->steering[i]) <= settings->loops[i].limit);
            if (settings->loops[i].integral == 0.0)
                PROMISED(output->drives[i] * error >= 0.0);
            if (fabs(error) <= settings->loops[i].stop_zone)
                PROMISED(output->drives[i] == 0.0);
        }
    }
    PROMISED(output->pedal >= 0.0 && output->pedal <= (settings->present[DRAWBAR_ACTUATOR_PEDAL]
                                                       ? settings->speed.full_pedal : 0.0));
    PROMISED(status == worst);
}

/* A fault stays until the caller has released. */
static void promise_latched(const struct drawbar_actuate_output *before, const struct drawbar_actuate_output *after)
{
    for (int i = 0; i < DRAWBAR_ACTUATORS; ++i)
        if (before->statuses[i] >= DRAWBAR_ACTUATE_FAULT)
            PROMISED(after->statuses[i] == before->statuses[i] || after->statuses[i] == DRAWBAR_ACTUATE_OFF);
}

static void wrong_calls(struct drawbar_actuate_state *state, const struct drawbar_actuate_input *input)
{
    struct drawbar_actuate_output output;

    PROMISED(drawbar_actuate(state, input, NULL) == DRAWBAR_ACTUATE_NULL);
    PROMISED(drawbar_actuate(NULL, input, &output) == DRAWBAR_ACTUATE_NULL);
    for (int i = 0; i < DRAWBAR_ACTUATORS; ++i)
        PROMISED(output.drives[i] == 0.0);
    PROMISED(drawbar_actuate(state, NULL, &output) == DRAWBAR_ACTUATE_NULL);
    PROMISED(drawbar_actuate_init(NULL, NULL) == DRAWBAR_ACTUATE_NULL);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct bytes bytes = {data, size};
    struct drawbar_actuate_state *state = malloc(sizeof *state);   /* on the heap, where the sanitizer sees its end */
    const struct drawbar_actuate_settings settings = next_settings(&bytes);
    struct drawbar_actuate_input input;
    struct drawbar_actuate_output output, before;
    const int begun = drawbar_actuate_init(state, &settings);

    memset(&input, 0, sizeof input);
    memset(&before, 0, sizeof before);
    PROMISED(begun == DRAWBAR_ACTUATE_FINE || begun == DRAWBAR_ACTUATE_SETTINGS);
    wrong_calls(state, &input);
    for (int i = 0; i < MOST_CALLS && bytes.left > 0; ++i) {
        input = next_input(&bytes, &input);
        memset(&output, 0xFF, sizeof output);
        const int status = drawbar_actuate(state, &input, &output);
        if (begun != DRAWBAR_ACTUATE_FINE) {
            PROMISED(status == DRAWBAR_ACTUATE_NOT_INITIALISED && output.drives[0] == 0.0 && output.drives[1] == 0.0
                     && output.drives[2] == 0.0);
            ++counts[status];
            continue;
        }
        promise_output(&settings, &input, &output, status);
        promise_latched(&before, &output);
        before = output;
        if (!isfinite(input.time))
            input.time = 0.0;
    }
    free(state);
    return 0;
}

static void print_counts(void)
{
    for (int i = 0; i < STATUSES; ++i)
        if (counts[i])
            fprintf(stderr, "status %d: %ld  %s\n", i, counts[i], drawbar_actuate_status_text(i));
}

#ifdef RANDOM
int main(int argc, char **argv)
{
    uint32_t random = 1;

    for (long input = argc > 1 ? atol(argv[1]) : 100; input > 0; --input) {
        static uint8_t data[4096];
        for (size_t i = 0; i < sizeof data; ++i) {
            random = random * 1664525u + 1013904223u;
            data[i] = (uint8_t)(random >> 24);
        }
        LLVMFuzzerTestOneInput(data, sizeof data);
    }
    print_counts();
    return 0;
}
#else
int LLVMFuzzerInitialize(int *argc, char ***argv);

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    (void)argc;
    (void)argv;
    return atexit(print_counts);
}
#endif

/* Fuzzed vehicle: what the target knows of a run, and what its faulty sensors report. */
#ifndef FUZZ_FUZZED_H
#define FUZZ_FUZZED_H

#include <stddef.h>
#include "bytes.h"
#include "course.h"
#include "promises.h"
#include "vehicle.h"

#define FIRST offsetof(struct drawbar_measurement, tractor_x)
#define VALUE(name) (1 + (offsetof(struct drawbar_measurement, name) - FIRST) / sizeof(double))  /* time is the first */
#define VALUES VALUE(tractor_fix_quality)
#define USUAL 9                            /* values that every machine has */
#define SWAY_RATE 1.0                      /* rad/s */

struct fuzz {
    struct bytes bytes;
    struct vehicle vehicle;
    struct course course;
    struct drawbar_path_node *nodes;       /* of the run, on the heap, where the sanitizer sees their end; or NULL */
    int32_t count;                         /* of them */
    double length;                         /* of their path, m */
    struct drawbar_state *state;           /* likewise */
    struct run run;
    double added[VALUES], replaced[VALUES];  /* faults of the sensors; replaced: NaN where it is not */
    int is_replaced[VALUES];
    int32_t qualities[2];
    uint32_t noise;
    double noise_level;
    double sway;                           /* by which fixes go from side to side, m */
    int is_askew;                          /* the tractor's roll sensor is mounted the wrong way round */
    double sample_time;                    /* the caller's, s */
    int steps;
};

/* Uniform in [-1, 1), reproducible. */
static double noise(struct fuzz *f)
{
    f->noise = f->noise * 1664525u + 1013904223u;
    return f->noise / 2147483648.0 - 1.0;
}

/* What the sensors report; returns whether a value is infinite. */
static int measure(struct fuzz *f, struct drawbar_measurement *measurement)
{
    static const double scale[VALUES] = {0.0, 0.03, 0.03, 0.03, 0.03, 0.02, 0.05, 0.02, 0.02};
    double values[VALUES] = {0.0};         /* the first: of the fault alone */
    char *numbers = (char *)measurement + FIRST;
    int infinite = 0;

    *measurement = vehicle_measure(&f->vehicle);
    memcpy(values + 1, numbers, sizeof values - sizeof *values);
    for (size_t i = 0; i < VALUES; ++i) {
        values[i] = f->is_replaced[i] ? f->replaced[i] : values[i] + f->added[i] + f->noise_level * scale[i] * noise(f);
        infinite |= i > 0 && isinf(values[i]);
    }
    for (int i = 1; i <= 4; ++i)
        values[i] += f->sway * sin(SWAY_RATE * f->vehicle.time);
    measurement->time = f->is_replaced[0] ? values[0] : measurement->time + values[0];
    memcpy(numbers, values + 1, sizeof values - sizeof *values);
    measurement->tractor_roll *= f->is_askew ? -1.0 : 1.0;
    measurement->tractor_fix_quality = f->qualities[0];
    measurement->trailer_fix_quality = f->qualities[1];
    return infinite;
}

#endif

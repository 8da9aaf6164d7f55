/* Mishaps: faults of sensors, solvers and clock, and what may happen to a vehicle; each takes its numbers from the input. */
#ifndef FUZZ_MISHAPS_H
#define FUZZ_MISHAPS_H

#include "fuzzed.h"
#include "solvers.h"

static void repair(struct fuzz *f)
{
    memset(f->added, 0, sizeof f->added);
    memset(f->is_replaced, 0, sizeof f->is_replaced);
    memset(f->qualities, 0, sizeof f->qualities);
    memset(&solver_faults, 0, sizeof solver_faults);
    f->sway = 0.0;
    f->is_askew = 0;
    f->sample_time = DRAWBAR_SAMPLE_TIME;
}

/* One of the measured values, mostly of those that every machine has. */
static int next_value(struct bytes *b)
{
    const int choice = next_byte(b);

    return choice % (choice < 192 ? USUAL : (int)VALUES);
}

static void add_fault(struct fuzz *f)
{
    const int value = next_value(&f->bytes);

    f->added[value] = pow(10.0, 3.0 * next_fraction(&f->bytes)) * next_fraction(&f->bytes);
}

/* A sensor stands still: on any number, or on none. */
static void replace(struct fuzz *f)
{
    const int value = next_value(&f->bytes);

    f->is_replaced[value] = 1;
    f->replaced[value] = next_byte(&f->bytes) % 2 ? (double)NAN : next_double(&f->bytes);
    f->qualities[value % 2] = (int32_t)(next_byte(&f->bytes) - 128) * (value < USUAL ? 1 : 1 << 24);
}

/* Both receivers are shaded. */
static void lose_fixes(struct fuzz *f)
{
    for (int i = 1; i <= 4; ++i) {
        f->is_replaced[i] = 1;
        f->replaced[i] = (double)NAN;
    }
}

/* Both receivers fall back to float, and say so. */
static void float_fixes(struct fuzz *f)
{
    static const size_t deviations[] = {VALUE(tractor_fix_deviation), VALUE(trailer_fix_deviation)};

    for (int i = 0; i < 2; ++i) {
        f->is_replaced[deviations[i]] = 1;
        f->replaced[deviations[i]] = 0.3;
    }
}

/* Solvers fail from now on. */
static void fail(struct fuzz *f)
{
    const int choice = next_byte(&f->bytes);

    solver_faults.which = 1 + choice % 7;
    solver_faults.status = 1 + choice % 5;
    solver_faults.spoilt = choice >= 192;
    solver_faults.steering = choice % 2 ? (double)NAN : next_double(&f->bytes);
}

/* A caller who is always late, or early. */
static void be_late(struct fuzz *f)
{
    f->sample_time = DRAWBAR_SAMPLE_TIME * (1.0 + next_choice(&f->bytes, 64)) / 10.0;
}

/* A blow, or the driver turns the vehicle by hand. */
static void push(struct fuzz *f)
{
    f->vehicle.x += 2.0 * next_fraction(&f->bytes);
    f->vehicle.y += 2.0 * next_fraction(&f->bytes);
    f->vehicle.yaw += next_fraction(&f->bytes);
    f->vehicle.trailer_yaw += next_fraction(&f->bytes);
}

/* Somebody carries the vehicle, as it stands, to another place. */
static void carry_away(struct fuzz *f)
{
    f->vehicle.x += 20.0 * next_fraction(&f->bytes);
    f->vehicle.y += 20.0 * next_fraction(&f->bytes);
}

static void let_time_pass(struct fuzz *f)
{
    f->vehicle.time += 2.0 * next_fraction(&f->bytes);
}

#endif

/* Seeded random numbers, and how to spoil them (xorshift64*, Vigna 2014). */
#ifndef DRAWBAR_TEST_RANDOM_H
#define DRAWBAR_TEST_RANDOM_H

#include <math.h>
#include <stdint.h>

static uint64_t random_state = 88172645463325252u;

static uint64_t random_bits(void)
{
    random_state ^= random_state >> 12;
    random_state ^= random_state << 25;
    random_state ^= random_state >> 27;
    return (random_state * 2685821657736338717u) >> 11;
}

static int pick(int count)
{
    return (int)(random_bits() % (uint64_t)count);
}

static int one_in(int count)
{
    return pick(count) == 0;
}

/* In -1 .. 1. */
static double uniform(void)
{
    return (double)random_bits() / 4503599627370496.0 - 1.0;
}

static double magnitude(double largest)
{
    return 1e-6 + fabs(uniform()) * largest;
}

static void numbers(double *to, int count, double spread)
{
    for (int i = 0; i < count; ++i)
        to[i] = uniform() * spread;
}

/* Spoil about one of `count` numbers, every other time none. */
static void disturb(double *number, int count)
{
    static const double extremes[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300, 1e-300, 5e-324, 0.0, -0.0, 1e16, -1.0};
    if (one_in(2 * count))
        *number = extremes[pick((int)(sizeof extremes / sizeof extremes[0]))];
}

static void fail(const char *what, int status)
{
    printf("%s (status %d)\n", what, status);
    exit(1);
}

/* At the last call: how often each status came. */
static void tell(const int *counts, int kinds)
{
    int total = 0;
    for (int i = 0; i < kinds; ++i)
        total += counts[i];
    for (int i = 0; total == CALLS && i < kinds; ++i)
        printf("%d%s", counts[i], i + 1 < kinds ? " " : "\n");
}

#endif

/* A fuzzer's bytes as numbers; at their end all are zero. */
#ifndef BYTES_H
#define BYTES_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

struct bytes {
    const uint8_t *next;
    size_t left;
};

static inline int next_byte(struct bytes *b)
{
    if (b->left == 0)
        return 0;
    --b->left;
    return *b->next++;
}

/* A number in [-1, 1). */
static inline double next_fraction(struct bytes *b)
{
    return next_byte(b) / 128.0 - 1.0;
}

/* 0 to `count` - 1. */
static inline int next_choice(struct bytes *b, int count)
{
    return next_byte(b) % count;
}

/* Any number at all: NaN, infinite, subnormal. */
static inline double next_double(struct bytes *b)
{
    uint8_t raw[sizeof(double)];
    double value;

    for (size_t i = 0; i < sizeof raw; ++i)
        raw[i] = (uint8_t)next_byte(b);
    memcpy(&value, raw, sizeof value);
    return value;
}

/* A number around what is allowed from 0 to `most`, or any at all. */
static inline double next_number(struct bytes *b, double most)
{
    return next_byte(b) % 2 ? next_double(b) : 2.0 * most * next_fraction(b);
}

#endif

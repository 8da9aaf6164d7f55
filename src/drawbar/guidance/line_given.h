/* Given pointers and coordinates of the functions of drawbar_line.h: which are refused. */
#ifndef DRAWBAR_LINE_GIVEN_H
#define DRAWBAR_LINE_GIVEN_H

#include <stddef.h>
#include "drawbar_line.h"

#define LINE_FARTHEST 1e7                  /* largest coordinate, m: PATH_FARTHEST */

struct line_given {
    const void *pointer;
    size_t alignment;
};

struct placed_line_number {
    char before;
    double number;
};

struct placed_line_row {                   /* of doubles in single precision, too */
    char before;
    struct drawbar_line_row row;
};

struct placed_line_count {
    char before;
    int32_t count;
};

/* Arrays and structures of numbers, rows to work in, a single whole number. */
#define LINE_NUMBERS(pointer) {(pointer), offsetof(struct placed_line_number, number)}
#define LINE_ROWS(pointer) {(pointer), offsetof(struct placed_line_row, row)}
#define LINE_COUNT(pointer) {(pointer), offsetof(struct placed_line_count, count)}

/* What is wrong with pointers, or 0. Some processors cannot even read numbers that are not aligned. */
static inline int line_refused(const struct line_given *given, int count)
{
    int refused = 0;

    for (int i = 0; i < count; ++i) {
        if (given[i].pointer == NULL)
            return DRAWBAR_LINE_NULL;
        if ((uintptr_t)given[i].pointer % given[i].alignment != 0)
            refused = DRAWBAR_LINE_UNALIGNED;
    }
    return refused;
}

#endif

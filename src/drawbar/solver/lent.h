/* Lent: what solvers share for the length of a call. */
#ifndef DRAWBAR_LENT_H
#define DRAWBAR_LENT_H

#include <stdint.h>

struct lent {
    void *memory;                          /* for the methods for bounds, see bounds_work.h */
    int32_t iterations;                    /* of interior points, that are left to all who share them */
};

#endif

/* Solver resources: what the solvers of one step share. Each has the memory to itself for the length of its call. */
#ifndef DRAWBAR_SOLVER_RESOURCES_H
#define DRAWBAR_SOLVER_RESOURCES_H

#include <stdint.h>

struct solver_resources {
    void *work;                            /* scratch memory, see bounds_work.h */
    int32_t iterations;                    /* of the interior point, left to all solvers of the step */
};

#endif

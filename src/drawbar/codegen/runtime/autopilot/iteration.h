/* A controller's solver from sample to sample: started anew where it must be, and judged. */
#ifndef DRAWBAR_ITERATION_H
#define DRAWBAR_ITERATION_H

#include "rti.h"

#define TORN 0.5                           /* gap in a plan, m or rad, from which on a full step cannot be believed */

struct iteration {
    int32_t usable;                        /* the last plan can be gone on from */
    int32_t torn;                          /* the last plan's intervals did not nearly meet */
};

/* Linearise along a first guess, made of what was filled in; the including unit defines it. */
static void guess(struct rti *solver);

/* Solve for the data that the solver holds, from the last plan or, where that is none, from the guess. */
static int iteration_feedback(struct iteration *iteration, struct rti *solver)
{
    if (!iteration->usable)
        guess(solver);
    const int status = rti_feedback(solver);
    iteration->usable = status == SOLVED;
    return iteration->torn ? CHECK_FAILED : status;
}

/* Shift the plan by one sample and linearise along it. A plan whose intervals do not nearly meet is none: the next one
 * starts afresh, and says so in its status. */
static void iteration_prepare(struct iteration *iteration, struct rti *solver)
{
    const double *gaps = &solver->qp.c[0][0];

    rti_shift(solver);
    rti_prepare(solver);
    iteration->torn = 0;
    for (int i = 0; i < N * NX; ++i)
        iteration->torn |= !(fabs(gaps[i]) <= TORN);
    iteration->usable &= !iteration->torn;
}

#endif

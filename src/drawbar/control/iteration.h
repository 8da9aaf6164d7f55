/* Iteration of a controller's solver from sample to sample: started anew where it must be, and judged. Around the
 * solver's phases:
 *
 *     feedback: iteration_enter, rti_feedback, iteration_leave; preparation: iteration_ready
 */
#ifndef DRAWBAR_ITERATION_H
#define DRAWBAR_ITERATION_H

#include "rti.h"
#include "unit.h"

#define TORN 0.5                           /* gap in a plan, m or rad, beyond which a full step is not valid */

struct iteration {
    int32_t usable;                        /* the last plan can be gone on from */
    int32_t torn;                          /* the last plan's intervals did not nearly meet */
};

/* Linearise along a first guess, made of what was filled in; the including unit defines it. */
static void guess(struct rti *solver);

/* What the first state of the problem is given as, or shall be where it is free. */
static inline double *iteration_begin(struct rti *solver)
{
    return FREE_INITIAL ? solver->prior : solver->initial;
}

/* Linearise along a trajectory that rests at the first state under zero input. */
static inline void iteration_rest(struct rti *solver)
{
    for (int k = 0; k <= N; ++k)
        memcpy(STATE(solver->z, k), iteration_begin(solver), NX * sizeof(double));
    memset(INPUT(solver->z, 0), 0, N * NU * sizeof(double));
    rti_prepare(solver);
}

/* Go on from the last plan or, where that is none, from the guess. */
static inline void iteration_enter(const struct iteration *iteration, struct rti *solver)
{
    if (!iteration->usable) {
        memset(solver->qp.kept, 0, sizeof solver->qp.kept);
        guess(solver);
    }
}

/* Return what has become of the new plan. */
static inline int iteration_leave(struct iteration *iteration, const struct rti *solver)
{
    iteration->usable = solver->status == SOLVED;
    return iteration->torn ? CHECK_FAILED : solver->status;
}

/* Shift the plan by one sample and linearise along it. One whose intervals do not nearly meet is none: the next one
 * starts afresh, and says so in its status. */
static inline int iteration_ready(struct iteration *iteration, struct rti *solver)
{
    const double *gaps = &solver->qp.c[0][0];

    WATCHED(WATCHED_SHIFT, rti_shift(solver));
    WATCHED(WATCHED_PREPARE, rti_prepare(solver));
    iteration->torn = 0;
    for (int i = 0; i < N * NX; ++i)
        iteration->torn |= !(fabs(gaps[i]) <= TORN);
    iteration->usable &= !iteration->torn;
    return SOLVED;
}

/* Where the model gets by the first sample's state, input and parameters: F(x_0, u_0, p_0), NX values. Between feedback
 * and the shift only: it takes the place of the first interval's linearisation. */
static inline const double *iteration_successor(struct rti *solver)
{
    dynamics(solver, 0, 1);
    return solver->qp.c[0];
}

#endif

/* Iteration of a controller's solver from sample to sample: restarted where its last plan cannot be used, and judged. Around the
 * solver's phases:
 *
 *     feedback: iteration_enter, rti_feedback, iteration_leave; preparation: iteration_ready
 */
#ifndef DRAWBAR_ITERATION_H
#define DRAWBAR_ITERATION_H

#include "rti.h"
#include "unit.h"

#define LARGEST_GAP 0.5                    /* between intervals of a plan, m or rad, for a full step to be valid */

struct iteration {
    int32_t usable;                        /* the last plan can be continued */
    int32_t discontinuous;                 /* the last plan has a gap larger than LARGEST_GAP */
};

/* Linearise along a first guess, made of what was filled in; the including unit defines it. */
static void guess(struct rti *solver);

/* The given first state of the problem, or its reference where it is free. */
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

/* Continue from the last plan or, without one, from the guess. */
static inline void iteration_enter(const struct iteration *iteration, struct rti *solver)
{
    if (!iteration->usable) {
        memset(solver->qp.kept, 0, sizeof solver->qp.kept);
        guess(solver);
    }
}

/* Return the status of the new plan. */
static inline int iteration_leave(struct iteration *iteration, const struct rti *solver)
{
    iteration->usable = solver->status == SOLVED;
    return iteration->discontinuous ? CHECK_FAILED : solver->status;
}

/* Shift the plan by one sample and linearise along it. A discontinuous one is discarded: the next one restarts,
 * with that in its status. */
static inline int iteration_ready(struct iteration *iteration, struct rti *solver)
{
    const double *gaps = &solver->qp.c[0][0];

    WATCHED(WATCHED_SHIFT, rti_shift(solver));
    WATCHED(WATCHED_PREPARE, rti_prepare(solver));
    iteration->discontinuous = 0;
    for (int i = 0; i < N * NX; ++i)
        iteration->discontinuous |= !(fabs(gaps[i]) <= LARGEST_GAP);
    iteration->usable &= !iteration->discontinuous;
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

/* Status of a solver's call.
 *
 * Generated from signals/ and statuses.py by `python -m drawbar.signals.c_headers`; change them there. */
#ifndef DRAWBAR_STATUS_H
#define DRAWBAR_STATUS_H

/* Outcome of a solver call; the C runtime returns the same numbers. */
enum qp_status {
    SOLVED = 0,
    MAXIMUM_ITERATIONS = 1,
    INFEASIBLE = 2,
    NOT_FINITE = 3,
    CHECK_FAILED = 4,
    BAD_INPUT = 5
};

#endif

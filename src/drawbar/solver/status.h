/* How a phase of a solver ended; signals.py has the same ones. */
#ifndef DRAWBAR_STATUS_H
#define DRAWBAR_STATUS_H

enum qp_status { SOLVED, MAXIMUM_ITERATIONS, INFEASIBLE, NOT_FINITE, CHECK_FAILED, BAD_INPUT };

#endif

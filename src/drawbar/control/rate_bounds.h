/* Rate bounds of planned steerings: the share of an actuator's rate that the tube leaves to plans, of the
 * identified rate. */
#ifndef DRAWBAR_RATE_BOUNDS_H
#define DRAWBAR_RATE_BOUNDS_H

#include "rti.h"

/* Bound an input, a steering rate, by a rate, rad/s; it counts from the next preparation on. */
static inline void bound_rate(struct rti *solver, int input, double rate)
{
    for (int i = 0; i < NB; ++i) {
        const int at = solver->qp.bound[i] - (N + 1) * NX;
        if (at >= 0 && at % NU == input) {
            solver->lower[i] = -rate;
            solver->upper[i] = rate;
        }
    }
}

#endif

/* Kalman update: a state and its covariance corrected by one number that was measured. */
#ifndef DRAWBAR_KALMAN_UPDATE_H
#define DRAWBAR_KALMAN_UPDATE_H

#include "noinline.h"

/* Correct a state (n) and its covariance (n x n), in place. cross: the state's covariance with the number (n); variance: of the
 * innovation, the number's noise included. */
static COLD void kalman_update(int n, double *state, double *covariance, const double *cross, double variance,
                               double innovation)
{
    for (int i = 0; i < n; ++i) {
        state[i] += cross[i] / variance * innovation;
        for (int j = 0; j < n; ++j)
            covariance[i * n + j] -= cross[i] * cross[j] / variance;
    }
}

#endif

/* Rate weight of the tractor's steering: less the faster the vehicle is, as a metre then leaves less time to steer. */
#ifndef DRAWBAR_RATE_WEIGHT_H
#define DRAWBAR_RATE_WEIGHT_H

#include "rti.h"

/* Weigh an output, the steering rate, by its weight up to 1 m/s and by the speed (m/s). Changes below a tenth are
 * ignored, as each costs a new factorisation. */
static inline void weigh_rate(struct rti *solver, int output, double rate_weight, double speed)
{
    const double weight = rate_weight / fmax(speed, 1.0);

    if (fabs(weight - solver->w[0][output]) <= 0.1 * weight)
        return;
    for (int k = 0; k < N; ++k)
        solver->w[k][output] = weight;
    rti_reweighted(solver);
}

#endif

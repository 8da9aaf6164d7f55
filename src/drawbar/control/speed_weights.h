/* Weights of the tractor's cost that follow its speed: a metre leaves less time to steer, the faster it is driven.
 *
 * The weight on the steering rate falls with the speed. The weight on the heading sets the length within which an offset is taken
 * back, sqrt(heading / lateral): it is raised until that is no less than what the vehicle drives while a command waits for dead
 * time and lag. A return that is quicker than its actuators lives on their exact prediction, and swings where something else is
 * late that nobody tells.
 */
#ifndef DRAWBAR_SPEED_WEIGHTS_H
#define DRAWBAR_SPEED_WEIGHTS_H

#include "rti.h"

struct speed_weights {
    double rate;                           /* on the steering rate up to 1 m/s */
    double lateral, heading;               /* as stated */
    double delay;                          /* dead time and lag of the front wheels, as far as they are identified, s */
};

#define SPEED_WEIGHTS_FIELDS(place)                                                                         \
    SETTING(component, place.rate, 0, 1, 0, 0) SETTING(component, place.lateral, 0, 1, 0, 0)                \
    SETTING(component, place.heading, 0, 1, 0, 0)

/* Weigh an output of so many stages. Changes below a tenth are not worth a new factorisation. */
static inline void weigh(struct rti *solver, int output, int stages, double weight)
{
    if (fabs(weight - solver->w[0][output]) <= 0.1 * weight)
        return;
    for (int k = 0; k < stages; ++k)
        solver->w[k][output] = weight;
    rti_reweighted(solver);
}

/* Let the weights on both outputs follow the speed, m/s. */
static inline void weigh_by_speed(struct rti *solver, const struct speed_weights *weights, int steering_rate, int heading,
                                  double speed)
{
    const double waits = speed * weights->delay;

    weigh(solver, steering_rate, N, weights->rate / fmax(speed, 1.0));
    weigh(solver, heading, N + 1, fmax(weights->heading, weights->lateral * waits * waits));
}

#endif

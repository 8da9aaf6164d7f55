/* Estimation on the paper's model (vehicle/tricycle.py): from measurements to its states and outputs, and from its
 * states to an estimate.
 *
 * State: x_t, y_t, theta, x_i, y_i, psi; then the parameters mu, kappa, eta, beta, v. Outputs: the measured quantities;
 * both steering angles are the inputs.
 */
#ifndef DRAWBAR_TRICYCLE_ESTIMATION_H
#define DRAWBAR_TRICYCLE_ESTIMATION_H

#include <string.h>
#include "at_rest.h"

#define STEERING_RATES 0                   /* no output is told by a command: the inputs are measured */
#define TRACTOR_YAW 2
#define TRAILER_YAW 5

struct estimation_model {
    struct chain chain;
    double first_slip;                     /* first guess of mu, kappa and eta */
    double first_yaw_error;                /* added to the first guess of both yaws, rad */
    double steering[2];                    /* newest measured angles of both bodies, which no later output sees, rad */
};

#define MODEL_FIELDS(type, prefix)                                                                           \
    SETTING(type, prefix chain.hitch, 0, 1, 0, 0) SETTING(type, prefix chain.drawbar, 0, 1, 0, 0)            \
    SETTING(type, prefix chain.back, 0, 1, 0, 0) SETTING(type, prefix first_slip, 0, 1, 0, 0)                \
    SETTING(type, prefix first_yaw_error, 0, 1, 0, 0)

/* The state at rest that explains one measurement; returns 0 when a position is missing. */
static inline int model_at_rest(const struct estimation_model *model, const struct drawbar_measurement *measurement,
                                double *state)
{
    double theta, psi;

    if (!yaws_at_rest(&model->chain, measurement, &theta, &psi))
        return 0;
    const double rest[] = {
        measurement->tractor_x, measurement->tractor_y, theta, measurement->trailer_x, measurement->trailer_y, psi,
        model->first_slip, model->first_slip, model->first_slip,
        known(measurement->hitch_angle), known(measurement->speed),
    };
    memcpy(state, rest, sizeof rest);
    return 1;
}

#include "first_guess.h"

/* The measurement (8 values). */
static inline void model_outputs(const struct estimation_model *model, const struct drawbar_measurement *measurement,
                                 double *y)
{
    (void)model;
    measured(measurement, y);
}

/* Where both antennas are: x, y of the tractor's; x, y of the trailer's by yaws and joints, which ties it to the
 * tractor's, m. Its own position is a state that would follow any fix. */
static inline void model_antennas(const struct estimation_model *model, const double *state, double *antennas)
{
    antennas[0] = state[0];
    antennas[1] = state[1];
    trailer_antenna(&model->chain, state[0], state[1], state[2], state[2] - state[9], state[5], antennas + 2);
}

/* No rates: the steering angles are inputs, and measured. */
static inline void model_steering_rates(const struct estimation_model *model, const double *state,
                                        const struct drawbar_command *command, double *rates)
{
    (void)model, (void)state, (void)command, (void)rates;
}

/* The estimate that a state stands for; the steering angles are the newest measured ones. Of the fixes it knows
 * nothing. */
static inline void model_estimate(struct estimation_model *model, const double *state,
                                  const struct drawbar_measurement *measurement, int status,
                                  struct drawbar_estimate *estimate)
{
    double *held = model->steering;

    held[0] = isfinite(measurement->tractor_steering) ? measurement->tractor_steering : held[0];
    held[1] = isfinite(measurement->trailer_steering) ? measurement->trailer_steering : held[1];
    *estimate = (struct drawbar_estimate){
        .time = measurement->time,
        .tractor = {state[0], state[1], state[2]},
        .trailer = {state[3], state[4], state[5]},
        .hitch_angle = state[9],
        .speed = state[10],
        .tractor_steering = held[0],
        .trailer_steering = held[1],
        .longitudinal_slip = state[6],
        .tractor_slip = state[7],
        .trailer_slip = state[8],
        .status = status,
    };
}

#endif

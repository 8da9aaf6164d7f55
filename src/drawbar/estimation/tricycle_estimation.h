/* Estimation on the paper's model (vehicle/tricycle.py): from measurements to its states and outputs, and from its
 * states to an estimate. The model's parameters are states too, after its own; both steering angles are inputs. */
#ifndef DRAWBAR_TRICYCLE_ESTIMATION_H
#define DRAWBAR_TRICYCLE_ESTIMATION_H

#include <string.h>
#include "at_rest.h"

struct estimation_model {
    struct chain chain;
    double first_slip;                     /* first guess of mu, kappa and eta */
    double first_yaw_error;                /* added to the first guess of both yaws, rad */
    /* newest measured angles, which are no states, rad */
    double tractor_steering, trailer_steering;
};

#define MODEL_FIELDS(type, prefix)                                                                           \
    CHAIN_FIELDS(type, prefix chain) SETTING(type, prefix first_slip, 0, 1, 0, 0)                            \
    SETTING(type, prefix first_yaw_error, 0, 1, 0, 0)

/* The state at rest that explains one measurement; returns 0 when a position is missing. */
static inline int model_at_rest(const struct estimation_model *model, const struct drawbar_measurement *measurement,
                                double *state)
{
    double theta, psi;

    if (!yaws_at_rest(&model->chain, measurement, &theta, &psi))
        return 0;
    state[X_TRACTOR_X] = measurement->tractor_x;
    state[X_TRACTOR_Y] = measurement->tractor_y;
    state[X_TRACTOR_YAW] = theta;
    state[X_TRAILER_X] = measurement->trailer_x;
    state[X_TRAILER_Y] = measurement->trailer_y;
    state[X_TRAILER_YAW] = psi;
    state[X_LONGITUDINAL_SLIP] = state[X_TRACTOR_SLIP] = state[X_TRAILER_SLIP] = model->first_slip;
    state[X_HITCH_ANGLE] = known(measurement->hitch_angle);
    state[X_SPEED] = known(measurement->speed);
    return 1;
}

#include "first_guess.h"

/* The measurement. A steering angle that is missing keeps its newest measured value: the angles are inputs, and a stage
 * whose inputs have no weight is not determined. */
static inline void model_outputs(const struct estimation_model *model, const struct drawbar_measurement *measurement,
                                 double *y)
{
    measured(measurement, y);
    if (!isfinite(measurement->tractor_steering))
        y[Y_TRACTOR_STEERING] = model->tractor_steering;
    if (!isfinite(measurement->trailer_steering))
        y[Y_TRAILER_STEERING] = model->trailer_steering;
}

/* The hitch angle, rad. */
static inline double model_hitch(const double *state)
{
    return state[X_HITCH_ANGLE];
}

/* Where both antennas are: x, y of the tractor's; x, y of the trailer's by yaws and joints, which ties it to the
 * tractor's, m. Its own position is a state that would follow any fix. */
static inline void model_antennas(const struct estimation_model *model, const double *state, double *antennas)
{
    const double theta = state[X_TRACTOR_YAW];

    antennas[0] = state[X_TRACTOR_X];
    antennas[1] = state[X_TRACTOR_Y];
    trailer_antenna(&model->chain, antennas[0], antennas[1], theta, theta - state[X_HITCH_ANGLE], state[X_TRAILER_YAW],
                    antennas + 2);
}

/* The tractor's yaw rate by its wheels: unknown, since the steering angle is an input of this model. */
static inline double model_yaw_rate(const struct estimation_model *model, const double *state)
{
    (void)model, (void)state;
    return (double)NAN;
}

/* A command implies nothing: the steering angles are inputs, and measured. */
static inline void model_commanded_outputs(const struct estimation_model *model, const double *state,
                                           const struct drawbar_command *command, double *y)
{
    (void)model, (void)state, (void)command, (void)y;
}

static inline void model_actuation(struct estimation_model *model, const struct drawbar_actuation *known)
{
    (void)model, (void)known;
}

static inline void model_commanded_inputs(const struct estimation_model *model, const double *state,
                                          const struct drawbar_command *command, double *u)
{
    (void)model, (void)state, (void)command, (void)u;
}

/* The estimate of a state; the steering angles are the newest measured ones. The statuses of the fixes are left out. */
static inline void model_estimate(struct estimation_model *model, const double *state,
                                  const struct drawbar_measurement *measurement, int status,
                                  struct drawbar_estimate *estimate)
{
    if (isfinite(measurement->tractor_steering))
        model->tractor_steering = measurement->tractor_steering;
    if (isfinite(measurement->trailer_steering))
        model->trailer_steering = measurement->trailer_steering;
    *estimate = (struct drawbar_estimate){
        .time = measurement->time,
        .tractor = {state[X_TRACTOR_X], state[X_TRACTOR_Y], state[X_TRACTOR_YAW]},
        .trailer = {state[X_TRAILER_X], state[X_TRAILER_Y], state[X_TRAILER_YAW]},
        .hitch_angle = state[X_HITCH_ANGLE],
        .speed = state[X_SPEED],
        .tractor_steering = model->tractor_steering,
        .trailer_steering = model->trailer_steering,
        .longitudinal_slip = state[X_LONGITUDINAL_SLIP],
        .tractor_slip = state[X_TRACTOR_SLIP],
        .trailer_slip = state[X_TRAILER_SLIP],
        .status = status,
    };
}

/* Nothing is identified besides the state. */
static inline void model_begin(struct estimation_model *model, double *constants)
{
    (void)model, (void)constants;
}

static inline int model_learn(struct estimation_model *model, const double *state, const struct drawbar_measurement *attitudes,
                              double *constants, double *shift)
{
    (void)model, (void)state, (void)attitudes, (void)constants, (void)shift;
    return 0;
}

#endif

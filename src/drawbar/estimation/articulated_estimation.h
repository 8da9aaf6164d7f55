/* Estimation on the exact chain (vehicle/articulated.py): from measurements to its states and outputs, and from its
 * states to an estimate.
 *
 * State: x_t, y_t, theta, psi, delta_t, delta_i; then the parameters mu, kappa, b, alpha_i, v, alpha_r. Outputs: the
 * measured quantities, both crab angles, both steering rates.
 */
#ifndef DRAWBAR_ARTICULATED_ESTIMATION_H
#define DRAWBAR_ARTICULATED_ESTIMATION_H

#include <string.h>
#include "at_rest.h"

#define STEERING_RATES 2                   /* how many outputs, the last ones, a command tells */
#define TRACTOR_YAW 2
#define TRAILER_YAW 3

struct estimation_model {
    struct chain chain;
    double first_slip;                     /* first guess of mu and kappa */
    double first_yaw_error;                /* added to the first guess of both yaws, rad */
    double sample_time;                    /* s */
    double steering_lag;                   /* of both actuators, s */
    double tractor_rate, trailer_rate;     /* limits of the actuators' rates, rad/s */
    double joint_sign;                     /* -1 where the joint's actuator is reversed, else 1 */
};

#define MODEL_FIELDS(type, prefix)                                                                           \
    SETTING(type, prefix chain.hitch, 0, 1, 0, 0) SETTING(type, prefix chain.drawbar, 0, 1, 0, 0)            \
    SETTING(type, prefix chain.back, 0, 1, 0, 0) SETTING(type, prefix first_slip, 0, 1, 0, 0)                \
    SETTING(type, prefix first_yaw_error, 0, 1, 0, 0) SETTING(type, prefix sample_time, 0, 1, 0, 0)          \
    SETTING(type, prefix steering_lag, 0, 1, 0, 0) SETTING(type, prefix tractor_rate, 0, 1, 0, 0)            \
    SETTING(type, prefix trailer_rate, 0, 1, 0, 0) SETTING(type, prefix joint_sign, 0, 1, 0, 0)

/* The state at rest that explains one measurement; returns 0 when a position is missing. */
static inline int model_at_rest(const struct estimation_model *model, const struct drawbar_measurement *measurement,
                                double *state)
{
    double theta, psi;

    if (!yaws_at_rest(&model->chain, measurement, &theta, &psi))
        return 0;
    const double rest[] = {
        measurement->tractor_x, measurement->tractor_y, theta, psi,
        known(measurement->tractor_steering), known(measurement->trailer_steering),
        model->first_slip, model->first_slip, 0.0, 0.0, known(measurement->speed), 0.0,
    };
    memcpy(state, rest, sizeof rest);
    return 1;
}

#include "first_guess.h"

/* The measurement (8 values); zero for both crab angles while a fix is missing; zero for both steering rates.
 *
 * With both fixes the crab angles show, and to pull them to zero would hide a side slope; without, nothing holds them
 * but the belief that they fade. Commands take the place of the rates' zeros as soon as they are known. */
static inline void model_outputs(const struct estimation_model *model, const struct drawbar_measurement *measurement,
                                 double *y)
{
    (void)model;
    measured(measurement, y);
    y[8] = y[9] = isnan(y[0] + y[1] + y[2] + y[3]) ? 0.0 : NAN;
    y[10] = y[11] = 0.0;
}

/* Where both antennas are: x, y of the tractor's, x, y of the trailer's, which follows from the chain, m. */
static inline void model_antennas(const struct estimation_model *model, const double *state, double *antennas)
{
    const double psi = state[3];

    antennas[0] = state[0];
    antennas[1] = state[1];
    trailer_antenna(&model->chain, state[0], state[1], state[2], psi + state[5], psi, antennas + 2);
}

/* By how much per second a lagging, rate-limited actuator moves within an interval, rad/s.
 *
 * error: command minus present angle, rad; lag and interval in s; limit in rad/s. */
static inline double mean_rate(double error, double lag, double limit, double interval)
{
    const double distance = fabs(error);
    const double limited = clamped(distance / limit - lag, 0.0, interval);
    const double remaining = distance - limit * limited;
    const double moved = limit * limited - remaining * expm1(-(interval - limited) / lag);

    return copysign(moved, error) / interval;
}

/* The mean rates (rad/s) of both lagging, rate-limited actuators until the next sample, as the values of the last
 * outputs. */
static inline void model_steering_rates(const struct estimation_model *model, const double *state,
                                        const struct drawbar_command *command, double *rates)
{
    const double joint = model->joint_sign * command->trailer_steering;

    rates[0] = mean_rate(command->tractor_steering - state[4], model->steering_lag, model->tractor_rate,
                         model->sample_time);
    rates[1] = mean_rate(joint - state[5], model->steering_lag, model->trailer_rate, model->sample_time);
}

/* The estimate that a state stands for; the trailer's antenna follows from the chain. Of the fixes it knows nothing. */
static inline void model_estimate(struct estimation_model *model, const double *state,
                                  const struct drawbar_measurement *measurement, int status,
                                  struct drawbar_estimate *estimate)
{
    double antennas[4];

    model_antennas(model, state, antennas);
    *estimate = (struct drawbar_estimate){
        .time = measurement->time,
        .tractor = {antennas[0], antennas[1], state[2]},
        .trailer = {antennas[2], antennas[3], state[3]},
        .hitch_angle = state[2] - state[3] - state[5],
        .speed = state[10],
        .tractor_steering = state[4],
        .trailer_steering = state[5],
        .longitudinal_slip = state[6],
        .tractor_slip = state[7],
        .trailer_slip = 1.0,
        .steering_offset = state[8],
        .tractor_crab = state[11],
        .trailer_crab = state[9],
        .status = status,
    };
}

#endif

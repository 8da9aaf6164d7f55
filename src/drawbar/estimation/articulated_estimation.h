/* Estimation on the exact chain (vehicle/articulated.py): from measurements to its states and outputs, and from its
 * states to an estimate. The model's parameters are states too, after its own. */
#ifndef DRAWBAR_ARTICULATED_ESTIMATION_H
#define DRAWBAR_ARTICULATED_ESTIMATION_H

#include <string.h>
#include "at_rest.h"
#include "slide.h"

#define YAW_RATE_OUTPUT Y_TRACTOR_YAW_RATE  /* weighed with the fixes, see fix_weights.h */
#define FIRST_SLIDE (CONSTANTS - 4)        /* place among the constants: slide_east, slide_north, creep, then the sample time */

struct estimation_model {
    struct chain chain;
    double trailer_length;                 /* actuated joint to the trailer's axle, m */
    double first_slip;                     /* first guess of mu and kappa */
    double first_yaw_error;                /* added to the first guess of both yaws, rad */
    double sample_time;                    /* s */
    double tractor_lag, trailer_lag;       /* of the actuators, s */
    double tractor_rate, trailer_rate;     /* limits of the actuators' rates, rad/s */
    double joint_sign;                     /* -1 where the joint's actuator is reversed, else 1 */
    struct slide slide;                    /* beyond which crab angles and steering offset are estimated */
};

#define MODEL_FIELDS(type, prefix)                                                                           \
    CHAIN_FIELDS(type, prefix chain)                                                                         \
    SETTING(type, prefix trailer_length, 0, 1, 0, 0) SETTING(type, prefix first_slip, 0, 1, 0, 0)            \
    SETTING(type, prefix first_yaw_error, 0, 1, 0, 0) SETTING(type, prefix sample_time, 0, 1, 0, 0)          \
    SETTING(type, prefix tractor_lag, 0, 1, 0, 0) SETTING(type, prefix trailer_lag, 0, 1, 0, 0)              \
    SETTING(type, prefix tractor_rate, 0, 1, 0, 0) SETTING(type, prefix trailer_rate, 0, 1, 0, 0)            \
    SETTING(type, prefix joint_sign, 0, 1, 0, 0)                                                             \
    SLIDE_FIELDS(type, prefix slide)

/* The state at rest that explains one measurement; returns 0 when a position is missing. */
static inline int model_at_rest(const struct estimation_model *model, const struct drawbar_measurement *measurement,
                                double *state)
{
    double theta, psi;

    if (!yaws_at_rest(&model->chain, measurement, &theta, &psi))
        return 0;
    memset(state, 0, NX * sizeof *state);
    state[X_TRACTOR_X] = measurement->tractor_x;
    state[X_TRACTOR_Y] = measurement->tractor_y;
    state[X_TRACTOR_YAW] = theta;
    state[X_TRAILER_YAW] = psi;
    state[X_TRACTOR_STEERING] = known(measurement->tractor_steering);
    state[X_TRAILER_STEERING] = known(measurement->trailer_steering);
    state[X_LONGITUDINAL_SLIP] = state[X_TRACTOR_SLIP] = model->first_slip;
    state[X_SPEED] = known(measurement->speed);
    return 1;
}

#include "first_guess.h"

/* The measurement, with the tractor's yaw and yaw rate; zero for both crab angles while a fix is missing; zero for both steering
 * rates.
 *
 * With both fixes the crab angles are observable, and a prior of zero would hide a side slope; without, only that prior holds
 * them. Commands take the place of the rates' zeros as soon as they are known. */
static inline void model_outputs(const struct estimation_model *model, const struct drawbar_measurement *measurement,
                                 double *y)
{
    (void)model;
    measured(measurement, y);
    y[Y_TRACTOR_YAW] = if_finite(measurement->tractor_yaw);
    y[Y_TRACTOR_YAW_RATE] = if_finite(measurement->tractor_yaw_rate);
    const int missing = isnan(y[Y_TRACTOR_X] + y[Y_TRACTOR_Y] + y[Y_TRAILER_X] + y[Y_TRAILER_Y]);
    y[Y_TRAILER_CRAB] = y[Y_TRACTOR_CRAB] = missing ? 0.0 : (double)NAN;
    y[Y_TRACTOR_STEERING_RATE] = y[Y_TRAILER_STEERING_RATE] = 0.0;
}

/* The hitch angle, rad. */
static inline double model_hitch(const double *state)
{
    return state[X_TRACTOR_YAW] - state[X_TRAILER_YAW] - state[X_TRAILER_STEERING];
}

/* Where both antennas are: x, y of the tractor's, x, y of the trailer's, which follows from the chain, m. */
static inline void model_antennas(const struct estimation_model *model, const double *state, double *antennas)
{
    const double psi = state[X_TRAILER_YAW];

    antennas[0] = state[X_TRACTOR_X];
    antennas[1] = state[X_TRACTOR_Y];
    trailer_antenna(&model->chain, antennas[0], antennas[1], state[X_TRACTOR_YAW], psi + state[X_TRAILER_STEERING],
                    psi, antennas + 2);
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

/* Use identified values of the actuators from now on. */
static inline void model_actuation(struct estimation_model *model, const struct drawbar_actuation *known)
{
    model->tractor_lag = known->tractor_lag;
    model->trailer_lag = known->trailer_lag;
    model->tractor_rate = known->tractor_rate;
    model->trailer_rate = known->trailer_rate;
}

/* The mean rates (rad/s) of both lagging, rate-limited actuators until the next sample. */
static inline double tractor_rate(const struct estimation_model *model, const double *state,
                                  const struct drawbar_command *command)
{
    const double error = command->tractor_steering - state[X_TRACTOR_STEERING];
    return mean_rate(error, model->tractor_lag, model->tractor_rate, model->sample_time);
}

static inline double trailer_rate(const struct estimation_model *model, const double *state,
                                  const struct drawbar_command *command)
{
    const double error = model->joint_sign * command->trailer_steering - state[X_TRAILER_STEERING];
    return mean_rate(error, model->trailer_lag, model->trailer_rate, model->sample_time);
}

/* The outputs that a command implies until the next sample; before any has arrived the wheels rest. */
static inline void model_commanded_outputs(const struct estimation_model *model, const double *state,
                                           const struct drawbar_command *command, double *y)
{
    const double tractor = tractor_rate(model, state, command), trailer = trailer_rate(model, state, command);

    y[Y_TRACTOR_STEERING_RATE] = isfinite(tractor) ? tractor : 0.0;
    y[Y_TRAILER_STEERING_RATE] = isfinite(trailer) ? trailer : 0.0;
}

/* The inputs that a command implies until the next sample; one that is not finite implies none. */
static inline void model_commanded_inputs(const struct estimation_model *model, const double *state,
                                          const struct drawbar_command *command, double *u)
{
    const double tractor = tractor_rate(model, state, command), trailer = trailer_rate(model, state, command);

    u[U_TRACTOR_STEERING_RATE] = isfinite(tractor) ? tractor : u[U_TRACTOR_STEERING_RATE];
    u[U_TRAILER_STEERING_RATE] = isfinite(trailer) ? trailer : u[U_TRAILER_STEERING_RATE];
}

/* The tractor's yaw rate by its wheels, rad/s. */
static inline double model_yaw_rate(const struct estimation_model *model, const double *state)
{
    const double steered = state[X_TRACTOR_SLIP] * state[X_TRACTOR_STEERING] + state[X_STEERING_OFFSET];
    const double angle = steered - state[X_TRACTOR_CRAB];

    return state[X_LONGITUDINAL_SLIP] * state[X_SPEED] * tan(angle) / model->chain.wheelbase;
}

/* Heading and lateral acceleration of both axles: the trailer's joint at rest, axles without side-slip, as _turns in
 * articulated.py. */
static inline void model_axles(const struct estimation_model *model, const double *state, struct axle *axles)
{
    const double theta = state[X_TRACTOR_YAW], psi = state[X_TRAILER_YAW];
    const double speed = state[X_LONGITUDINAL_SLIP] * state[X_SPEED];
    const double turn = model_yaw_rate(model, state);
    const double lever = model->trailer_length + model->chain.drawbar * cos(state[X_TRAILER_STEERING]);
    const double trailer = (speed * sin(theta - psi) - model->chain.hitch * turn * cos(theta - psi)) / lever;

    axles[0] = (struct axle){theta, speed * turn / GRAVITY};
    axles[1] = (struct axle){psi, speed * trailer / GRAVITY};
}

/* The estimate of a state; the trailer's antenna follows from the chain. The statuses of the fixes are left out. */
static inline void model_estimate(struct estimation_model *model, const double *state,
                                  const struct drawbar_measurement *measurement, int status,
                                  struct drawbar_estimate *estimate)
{
    struct axle axles[2];
    double antennas[4], slide[3];

    model_antennas(model, state, antennas);
    model_axles(model, state, axles);
    slide_coefficients(&model->slide, slide);
    *estimate = (struct drawbar_estimate){
        .time = measurement->time,
        .tractor = {antennas[0], antennas[1], state[X_TRACTOR_YAW]},
        .trailer = {antennas[2], antennas[3], state[X_TRAILER_YAW]},
        .hitch_angle = model_hitch(state),
        .speed = state[X_SPEED],
        .tractor_steering = state[X_TRACTOR_STEERING],
        .trailer_steering = state[X_TRAILER_STEERING],
        .longitudinal_slip = state[X_LONGITUDINAL_SLIP],
        .tractor_slip = state[X_TRACTOR_SLIP],
        .trailer_slip = 1.0,
        .steering_offset = state[X_STEERING_OFFSET] + slide_across(&model->slide, axles[0]),
        .tractor_crab = state[X_TRACTOR_CRAB] + slide_across(&model->slide, axles[0]),
        .trailer_crab = state[X_TRAILER_CRAB] + slide_across(&model->slide, axles[1]),
        .slide_east = slide[0],
        .slide_north = slide[1],
        .creep = slide[2],
        .status = status,
    };
}

/* Initialise without a slide; `constants` are those of the model. */
static inline void model_begin(struct estimation_model *model, double *constants)
{
    slide_begin(&model->slide);
    memset(constants + FIRST_SLIDE, 0, 3 * sizeof *constants);
}

/* Update the slide with an estimated state and both attitudes, and write it into the model's constants. `shift` becomes the
 * change of steering offset and both crab angles by which their sum with the slide stays the same, rad; returns whether there
 * is any. */
static inline int model_learn(struct estimation_model *model, const double *state, const struct drawbar_measurement *attitudes,
                              double *constants, double *shift)
{
    struct slide *slide = &model->slide;
    struct axle axles[2];

    if (!(slide->prior > 0.0))
        return 0;
    model_axles(model, state, axles);
    const double before[] = {slide_across(slide, axles[0]), slide_across(slide, axles[1])};
    if (isfinite(attitudes->tractor_roll))
        slide_attitude(slide, axles[0].yaw, attitudes->tractor_roll, attitudes->tractor_pitch, model->sample_time);
    else
        slide_attitude(slide, axles[1].yaw, attitudes->trailer_roll, attitudes->trailer_pitch, model->sample_time);
    slide_at_speed(slide, state[X_LONGITUDINAL_SLIP] * state[X_SPEED], model->chain.wheelbase);
    slide_forget(slide);
    slide_update(slide, axles[0], state[X_TRACTOR_CRAB] + before[0]);
    slide_update(slide, axles[1], state[X_TRAILER_CRAB] + before[1]);
    slide_coefficients(slide, constants + FIRST_SLIDE);
    memset(shift, 0, NX * sizeof *shift);
    shift[X_STEERING_OFFSET] = shift[X_TRACTOR_CRAB] = before[0] - slide_across(slide, axles[0]);
    shift[X_TRAILER_CRAB] = before[1] - slide_across(slide, axles[1]);
    return 1;
}

#endif

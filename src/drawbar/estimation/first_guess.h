/* First guess of the state, where an estimator begins and begins anew; to be included by the models, which define
 * struct estimation_model and model_at_rest. */
#ifndef DRAWBAR_FIRST_GUESS_H
#define DRAWBAR_FIRST_GUESS_H

/* The state from the first measurement, both yaws off by the configured error; returns 0 when a position is missing. */
static inline int model_first_guess(const struct estimation_model *model,
                                    const struct drawbar_measurement *measurement, double *state)
{
    if (!model_at_rest(model, measurement, state))
        return 0;
    state[X_TRACTOR_YAW] += model->first_yaw_error;
    state[X_TRAILER_YAW] += model->first_yaw_error;
    return 1;
}

/* The state from a later measurement, yaws on the branch of the present state; returns 0 when a position is missing. */
static inline int model_new_guess(const struct estimation_model *model, const struct drawbar_measurement *measurement,
                                  const double *present, double *state)
{
    if (!model_at_rest(model, measurement, state))
        return 0;
    const double turns = nearest_branch(state[X_TRACTOR_YAW], present[X_TRACTOR_YAW]) - state[X_TRACTOR_YAW];
    state[X_TRACTOR_YAW] += turns;
    state[X_TRAILER_YAW] += turns;
    return 1;
}

#endif

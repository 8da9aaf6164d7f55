/* Estimation by the extended Kalman filter, one sample at a time: screen, correct, and after the command is out predict.
 *
 * The including unit defines the filter's sizes, includes the estimation model before this header and what evaluates the
 * model after it, see square_root_filter.h.
 */
#ifndef DRAWBAR_EXTENDED_KALMAN_H
#define DRAWBAR_EXTENDED_KALMAN_H

#include "solver_resources.h"
#include "screening.h"
#include "square_root_filter.h"
#include "unit.h"

struct component {
    struct filter filter;
    struct estimation_model model;
    struct screening screening;
    double nominal[4];                     /* standard deviations of the positions among the filter's outputs */
    int32_t predicted;                     /* outcome of the last prediction, enum qp_status */
};

#define COMPONENT_FIELDS FILTER_FIELDS(component, filter.) MODEL_FIELDS(component, model.) SCREENING_FIELDS(component, screening.)

static const int fix_output[4] = {Y_TRACTOR_X, Y_TRACTOR_Y, Y_TRAILER_X, Y_TRAILER_Y};

/* Weight the fixes of a measurement by their standard deviations. */
static void weigh(struct component *component, const struct drawbar_measurement *measurement)
{
    const double reported[] = {measurement->tractor_fix_deviation, measurement->trailer_fix_deviation};

    for (int i = 0; i < 4; ++i) {
        const double ratio = reported[i / 2] > 0.0 ? reported[i / 2] / component->screening.deviation : 1.0;
        component->filter.noise[fix_output[i]] = component->nominal[i] * ratio;
    }
}

/* Start from the first measurement; BAD_INPUT where it lacks a position. */
int UNIT(begin)(struct component *component, const struct drawbar_measurement *first)
{
    filter_constants(&component->filter);
    filter_forget(&component->filter);
    model_begin(&component->model, component->filter.constants);
    for (int i = 0; i < 4; ++i)
        component->nominal[i] = component->filter.noise[fix_output[i]];
    return model_first_guess(&component->model, first, component->filter.x[0]) ? SOLVED : BAD_INPUT;
}

/* Screen the newest fixes, and restart where both overrule the prediction. */
static void screen(struct component *component, const struct drawbar_measurement *measurement, struct screened *screened)
{
    double antennas[4], guess[NX];

    model_antennas(&component->model, component->filter.x[0], antennas);
    screening_judge(&component->screening, measurement, antennas,
                    model_yaw_rate(&component->model, component->filter.x[0]), screened);
    if (!screened->restart) {
        screening_hitch(&component->screening, model_hitch(component->filter.x[0]), screened);
        screening_lengths(&component->screening, antennas, screened);
    }
    const struct drawbar_measurement anew = screened_anew(screened, measurement);
    if (screened->restart && model_new_guess(&component->model, &anew, component->filter.x[0], guess)) {
        memcpy(component->filter.x[0], guess, sizeof guess);
        filter_forget(&component->filter);
    }
}

/* The estimate that is expected at the next measurement; its time is NaN. */
int UNIT(expected)(struct component *component, struct drawbar_estimate *estimate)
{
    model_estimate(&component->model, component->filter.x[0], &nothing_measured, component->predicted, estimate);
    return SOLVED;
}

/* The estimate at the measurement's time; returns its status.
 *
 * When the result is not finite the estimate is the prediction, and its status shows it; a failure of the prediction
 * before it shows here too. A missing input keeps its last measured value. */
int UNIT(update)(struct component *component, const struct drawbar_measurement *measurement, struct drawbar_estimate *estimate,
                 struct solver_resources *resources)
{
    struct screened screened;
    double y[NY], shift[NX];

    (void)resources;
    screen(component, measurement, &screened);
    model_outputs(&component->model, &screened.measurement, y);
    weigh(component, &screened.measurement);
    const int corrected = filter_update(&component->filter, y), status = corrected == SOLVED ? component->predicted : corrected;
    model_estimate(&component->model, component->filter.x[0], &screened.measurement, status, estimate);
    screened_mark(&screened, estimate);
    if (status == SOLVED
        && model_learn(&component->model, component->filter.x[0], &screened.measurement, component->filter.constants, shift))
        for (int i = 0; i < NX; ++i)
            component->filter.x[0][i] += shift[i];
    return status;
}

/* Predict one sample ahead, under the command that acts until then (NULL: unknown): an unknown input keeps its last measured
 * value. */
int UNIT(ready)(struct component *component, const struct drawbar_command *acting)
{
    struct filter *filter = &component->filter;

    if (acting != NULL)
        model_commanded_inputs(&component->model, filter->x[0], acting, filter->u[0]);
    return component->predicted = filter_predict(filter);
}

/* Advance by a sample without a measurement. */
int UNIT(skip)(struct component *component, const struct drawbar_command *acting)
{
    return UNIT(ready)(component, acting);
}

/* Use identified values of the actuators from now on. */
int UNIT(actuation)(struct component *component, const struct drawbar_actuation *known)
{
    model_actuation(&component->model, known);
    return 0;
}

#endif

/* Moving horizon estimation: one Gauss-Newton iteration per sample over a sliding window (docs/theory/estimation.md).
 *
 * The window fills from the first measurement on; once full, its oldest stage moves into the arrival cost. The
 * including unit is the solver of the window's problem and has included the model.
 */
#ifndef DRAWBAR_MOVING_HORIZON_H
#define DRAWBAR_MOVING_HORIZON_H

#include "fix_weights.h"
#include "screening.h"
#include "unit.h"
#include "window.h"

struct component {
    struct rti rti;
    struct window window;
    struct estimation_model model;
    struct screening screening;
    struct fix_weights weights;
    struct screened screened;              /* the newest measurement */
    int32_t prepared;                      /* outcome of the last preparation, enum qp_status */
};

#define COMPONENT_FIELDS                                                                                          \
    WINDOW_FIELDS(component, window.) MODEL_FIELDS(component, model.) SCREENING_FIELDS(component, screening.)

static double *newest_state(struct component *component)
{
    return STATE(component->rti.z, component->window.newest);
}

/* Start from the first measurement; BAD_INPUT where it lacks a position. */
int UNIT(begin)(struct component *component, const struct drawbar_measurement *first)
{
    double guess[NX];

    if (!model_first_guess(&component->model, first, guess))
        return BAD_INPUT;
    fix_weights_reset(&component->weights, &component->rti);
    model_begin(&component->model, component->rti.constants);
    return component->prepared = window_restart(&component->window, &component->rti, guess);
}

/* Start anew where both antennas overrule the prediction. */
static void overrule(struct component *component, const struct drawbar_measurement *measurement)
{
    const struct drawbar_measurement anew = screened_anew(&component->screened, measurement);
    double guess[NX];

    if (model_new_guess(&component->model, &anew, newest_state(component), guess)) {
        fix_weights_reset(&component->weights, &component->rti);
        component->prepared = window_restart(&component->window, &component->rti, guess);
    }
}

/* Mask the window's fixes of an antenna that has just become suspect, as far back as the means cover. */
static void mask_suspect(struct component *component, int antenna)
{
    const int newest = component->window.newest, tractor = antenna == TRACTOR_ANTENNA;
    const int first = newest > component->screening.memory ? newest - component->screening.memory : 0;

    for (int k = first; k < newest; ++k) {
        double *y = component->rti.y[k];
        y[tractor ? Y_TRACTOR_X : Y_TRAILER_X] = y[tractor ? Y_TRACTOR_Y : Y_TRAILER_Y] = (double)NAN;
    }
}

/* Screen a measurement and enter it into the window. */
static void take_in(struct component *component, const struct drawbar_measurement *measurement)
{
    double antennas[4];

    model_antennas(&component->model, newest_state(component), antennas);
    screening_judge(&component->screening, measurement, antennas,
                    model_yaw_rate(&component->model, newest_state(component)), &component->screened);
    if (component->screened.restart)
        overrule(component, measurement);
    if (!component->screened.restart) {
        screening_hitch(&component->screening, model_hitch(newest_state(component)), &component->screened);
        screening_lengths(&component->screening, antennas, &component->screened);
    }
    if (component->screened.exposed != NEITHER)
        mask_suspect(component, component->screened.exposed);
    model_outputs(&component->model, &component->screened.measurement, component->rti.y[component->window.newest]);
    fix_weights_set(&component->weights, &component->rti, component->window.newest, &component->screened.measurement,
                    component->screening.deviation);
}

/* Update the model's identified constants from the newest estimate, and shift the whole window accordingly. */
static void learn(struct component *component)
{
    struct rti *rti = &component->rti;
    double shift[NX];

    if (rti->status != SOLVED
        || !model_learn(&component->model, newest_state(component), &component->screened.measurement, rti->constants, shift))
        return;
    for (int i = 0; i < NX; ++i) {
        rti->prior[i] += shift[i];
        for (int k = 0; k <= N; ++k)
            STATE(rti->z, k)[i] += shift[i];
    }
}

/* The estimate that is expected at the next measurement; its time is NaN. */
int UNIT(expected)(struct component *component, struct drawbar_estimate *estimate)
{
    model_estimate(&component->model, newest_state(component), &nothing_measured, component->prepared, estimate);
    return SOLVED;
}

/* The estimate at the measurement's time, which is the window's newest stage. When the solver failed it is the
 * prediction, and its status shows it; a failure of the preparation before it shows here too. */
int UNIT(update)(struct component *component, const struct drawbar_measurement *measurement,
                 struct drawbar_estimate *estimate, struct solver_resources *resources)
{
    take_in(component, measurement);
    WATCHED(WATCHED_FEEDBACK, rti_feedback(&component->rti, resources));
    const int32_t status = component->rti.status != SOLVED ? component->rti.status : component->prepared;
    model_estimate(&component->model, newest_state(component), &component->screened.measurement, status, estimate);
    screened_mark(&component->screened, estimate);
    learn(component);
    return status;
}

/* Set the newest sample's inputs to those that a command implies (NULL: unknown), and propagate the change by the
 * linearisation; its defects stay. */
static void follow(struct component *component, const struct drawbar_command *acting)
{
    struct rti *rti = &component->rti;
    const int k = component->window.newest - 1;
    double *u = INPUT(rti->z, k), commanded[NU], moved[ND] = {0.0};

    if (acting == NULL)
        return;
    memcpy(commanded, u, sizeof commanded);
    model_commanded_inputs(&component->model, STATE(rti->z, k), acting, commanded);
    for (int i = 0; i < ND; ++i)
        for (int a = 0; a < NU; ++a)
            moved[i] += rti->qp.B[k][i][a] * (commanded[a] - u[a]);
    if (!all_finite(moved, ND))
        return;
    memcpy(u, commanded, sizeof commanded);
    for (int j = k + 1; all_finite(moved, ND); ++j) {
        double next[ND] = {0.0};
        for (int i = 0; i < ND; ++i)
            STATE(rti->z, j)[i] += moved[i];
        if (j == N)
            return;
        for (int i = 0; i < ND; ++i)
            for (int m = 0; m < ND; ++m)
                next[i] += rti->qp.A[j][i][m] * moved[m];
        memcpy(moved, next, sizeof moved);
    }
}

/* Slide the window; the newest stage gets the steering rates that the command implies (NULL: unknown). */
static void go_on(struct component *component, const struct drawbar_command *acting)
{
    if (acting != NULL)
        model_commanded_outputs(&component->model, newest_state(component), acting,
                                component->rti.y[component->window.newest]);
    const int full = component->window.newest == N;
    WATCHED(WATCHED_SLIDE, window_slide(&component->window, &component->rti));
    if (full)
        fix_weights_slide(&component->weights, &component->rti);
}

/* Preparation for the next measurement: slide the window, linearise along the predicted trajectory. */
int UNIT(ready)(struct component *component, const struct drawbar_command *acting)
{
    go_on(component, acting);
    WATCHED(WATCHED_PREPARE, rti_prepare(&component->rti));
    follow(component, acting);
    return component->prepared = component->window.absorbed != SOLVED ? component->window.absorbed : component->rti.status;
}

/* Advance by a sample without a measurement: its stage is the prediction. The next one, with or without a measurement,
 * recomputes the Hessian, and nothing is factorised before that. */
int UNIT(skip)(struct component *component, const struct drawbar_command *acting)
{
    model_outputs(&component->model, &nothing_measured, component->rti.y[component->window.newest]);
    go_on(component, acting);
    rti_linearise(&component->rti);
    rti_reweighted(&component->rti);
    follow(component, acting);
    return component->prepared = component->window.absorbed;
}

/* Use identified values of the actuators from now on. */
int UNIT(actuation)(struct component *component, const struct drawbar_actuation *known)
{
    model_actuation(&component->model, known);
    return 0;
}

#endif

/* Moving horizon estimation: one Gauss-Newton iteration per sample over a sliding window (equation mhe of theory.md).
 *
 * The window fills from the first measurement on; once full, its oldest stage moves into the arrival cost. The
 * including unit is the solver of the window's problem and has included the model.
 */
#ifndef DRAWBAR_MOVING_HORIZON_H
#define DRAWBAR_MOVING_HORIZON_H

#include "screening.h"
#include "unit.h"
#include "window.h"

struct part {
    struct rti rti;
    struct window window;
    struct estimation_model model;
    struct screening screening;
    struct screened seen;                  /* the newest measurement */
    int32_t prepared;                      /* outcome of the last preparation, enum qp_status */
};

#define PART_FIELDS                                                                                          \
    WINDOW_FIELDS(part, window.) MODEL_FIELDS(part, model.) SCREENING_FIELDS(part, screening.)

static double *newest_state(struct part *part)
{
    return STATE(part->rti.z, part->window.newest);
}

/* Start from the first measurement; BAD_INPUT where it lacks a position. */
int UNIT(begin)(struct part *part, const struct drawbar_measurement *first)
{
    double guess[NX];

    if (!model_first_guess(&part->model, first, guess))
        return BAD_INPUT;
    return part->prepared = window_restart(&part->window, &part->rti, guess);
}

/* Start anew where both antennas overrule the prediction. */
static void overrule(struct part *part, const struct drawbar_measurement *measurement)
{
    double guess[NX];

    if (model_new_guess(&part->model, measurement, newest_state(part), guess))
        part->prepared = window_restart(&part->window, &part->rti, guess);
}

/* Forget the fixes of an antenna that has just turned out to be wrong, as far back as the disagreement was averaged. */
static void disbelieve(struct part *part, int antenna)
{
    const int newest = part->window.newest, column = 2 * (antenna - TRACTOR_ANTENNA);
    const int first = newest > part->screening.memory ? newest - part->screening.memory : 0;

    for (int k = first; k < newest; ++k)
        part->rti.y[k][column] = part->rti.y[k][column + 1] = NAN;
}

/* Take in a measurement: judge its fixes, let the window forget what they show to have been wrong. */
int UNIT(enter)(struct part *part, const struct drawbar_measurement *measurement)
{
    double antennas[4];

    model_antennas(&part->model, newest_state(part), antennas);
    screening_judge(&part->screening, measurement, antennas, &part->seen);
    if (part->seen.restart)
        overrule(part, measurement);
    if (part->seen.exposed != NEITHER)
        disbelieve(part, part->seen.exposed);
    model_outputs(&part->model, &part->seen.measurement, part->rti.y[part->window.newest]);
    return SOLVED;
}

/* The estimate at the window's newest stage. When the solver failed it is the prediction, and its status says so; a
 * failure of the preparation before it shows here too. */
int UNIT(leave)(struct part *part, struct drawbar_estimate *estimate)
{
    const int32_t status = part->rti.status != SOLVED ? part->rti.status : part->prepared;

    model_estimate(&part->model, newest_state(part), &part->seen.measurement, status, estimate);
    screened_mark(&part->seen, estimate);
    return status;
}

/* Let the newest stage know what the command does to the steering until the next sample; NULL: nobody tells. */
int UNIT(expect)(struct part *part, const struct drawbar_command *acting)
{
    double *rates = part->rti.y[part->window.newest] + NY - STEERING_RATES;

    if (acting != NULL)
        model_steering_rates(&part->model, newest_state(part), acting, rates);
    return SOLVED;
}

/* Keep how the preparation, to slide the window and to linearise along the predicted trajectory, went. */
int UNIT(judge)(struct part *part)
{
    return part->prepared = part->window.absorbed != SOLVED ? part->window.absorbed : part->rti.status;
}

#ifdef EXPORTED
/* The estimate at the measurement's time. */
int UNIT(update)(struct part *part, const struct drawbar_measurement *measurement, struct drawbar_estimate *estimate,
                 void *work)
{
    UNIT(enter)(part, measurement);
    rti_feedback(&part->rti, work);
    return UNIT(leave)(part, estimate);
}

/* Do what can be done before the next measurement is known. */
int UNIT(ready)(struct part *part, const struct drawbar_command *acting)
{
    UNIT(expect)(part, acting);
    window_slide(&part->window, &part->rti);
    rti_prepare(&part->rti);
    return UNIT(judge)(part);
}
#endif

#endif

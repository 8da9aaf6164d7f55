/* Structure: calls of the components that a configuration may have or lack, so that the control step need not ask. */
#ifndef DRAWBAR_STEP_STRUCTURE_H
#define DRAWBAR_STEP_STRUCTURE_H

#include <stddef.h>
#include "components.h"

static void initialise_controllers(struct autopilot *a)
{
#ifdef DRAWBAR_CENTRALISED
    drawbar_controller_initialise(COMPONENT(a->controller));
#else
    drawbar_tractor_initialise(COMPONENT(a->tractor));
    drawbar_trailer_initialise(COMPONENT(a->trailer));
#endif
}

static void initialise_components(struct autopilot *a)
{
    drawbar_alignment_initialise(COMPONENT(a->alignment));
    drawbar_estimator_initialise(COMPONENT(a->estimator));
    drawbar_guidance_initialise(COMPONENT(a->guidance));
    drawbar_tractor_law_initialise(COMPONENT(a->tractor_law));
    drawbar_trailer_law_initialise(COMPONENT(a->trailer_law));
    drawbar_run_monitor_initialise(COMPONENT(a->run_monitor));
    drawbar_sanity_initialise(COMPONENT(a->sanity));
#ifdef DRAWBAR_IDENTIFIED
    drawbar_actuation_initialise(COMPONENT(a->actuation));
#endif
#ifdef DRAWBAR_DEAD_TIME
    drawbar_predictor_initialise(COMPONENT(a->predictor));
#endif
    initialise_controllers(a);
}

/* Identify the actuators from their measured angles, and pass the result to all components that model them; returns 0 or
 * the status with which the run ends. */
static int identify(struct autopilot *a, const struct drawbar_measurement *measurement)
{
#ifdef DRAWBAR_IDENTIFIED
    struct drawbar_actuation *const known = &a->known;
    const int ended = drawbar_actuation_measured(COMPONENT(a->actuation), measurement);
    drawbar_actuation_report(COMPONENT(a->actuation), known);
    drawbar_estimator_actuation(COMPONENT(a->estimator), known);
    drawbar_predictor_actuation(COMPONENT(a->predictor), known);
#ifdef DRAWBAR_CENTRALISED
    drawbar_controller_actuation(COMPONENT(a->controller), known);
#else
    drawbar_tractor_actuation(COMPONENT(a->tractor), known);
    drawbar_trailer_actuation(COMPONENT(a->trailer), known);
#endif
    return ended;
#else
    (void)a, (void)measurement;
    return 0;
#endif
}

/* Replace the measured steering angle by the one that turns the tractor now, and report the lag between them. */
static void correct_body_lag(struct autopilot *a, struct drawbar_measurement *aligned)
{
#ifdef DRAWBAR_DEAD_TIME
    drawbar_predictor_measured(COMPONENT(a->predictor), &a->made.estimate, aligned, &a->known);
#else
    (void)a, (void)aligned;
#endif
}

/* Predict the estimate to when the next command begins to act. */
static void predict_over_dead_time(struct autopilot *a, struct drawbar_estimate *ahead)
{
#ifdef DRAWBAR_DEAD_TIME
    drawbar_predictor_ahead(COMPONENT(a->predictor), &a->made.estimate, ahead);
#else
    *ahead = a->made.estimate;
#endif
}

/* Note a sent command; `acting` becomes the one that acts during most of the sample that now begins. */
static void note_sent(struct autopilot *a, const struct drawbar_command *command)
{
    struct drawbar_command sent = *command;

#ifdef DRAWBAR_IDENTIFIED
    drawbar_actuation_sent(COMPONENT(a->actuation), &sent);
#endif
    sent.trailer_steering *= 1.0 + a->known.joint_scale;   /* from here on as the joint turns, not as it is measured */
#ifdef DRAWBAR_DEAD_TIME
    drawbar_predictor_sent(COMPONENT(a->predictor), &sent, &a->acting);
#else
    a->acting = sent;
#endif
}

/* Both bodies' nominal plans. */
static void plan(struct autopilot *a, const struct drawbar_estimate *ahead, struct solver_resources *resources)
{
    const struct drawbar_body_reference *references = a->made.references;
    struct drawbar_body_plan *plans = a->made.plans;

#ifdef DRAWBAR_CENTRALISED
    TIMED(a, TIMED_TRACTOR, FEEDBACK, drawbar_controller_feedback(
        COMPONENT(a->controller), ahead, &references[TRACTOR_BODY], &references[TRAILER_BODY], &plans[TRACTOR_BODY],
        &plans[TRAILER_BODY], resources));
#else
    const struct drawbar_neighbour tractor = {&references[TRACTOR_BODY], &plans[TRACTOR_BODY]};

    TIMED(a, TIMED_TRACTOR, FEEDBACK, drawbar_tractor_feedback(
        COMPONENT(a->tractor), ahead, &references[TRACTOR_BODY], NULL, &plans[TRACTOR_BODY], resources));
    TIMED(a, TIMED_TRAILER, FEEDBACK, drawbar_trailer_feedback(
        COMPONENT(a->trailer), ahead, &references[TRAILER_BODY], &tractor, &plans[TRAILER_BODY], resources));
#endif
}

/* Adapt both commands to what is known of the actuators. */
static void adapt_commands(struct autopilot *a, const struct drawbar_estimate *ahead)
{
#ifdef DRAWBAR_IDENTIFIED
    struct drawbar_body_steering *steerings = a->made.steerings;

    drawbar_actuation_adapt(COMPONENT(a->actuation), ahead, a->known.joint_scale, &steerings[TRACTOR_BODY].command,
                            &steerings[TRAILER_BODY].command);
#else
    (void)a, (void)ahead;
#endif
}

/* Let the plans continue over samples that were left out. */
static void skip_controllers(struct autopilot *a, int samples)
{
#ifdef DRAWBAR_CENTRALISED
    drawbar_controller_skip(COMPONENT(a->controller), samples);
#else
    drawbar_tractor_skip(COMPONENT(a->tractor), samples);
    drawbar_trailer_skip(COMPONENT(a->trailer), samples);
#endif
}

static void prepare_actuation(struct autopilot *a)
{
#ifdef DRAWBAR_IDENTIFIED
    drawbar_actuation_ready(COMPONENT(a->actuation));
#else
    (void)a;
#endif
}

static void prepare_controllers(struct autopilot *a)
{
#ifdef DRAWBAR_CENTRALISED
    TIMED(a, TIMED_TRACTOR, PREPARATION, drawbar_controller_ready(COMPONENT(a->controller)));
#else
    TIMED(a, TIMED_TRACTOR, PREPARATION, drawbar_tractor_ready(COMPONENT(a->tractor)));
    TIMED(a, TIMED_TRAILER, PREPARATION, drawbar_trailer_ready(COMPONENT(a->trailer)));
#endif
}

#endif

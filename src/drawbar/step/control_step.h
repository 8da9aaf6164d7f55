/* One control step of an exported library, in the order of the block diagram: that of autopilot/autopilot.py, with the
 * supervision of autopilot/run.py. */
#ifndef DRAWBAR_CONTROL_STEP_H
#define DRAWBAR_CONTROL_STEP_H

#include <stddef.h>
#include "admission.h"
#include "components.h"
#include "status.h"
#include "verdicts.h"

/* The run is over: stop the vehicle, now and at every later sample. */
static int end_run(struct autopilot *a, int32_t status, struct drawbar_command *command)
{
    a->ended = status;
    a->diagnostics.gate = drawbar_gate_stop(COMPONENT(a->gate), a->time, command);
    return status;
}

/* There is no new command: repeat the last one, as long as that may be done. */
static int do_without(struct autopilot *a, int32_t status, struct drawbar_command *command)
{
    a->diagnostics.gate = drawbar_gate_hold(COMPONENT(a->gate), a->time, command);
    return a->begun && a->diagnostics.gate == STOPPED ? end_run(a, DRAWBAR_STOPPED, command) : status;
}

/* Let all start from the first measurement. Until it is complete the gate still knows the last run's command. */
static int begin_run(struct autopilot *a, const struct drawbar_measurement *first)
{
    drawbar_estimator_initialise(COMPONENT(a->estimator));
    drawbar_guidance_initialise(COMPONENT(a->guidance));
    drawbar_tractor_law_initialise(COMPONENT(a->tractor_law));
    drawbar_trailer_law_initialise(COMPONENT(a->trailer_law));
    drawbar_supervisor_initialise(COMPONENT(a->supervisor));
#ifdef DRAWBAR_DEAD_TIME
    drawbar_predictor_initialise(COMPONENT(a->predictor));
#endif
#ifdef DRAWBAR_CENTRALISED
    drawbar_controller_initialise(COMPONENT(a->controller));
#else
    drawbar_tractor_initialise(COMPONENT(a->tractor));
    drawbar_trailer_initialise(COMPONENT(a->trailer));
#endif
    if (drawbar_estimator_begin(COMPONENT(a->estimator), first) == BAD_INPUT)
        return DRAWBAR_POSITION;
    if (drawbar_guidance_begin(COMPONENT(a->guidance), &a->path, first))
        return DRAWBAR_START;
    drawbar_gate_begin(COMPONENT(a->gate), first);
    a->begun = 1;
    return DRAWBAR_OK;
}

/* Where the vehicle is when the next command begins to act, and at what speed plans take it from there. */
static void look_ahead(struct autopilot *a, struct drawbar_estimate *ahead)
{
#ifdef DRAWBAR_DEAD_TIME
    drawbar_predictor_ahead(COMPONENT(a->predictor), &a->estimate, ahead);
#else
    *ahead = a->estimate;
#endif
#ifdef DRAWBAR_PLANNED_SPEED
    if (ahead->speed < DRAWBAR_PLANNED_SPEED)
        ahead->speed = DRAWBAR_PLANNED_SPEED;
#endif
}

/* The command that acts during most of the sample that now begins. */
static void send(struct autopilot *a, const struct drawbar_command *command)
{
#ifdef DRAWBAR_DEAD_TIME
    drawbar_predictor_sent(COMPONENT(a->predictor), command, &a->acting);
#else
    a->acting = *command;
#endif
}

/* Both bodies' nominal plans. */
static void plan(struct autopilot *a, const struct drawbar_estimate *ahead,
                 const struct drawbar_body_reference *references, struct drawbar_body_plan *plans)
{
#ifdef DRAWBAR_CENTRALISED
    drawbar_controller_feedback(COMPONENT(a->controller), ahead, &references[0], &references[1], &plans[0], &plans[1],
                                a->work);
#else
    drawbar_tractor_feedback(COMPONENT(a->tractor), ahead, &references[0], NULL, &plans[0], a->work);
    drawbar_trailer_feedback(COMPONENT(a->trailer), ahead, &references[1], &plans[0], &plans[1], a->work);
#endif
}

/* Write down how one body is and how its command came about. */
static void diagnose(struct drawbar_body_diagnostics *body, const struct drawbar_body_reference *reference,
                     const struct drawbar_body_steering *steering, int32_t solver, int32_t fix)
{
    body->progress = reference->progress;
    body->lateral_error = reference->lateral_error;
    body->nominal = steering->nominal;
    body->ancillary = steering->ancillary;
    body->margin = steering->margin;
    body->saturated = steering->saturated;
    body->solver = solver;
    body->fix = fix;
}

/* The status of a step whose command was checked: the gravest of what there is to say. */
static int outcome(struct autopilot *a, int verdict, struct drawbar_command *command)
{
    const struct drawbar_diagnostics *d = &a->diagnostics;

    if (verdict == STOPPED)
        return end_run(a, DRAWBAR_STOPPED, command);
    if (verdict == REPEATED)
        return DRAWBAR_REFUSED;
    if (d->estimator != SOLVED || d->tractor.solver != SOLVED || d->trailer.solver != SOLVED)
        return DRAWBAR_SOLVER;
    if (verdict == LIMITED)
        return DRAWBAR_LIMITED;
    return a->late ? DRAWBAR_LATE : d->missing ? DRAWBAR_MEASUREMENT : DRAWBAR_OK;
}

/* Steer by both plans and both ancillary laws. */
static int steer(struct autopilot *a, const struct drawbar_body_reference *references,
                 const struct drawbar_body_plan *plans, struct drawbar_command *command)
{
    struct drawbar_diagnostics *d = &a->diagnostics;
    struct drawbar_body_steering tractor, trailer;

    drawbar_tractor_law_apply(COMPONENT(a->tractor_law), &plans[0], &tractor);
    drawbar_trailer_law_apply(COMPONENT(a->trailer_law), &plans[1], &trailer);
    diagnose(&d->tractor, &references[0], &tractor, plans[0].status, a->estimate.tractor_fix);
    diagnose(&d->trailer, &references[1], &trailer, plans[1].status, a->estimate.trailer_fix);
    d->estimator = a->estimate.status;
    const struct drawbar_command wanted = {a->time, tractor.command, trailer.command, DRAWBAR_SPEED};
    d->gate = drawbar_gate_check(COMPONENT(a->gate), &wanted, command);
    send(a, command);
    a->due = 1;
    return outcome(a, d->gate, command);
}

/* Estimate, plan, command. */
static int drive(struct autopilot *a, const struct drawbar_measurement *measurement, struct drawbar_command *command)
{
    struct drawbar_estimate ahead;
    struct drawbar_body_reference references[2];
    struct drawbar_body_plan plans[2];

    drawbar_estimator_update(COMPONENT(a->estimator), measurement, &a->estimate, a->work);
    look_ahead(a, &ahead);
    if (drawbar_guidance_reference(COMPONENT(a->guidance), &a->path, &ahead, &references[0], &references[1], a->work))
        return end_run(a, DRAWBAR_GUIDANCE, command);
    switch (drawbar_supervisor_watch(COMPONENT(a->supervisor), &a->estimate, &references[0])) {
    case OFF_COURSE:
        return end_run(a, DRAWBAR_OFF_COURSE, command);
    case BLIND:
        return end_run(a, DRAWBAR_BLIND, command);
    default:
        plan(a, &ahead, references, plans);
        return steer(a, references, plans, command);
    }
}

/* The feedback phase. */
static int feed_back(struct autopilot *a, const struct drawbar_measurement *measurement,
                     struct drawbar_command *command)
{
    const double elapsed = measurement->time - a->time;
    struct drawbar_measurement seen;

    if (a->ended)
        return end_run(a, a->ended, command);
    if (!isfinite(measurement->time) || (a->begun && !(elapsed > 0.0)))
        return do_without(a, DRAWBAR_TIME, command);
    a->time = measurement->time;
    if (a->begun && elapsed > DRAWBAR_PATIENCE + 0.5 * DRAWBAR_SAMPLE_TIME)
        return end_run(a, DRAWBAR_GAP, command);
    a->late = a->begun && elapsed > 1.5 * DRAWBAR_SAMPLE_TIME;
    a->diagnostics.missing = admit(measurement, &seen);
    if (!a->begun) {
        const int status = begin_run(a, &seen);
        if (status != DRAWBAR_OK)
            return do_without(a, status, command);
    }
    if (drawbar_guidance_finished(COMPONENT(a->guidance), &a->path))
        return end_run(a, DRAWBAR_FINISHED, command);
    return drive(a, &seen, command);
}

/* The preparation phase, after the command is out. */
static void prepare(struct autopilot *a)
{
    drawbar_estimator_ready(COMPONENT(a->estimator), &a->acting);
#ifdef DRAWBAR_CENTRALISED
    drawbar_controller_ready(COMPONENT(a->controller));
#else
    drawbar_tractor_ready(COMPONENT(a->tractor));
    drawbar_trailer_ready(COMPONENT(a->trailer));
#endif
}

#endif

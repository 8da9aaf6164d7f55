/* One control step, in the order of the block diagram; feed_back is the whole of it. Python drives this very file, and so
 * does every exported library. */
#ifndef DRAWBAR_CONTROL_STEP_H
#define DRAWBAR_CONTROL_STEP_H

#include <stddef.h>
#include <string.h>
#include "admission.h"
#include "components.h"
#include "pace.h"
#include "status.h"
#include "structure.h"

/* The run is over: stop the vehicle, now and at every later sample. */
static int end_run(struct autopilot *a, int32_t status, struct drawbar_command *command)
{
    a->ended = status;
    a->diagnostics.gate = drawbar_gate_stop(COMPONENT(a->gate), a->time, command);
    return status;
}

/* There is no new command: repeat the last one, as long as that is allowed. */
static int repeat_command(struct autopilot *a, int32_t status, struct drawbar_command *command)
{
    a->diagnostics.gate = drawbar_gate_hold(COMPONENT(a->gate), a->time, command);
    return a->started && a->diagnostics.gate == DRAWBAR_GATE_STOPPED ? end_run(a, DRAWBAR_STOPPED, command) : status;
}

/* Initialise everything from the first measurement. Until it is complete the vehicle stands. */
static int begin_run(struct autopilot *a, const struct drawbar_measurement *reported)
{
    struct drawbar_measurement first;

    initialise_components(a);
    offset_begin(&a->offset);
    drawbar_alignment_begin(COMPONENT(a->alignment), reported, &first);
    a->diagnostics.start_distance = (double)NAN;
    if (drawbar_estimator_begin(COMPONENT(a->estimator), &first) == BAD_INPUT)
        return DRAWBAR_POSITION;
    a->diagnostics.guidance = drawbar_guidance_begin(COMPONENT(a->guidance), &a->path, a->start, &first,
                                                     &a->diagnostics.start_distance);
    if (a->diagnostics.guidance != DRAWBAR_GUIDANCE_FINE)
        return DRAWBAR_START;
    drawbar_gate_begin(COMPONENT(a->gate), &first);
    drawbar_estimator_expected(COMPONENT(a->estimator), &a->made.estimate);
    a->made.estimate.time = first.time;
    pace_begin(a);
    a->started = 1;
    return DRAWBAR_OK;
}

/* Predict the estimate to when the next command begins to act, with the speed that plans start from. */
static void predict_ahead(struct autopilot *a, struct drawbar_estimate *ahead)
{
    const double least = pace_planned(a);

    predict_over_dead_time(a, ahead);
    if (ahead->speed < least)
        ahead->speed = least;
}

/* Go over to the wanted line, by a shift that begins beside the tractor, or at once where somebody else drives. */
static void shift_line(struct autopilot *a)
{
    const double tractor = a->diagnostics.tractor.progress, trailer = a->diagnostics.trailer.progress;

    if (a->released)
        offset_begin(&a->offset);
    else
        offset_advance(&a->offset, a->settings.shift_curvature, a->settings.shift_rate, tractor, fmin(tractor, trailer));
}

/* Fill in one body's diagnostics. */
static void diagnose(struct drawbar_body_diagnostics *body, const struct decisions *made, int i, int32_t fix)
{
    body->progress = made->references[i].progress;
    body->lateral_error = made->references[i].lateral_error;
    body->nominal = made->steerings[i].nominal;
    body->ancillary = made->steerings[i].ancillary;
    body->margin = made->steerings[i].margin;
    body->saturated = made->steerings[i].saturated;
    body->solver = made->plans[i].status;
    body->fix = fix;
}

/* Whether estimate and plans are solutions. */
static int solved(const struct autopilot *a)
{
    const struct decisions *made = &a->made;

    return made->estimate.status == SOLVED && made->plans[TRACTOR_BODY].status == SOLVED
        && made->plans[TRAILER_BODY].status == SOLVED;
}

/* Apply both ancillary laws. */
static void apply_laws(struct autopilot *a, const struct drawbar_estimate *ahead)
{
    struct drawbar_diagnostics *d = &a->diagnostics;
    struct decisions *made = &a->made;
    struct drawbar_body_steering *steerings = made->steerings;

    drawbar_tractor_law_apply(COMPONENT(a->tractor_law), &made->plans[TRACTOR_BODY], &steerings[TRACTOR_BODY]);
    drawbar_trailer_law_apply(COMPONENT(a->trailer_law), &made->plans[TRAILER_BODY], &steerings[TRAILER_BODY]);
    adapt_commands(a, ahead);
    diagnose(&d->tractor, made, TRACTOR_BODY, made->estimate.tractor_fix);
    diagnose(&d->trailer, made, TRAILER_BODY, made->estimate.trailer_fix);
}

/* The command of plans and laws; at a sample that is recomputed, the one that acted. */
static struct drawbar_command wanted_command(const struct autopilot *a)
{
    const struct drawbar_body_steering *steerings = a->made.steerings;

#ifdef DRAWBAR_HOSTED
    if (a->sent != NULL)
        return *a->sent;
#endif
    return (struct drawbar_command){
        a->time, steerings[TRACTOR_BODY].command, steerings[TRAILER_BODY].command, a->speed};
}

/* Steer by plans and laws; the gate checks the command. */
static int steer(struct autopilot *a, struct drawbar_command *command)
{
    struct drawbar_diagnostics *d = &a->diagnostics;
    const struct drawbar_command wanted = wanted_command(a);

    d->gate = drawbar_gate_check(COMPONENT(a->gate), &wanted, command);
    note_sent(a, command);
    a->due = 1;
    if (d->gate == DRAWBAR_GATE_STOPPED)
        return end_run(a, DRAWBAR_STOPPED, command);
    d->flags |= d->gate == DRAWBAR_GATE_LIMITED ? DRAWBAR_LIMITED : 0;
    return d->gate == DRAWBAR_GATE_REPEATED ? DRAWBAR_REFUSED : d->flags;
}

/* Follow a vehicle that somebody else drives. The command is its present steering, with speed zero; estimates and plans
 * continue from what the vehicle does, so that an engagement begins there. */
static int follow_driver(struct autopilot *a, struct drawbar_command *command)
{
    const struct drawbar_estimate *now = &a->made.estimate;
    struct drawbar_measurement wheels = {0};
    struct drawbar_command driven;

    wheels.time = a->time;
    wheels.tractor_steering = now->tractor_steering;
    wheels.trailer_steering = now->trailer_steering / (1.0 + a->known.joint_scale);
    drawbar_gate_begin(COMPONENT(a->gate), &wheels);
    a->diagnostics.gate = drawbar_gate_stand(COMPONENT(a->gate), a->time, command);
    driven = *command;
    driven.speed = pace_follow(a, now->speed);
    note_sent(a, &driven);
    initialise_controllers(a);
    drawbar_guidance_rejoin(COMPONENT(a->guidance));
    a->due = 1;
    a->diagnostics.speed = command->speed;
    a->diagnostics.flags |= DRAWBAR_RELEASED;
    return a->diagnostics.flags;
}

/* Update the estimate by a measurement, which is aligned for that, after so many samples that were left out. Returns the status
 * that ends the run, or 0. */
static int update_estimate(struct autopilot *a, int left_out, const struct drawbar_measurement *measurement,
                           struct solver_resources *resources, struct drawbar_measurement *aligned)
{
    struct drawbar_estimate *now = &a->made.estimate, expected;

    int ended = identify(a, measurement);
    if (ended)
        return ended;
    drawbar_estimator_expected(COMPONENT(a->estimator), &expected);
    expected.time = now->time + (1 + left_out) * a->settings.sample_time;
    ended = drawbar_alignment_apply(COMPONENT(a->alignment), measurement, now, &expected, aligned);
    if (ended)
        return ended;
    drawbar_alignment_report(COMPONENT(a->alignment), &a->known);
    correct_body_lag(a, aligned);
    TIMED(a, TIMED_ESTIMATOR, FEEDBACK, drawbar_estimator_update(COMPONENT(a->estimator), aligned, now, resources));
    a->diagnostics.estimator = now->status;
    return 0;
}

/* Look for what ends the run: off the path, blind, or contradicted by a sensor. Returns that status, or 0. */
static int watch_run(struct autopilot *a, const struct drawbar_measurement *measurement,
                     const struct drawbar_measurement *aligned)
{
    const struct drawbar_estimate *now = &a->made.estimate;
    const struct drawbar_body_reference *tractor = &a->made.references[TRACTOR_BODY];
    double departure;
    int ended;

    switch (drawbar_run_monitor_watch(COMPONENT(a->run_monitor), now, tractor, a->released)) {
    case OFF_COURSE:
        return DRAWBAR_OFF_COURSE;
    case BLIND:
        return DRAWBAR_BLIND;
    default:
        drawbar_alignment_departure(COMPONENT(a->alignment), &departure);
        ended = drawbar_sanity_judge(COMPONENT(a->sanity), measurement, aligned, now, tractor,
                                     &a->made.references[TRAILER_BODY], departure, &a->sane);
        return ended == DRAWBAR_JUMPED && a->released ? 0 : ended; /* an engagement begins where the vehicle is then */
    }
}

/* Estimate, plan and command, after so many samples that were left out. */
static int drive(struct autopilot *a, int left_out, const struct drawbar_measurement *measurement,
                 struct drawbar_command *command)
{
    struct solver_resources resources = {a->work, (int32_t)a->settings.iterations - left_out};
    struct decisions *made = &a->made;
    struct drawbar_diagnostics *d = &a->diagnostics;
    struct drawbar_measurement aligned;
    struct drawbar_estimate ahead;

    int ended = update_estimate(a, left_out, measurement, &resources, &aligned);
    if (ended)
        return end_run(a, ended, command);
    a->reached = WITH_ESTIMATE;
    predict_ahead(a, &ahead);
    d->guidance = drawbar_guidance_reference(COMPONENT(a->guidance), &a->path, &ahead, &made->references[TRACTOR_BODY],
                                             &made->references[TRAILER_BODY], a->work);
    if (d->guidance != DRAWBAR_GUIDANCE_FINE)
        return end_run(a, DRAWBAR_GUIDANCE, command);
    a->reached = WITH_REFERENCES;
    ended = watch_run(a, measurement, &aligned);
    if (ended)
        return end_run(a, ended, command);
    plan(a, &ahead, &resources);
    a->reached = WITH_PLANS;
    ended = pace_step(a, solved(a));
    if (ended)
        return end_run(a, ended, command);
    apply_laws(a, &ahead);
    shift_line(a);
    return a->released ? follow_driver(a, command) : steer(a, command);
}

/* Catch up on samples that were left out: nothing was measured, and the last command continued to act. */
static void catch_up(struct autopilot *a, int samples)
{
    struct drawbar_command last;

    if (samples == 0)
        return;
    for (int i = 0; i < samples; ++i) {
        drawbar_gate_skip(COMPONENT(a->gate), &last);
        note_sent(a, &last);
        drawbar_estimator_skip(COMPONENT(a->estimator), &a->acting);
    }
    skip_controllers(a, samples);
}

/* The feedback phase. */
static int feed_back(struct autopilot *a, const struct drawbar_measurement *measurement,
                     struct drawbar_command *command)
{
    const double elapsed = measurement->time - a->time;
    int left_out = 0;
    struct drawbar_diagnostics *d = &a->diagnostics;
    struct drawbar_measurement admitted;

    d->flags = d->missing = 0;
    a->path.offset = &a->offset;           /* set anew, as the caller may have moved the state */
    a->reached = WITH_NOTHING;
    if (a->ended)
        return end_run(a, a->ended, command);
    if (!isfinite(measurement->time) || (a->started && !(elapsed > 0.0)))
        return repeat_command(a, DRAWBAR_TIME, command);
    a->time = measurement->time;
    if (a->started && elapsed > a->settings.patience + 0.5 * a->settings.sample_time)
        return end_run(a, DRAWBAR_GAP, command);
    d->missing = admit(measurement, &admitted);
    d->flags |= d->missing ? DRAWBAR_MEASUREMENT : 0;
    if (!a->started) {
        const int status = begin_run(a, &admitted);
        if (status != DRAWBAR_OK) {
            d->gate = drawbar_gate_stop(COMPONENT(a->gate), a->time, command);
            return status;
        }
    } else {
        left_out = pace_left_out(a, elapsed);
        if (pace_is_of_another_rate(a))
            return end_run(a, DRAWBAR_RATE, command);
        catch_up(a, left_out);
    }
    if (drawbar_guidance_finished(COMPONENT(a->guidance), &a->path))
        return end_run(a, DRAWBAR_FINISHED, command);
    return drive(a, left_out, &admitted, command);
}

/* The preparation phase, after the command has been sent. */
static void prepare(struct autopilot *a)
{
    prepare_actuation(a);
    TIMED(a, TIMED_ESTIMATOR, PREPARATION, drawbar_estimator_ready(COMPONENT(a->estimator), &a->acting));
    prepare_controllers(a);
}

#endif

/* Hosted step: what Python's own library offers besides drawbar.h; memory and numbers are the caller's, and each step
 * can be recorded. An exported library has none of this. */
#ifndef DRAWBAR_HOSTED_STEP_H
#define DRAWBAR_HOSTED_STEP_H

#include "components.h"

#define DEVIATIONS_RECORDED 4
#define PREDICTED 1024.0                   /* places in a metre or radian that predictions are recorded to */
#define DERIVED 0x1p20                     /* places in a metre, radian or second that references, deviations from a nominal
                                            * state, margins and what is identified are recorded to */
#define TIMES_RECORDED 0x1p30              /* places in a second that the solvers' times are */

struct recorded_place {
    double progress, lateral_error, closest[4], line[2];
};

/* Predictions are in single precision: they are half of a record. */
struct recorded_plan {
    double steering;
    float poses[DRAWBAR_STAGES + 1][3], steerings[DRAWBAR_STAGES];
    double deviation[DEVIATIONS_RECORDED];
    int32_t status, deviations;
};

/* The newest step, as StepRecord declares it, numbers smaller than a double last (layout.py). What it did not come to is
 * NaN. DRAWBAR_STAGES is the controllers' horizon. */
struct drawbar_record {
    struct drawbar_measurement measurement;        /* Python's, as is the command: drawbar_feedback is called with them */
    struct drawbar_estimate estimate;
    struct {
        double time;
        struct recorded_place bodies[BOTH_BODIES];
    } reference;
    struct {
        double time;
        struct recorded_plan bodies[BOTH_BODIES];
    } plan;
    struct drawbar_body_steering steerings[BOTH_BODIES];
    struct drawbar_command command;
    struct drawbar_truth truth;                    /* Python's, as is the number of the step */
    double times[3][2];
    struct drawbar_actuation actuation;
    int32_t step, solver_failures, gate, status, flags;
};

static void unknown(double *values, size_t bytes)
{
    for (size_t i = 0; i < bytes / sizeof *values; ++i)
        values[i] = (double)NAN;
}

/* The nearest of so many places in one, a power of two: what has few digits takes few bytes of a log. */
static double on_grid(double value, double places)
{
    return rint(value * places) / places;
}

static void to_derived(double *values, size_t bytes)
{
    for (size_t i = 0; i < bytes / sizeof *values; ++i)
        values[i] = on_grid(values[i], DERIVED);
}

static void record_prediction(float *recorded, const double *made, size_t bytes)
{
    for (size_t i = 0; i < bytes / sizeof *recorded; ++i)
        recorded[i] = (float)(made != NULL ? on_grid(made[i], PREDICTED) : (double)NAN);
}

static void record_place(const struct autopilot *a, int i, struct recorded_place *place)
{
    const struct drawbar_body_reference *made = &a->made.references[i];
    double beside[4];

    if (a->reached < WITH_REFERENCES) {
        unknown((double *)place, sizeof *place);
        return;
    }
    place->progress = made->progress;
    place->lateral_error = made->lateral_error;
    memcpy(place->closest, made->closest, sizeof place->closest);
    drawbar_path_sample(&a->path, made->progress, beside);
    memcpy(place->line, beside, sizeof place->line);
    to_derived((double *)place, sizeof *place);
}

static void record_plan(const struct autopilot *a, int i, struct recorded_plan *plan)
{
    static const struct drawbar_body_plan none = {.steering = (double)NAN, .status = BAD_INPUT};
    const struct drawbar_body_plan *made = a->reached < WITH_PLANS ? &none : &a->made.plans[i];

    plan->steering = made->steering;
    plan->status = made->status;
    plan->deviations = made->deviations;
    unknown(plan->deviation, sizeof plan->deviation);
    if (made->deviations > 0)
        memcpy(plan->deviation, made->deviation, (size_t)made->deviations * sizeof *made->deviation);
    to_derived(plan->deviation, sizeof plan->deviation);
    record_prediction(&plan->poses[0][0], made->poses != NULL ? &made->poses[0][0] : NULL, sizeof plan->poses);
    record_prediction(plan->steerings, made->steerings, sizeof plan->steerings);
}

static void record_steering(const struct autopilot *a, int i, struct drawbar_body_steering *steering)
{
    *steering = a->made.steerings[i];
    steering->margin = on_grid(steering->margin, DERIVED);
    if (a->reached < WITH_PLANS) {
        unknown(&steering->nominal, offsetof(struct drawbar_body_steering, saturated));
        steering->saturated = 0;
    }
}

static int solver_failures(const struct drawbar_record *record, int estimator)
{
    int failures = estimator != SOLVED;

    for (int i = 0; i < BOTH_BODIES; ++i)
        failures += record->plan.bodies[i].status != SOLVED;
    return failures;
}

DRAWBAR_API int drawbar_get_record(const struct drawbar_state *state, struct drawbar_record *record)
{
    const struct autopilot *a = (const struct autopilot *)state;

    record->estimate = a->made.estimate;
    if (a->reached < WITH_ESTIMATE)
        unknown(&record->estimate.time, offsetof(struct drawbar_estimate, status));
    record->reference.time = record->plan.time = record->estimate.time;
    for (int i = 0; i < BOTH_BODIES; ++i) {
        record_place(a, i, &record->reference.bodies[i]);
        record_plan(a, i, &record->plan.bodies[i]);
        record_steering(a, i, &record->steerings[i]);
    }
    for (int i = 0; i < 3 * 2; ++i)
        record->times[i / 2][i % 2] = on_grid(a->times[i / 2][i % 2], TIMES_RECORDED);
    record->actuation = a->known;
    to_derived((double *)&record->actuation, sizeof record->actuation);
    record->solver_failures = solver_failures(record, a->diagnostics.estimator);
    record->gate = a->diagnostics.gate;
    record->status = a->diagnostics.status;
    record->flags = a->diagnostics.flags;
    return DRAWBAR_OK;
}

/* The feedback of a sample that is computed again: in the place of its own command goes the one that was sent then. */
DRAWBAR_API int drawbar_feedback_again(struct drawbar_state *state, const struct drawbar_measurement *measurement,
                                       const struct drawbar_command *sent, struct drawbar_command *command)
{
    struct autopilot *a = (struct autopilot *)state;

    a->sent = sent;
    const int status = drawbar_feedback(state, measurement, command);
    a->sent = NULL;
    return status;
}

DRAWBAR_API int32_t drawbar_record_size(void)
{
    return (int32_t)sizeof(struct drawbar_record);
}

/* Give a state its memory and its numbers; then drawbar_init may be called.
 *
 * memory: of the components and their scratch memory, in the order of struct autopilot. Each component has two structures
 * in its memory: the one at work, and behind it one with its settings, as which every run begins. */
DRAWBAR_API int drawbar_host(struct drawbar_state *state, double *const *memory, const struct step_settings *settings)
{
    struct autopilot *a = (struct autopilot *)state;
    const size_t first = offsetof(struct autopilot, alignment), last = offsetof(struct autopilot, work);

    memcpy((char *)a + first, memory, last + sizeof a->work - first);
    a->settings = *settings;
    return DRAWBAR_OK;
}

#endif

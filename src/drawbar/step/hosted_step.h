/* Hosted step: what Python's own library offers besides drawbar.h; memory and numbers are the caller's, and each step
 * can be recorded. An exported library has none of this. */
#ifndef DRAWBAR_HOSTED_STEP_H
#define DRAWBAR_HOSTED_STEP_H

#include "components.h"

#define DEVIATIONS_RECORDED 4
#define PREDICTED 1e4                      /* predictions are recorded to its inverse, m and rad */

/* How a body's reference and plan are recorded, without what has the length of the horizon. */
struct recorded_reference {
    double progress, lateral_error, closest[4];
};

struct recorded_plan {
    double steering, deviation[DEVIATIONS_RECORDED];
    int32_t status, deviations;
};

/* The newest step; what it did not come to is NaN. DRAWBAR_STAGES is the controllers' horizon. */
struct drawbar_record {
    struct drawbar_estimate estimate;
    struct drawbar_diagnostics diagnostics;
    struct drawbar_body_steering steerings[BOTH_BODIES];
    struct recorded_reference references[BOTH_BODIES];
    struct recorded_plan plans[BOTH_BODIES];
    double times[3][2];
    struct drawbar_actuation actuation;
    double poses[BOTH_BODIES][DRAWBAR_STAGES + 1][3];
    double planned[BOTH_BODIES][DRAWBAR_STAGES];
};

static void unknown(double *values, size_t bytes)
{
    for (size_t i = 0; i < bytes / sizeof *values; ++i)
        values[i] = NAN;
}

/* Predictions are a third of a record; their digits beyond would be half of a log. */
static void record_prediction(double *recorded, const double *made, size_t bytes)
{
    for (size_t i = 0; i < bytes / sizeof *recorded; ++i)
        recorded[i] = rint(made[i] * PREDICTED) / PREDICTED;
}

static void record_reference(const struct autopilot *a, int i, struct drawbar_record *record)
{
    const struct drawbar_body_reference *made = &a->made.references[i];
    struct recorded_reference *reference = &record->references[i];

    if (a->reached < WITH_REFERENCES) {
        unknown((double *)reference, sizeof *reference);
        return;
    }
    reference->progress = made->progress;
    reference->lateral_error = made->lateral_error;
    memcpy(reference->closest, made->closest, sizeof reference->closest);
}

static void record_plan(const struct autopilot *a, int i, struct drawbar_record *record)
{
    const struct drawbar_body_plan *made = &a->made.plans[i];
    struct recorded_plan *plan = &record->plans[i];

    if (a->reached < WITH_PLANS) {
        unknown(&record->poses[i][0][0], sizeof record->poses[i]);
        unknown(record->planned[i], sizeof record->planned[i]);
        unknown(&plan->steering, sizeof plan->steering);
        plan->status = BAD_INPUT;
        plan->deviations = 0;
        return;
    }
    plan->steering = made->steering;
    plan->status = made->status;
    plan->deviations = made->deviations;
    if (made->deviations > 0)
        memcpy(plan->deviation, made->deviation, (size_t)made->deviations * sizeof *made->deviation);
    record_prediction(&record->poses[i][0][0], &made->poses[0][0], sizeof record->poses[i]);
    record_prediction(record->planned[i], made->steerings, sizeof record->planned[i]);
}

static void record_steering(const struct autopilot *a, int i, struct drawbar_record *record)
{
    record->steerings[i] = a->made.steerings[i];
    if (a->reached < WITH_PLANS) {
        unknown(&record->steerings[i].nominal, offsetof(struct drawbar_body_steering, saturated));
        record->steerings[i].saturated = 0;
    }
}

DRAWBAR_API int drawbar_get_record(const struct drawbar_state *state, struct drawbar_record *record)
{
    const struct autopilot *a = (const struct autopilot *)state;

    record->estimate = a->made.estimate;
    if (a->reached < WITH_ESTIMATE)
        unknown(&record->estimate.time, offsetof(struct drawbar_estimate, status));
    record->diagnostics = a->diagnostics;
    for (int i = 0; i < BOTH_BODIES; ++i) {
        record_steering(a, i, record);
        record_reference(a, i, record);
        record_plan(a, i, record);
    }
    memcpy(record->times, a->times, sizeof record->times);
    record->actuation = a->known;
    return DRAWBAR_OK;
}

DRAWBAR_API int32_t drawbar_record_size(void)
{
    return (int32_t)sizeof(struct drawbar_record);
}

/* Give a state its memory and its numbers; then drawbar_init may be called.
 *
 * memory: of the components and of what they borrow, in the order of struct autopilot. Each component has two structures
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

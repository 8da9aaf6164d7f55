/* Components that do what the measurement says, so that a test sees what the exported step makes of it:
 *
 *     tractor_x: progress, trailer_x: the controllers' status, tractor_y: lateral error, trailer_y: the estimator's status,
 *     hitch_angle: the fixes' status, speed: guidance's status, both steering angles: the commands
 *
 * They leave nothing as it was in the memory that they share.
 */
#include <string.h>
#include "components.h"
#include "solver_resources.h"

#define MISSING 5

int32_t iterations;                        /* of interior points, that the newest step has given its estimator */
char calls[64];                            /* first letters of the components in the order of their calls */

static struct drawbar_measurement seen;
static const double samples[2][4];

static int32_t status_of(double value)
{
    return isnan(value) ? 0 : (int32_t)value;
}

static void called(char letter)
{
    const size_t length = strlen(calls);

    if (length + 1 < sizeof calls)
        calls[length] = letter;
}

#define INITIALISE(unit)                                                                                     \
    int drawbar_##unit##_initialise(struct component *component)                                                       \
    {                                                                                                        \
        (void)component;                                                                                          \
        return 0;                                                                                            \
    }

INITIALISE(alignment)
INITIALISE(estimator)
INITIALISE(predictor)
INITIALISE(guidance)
INITIALISE(tractor)
INITIALISE(trailer)
INITIALISE(tractor_law)
INITIALISE(trailer_law)
INITIALISE(sanity)

int drawbar_sanity_judge(struct component *component, const struct drawbar_measurement *reported,
                         const struct drawbar_measurement *measurement, const struct drawbar_estimate *estimate,
                         const struct drawbar_body_reference *tractor, const struct drawbar_body_reference *trailer,
                         double departure, double *share)
{
    (void)component;
    (void)reported;
    (void)departure;
    (void)estimate;
    (void)tractor;
    (void)trailer;
    called(measurement->time == seen.time ? 'w' : '?');
    *share = 1.0;
    return 0;
}

int drawbar_alignment_begin(struct component *component, const struct drawbar_measurement *first,
                            struct drawbar_measurement *aligned)
{
    (void)component;
    called('m');
    *aligned = *first;
    return 0;
}

void drawbar_alignment_report(const struct component *component, struct drawbar_actuation *found)
{
    (void)component;
    (void)found;
}

void drawbar_alignment_departure(const struct component *component, double *departure)
{
    (void)component;
    *departure = (double)NAN;
}

int drawbar_alignment_apply(struct component *component, const struct drawbar_measurement *measurement,
                            const struct drawbar_estimate *last, const struct drawbar_estimate *expected,
                            struct drawbar_measurement *aligned)
{
    const double ahead = expected->time - measurement->time;

    (void)component;
    called(expected->speed == 7.0 && last->time <= measurement->time && fabs(ahead) < 0.25 ? 'M' : '?');
    *aligned = *measurement;
    return 0;
}

int drawbar_estimator_expected(struct component *component, struct drawbar_estimate *estimate)
{
    (void)component;
    memset(estimate, 0, sizeof *estimate);
    estimate->speed = 7.0;
    return 0;
}

int drawbar_estimator_begin(struct component *component, const struct drawbar_measurement *first)
{
    (void)component;
    called('b');
    memset(&seen, 0, sizeof seen);
    return isnan(first->tractor_x) ? MISSING : 0;
}

int drawbar_estimator_update(struct component *component, const struct drawbar_measurement *measurement,
                             struct drawbar_estimate *estimate, struct solver_resources *resources)
{
    (void)component;
    memset(resources->work, 0xFF, DRAWBAR_WORK_SIZE);
    iterations = resources->iterations;
    called('e');
    seen = *measurement;
    memset(estimate, 0, sizeof *estimate);
    estimate->time = seen.time;
    estimate->status = status_of(seen.trailer_y);
    estimate->tractor_fix = estimate->trailer_fix = status_of(seen.hitch_angle);
    return estimate->status;
}

int drawbar_estimator_ready(struct component *component, const struct drawbar_command *acting)
{
    (void)component;
    called(acting->speed == 1.5 ? 'E' : '?');
    return 0;
}

int drawbar_estimator_skip(struct component *component, const struct drawbar_command *acting)
{
    (void)component;
    (void)acting;
    called('x');
    return 0;
}

int drawbar_predictor_ahead(struct component *component, const struct drawbar_estimate *now, struct drawbar_estimate *then)
{
    (void)component;
    called('a');
    *then = *now;
    then->time += 1.0;
    return 0;
}

int drawbar_predictor_measured(struct component *component, const struct drawbar_estimate *last,
                               struct drawbar_measurement *measurement, struct drawbar_actuation *told)
{
    (void)component;
    (void)told;
    called(last->time <= measurement->time ? 'P' : '?');
    return 0;
}

int drawbar_predictor_sent(struct component *component, const struct drawbar_command *newest, struct drawbar_command *acting)
{
    (void)component;
    called('s');
    *acting = *newest;
    acting->speed += 0.5;
    return 0;
}

int drawbar_guidance_begin(struct component *component, const struct path *path, double start,
                           const struct drawbar_measurement *first, double *distance)
{
    (void)component;
    (void)path;
    called('B');
    *distance = fabs(start - first->tractor_x);
    return first->tractor_x < start;
}

int drawbar_guidance_change(struct component *component, const struct path *path, double start,
                            const struct drawbar_estimate *estimate)
{
    (void)component;
    (void)path;
    (void)estimate;
    called('C');
    return start > 5.0;
}

int drawbar_guidance_reference(struct component *component, const struct path *path, const struct drawbar_estimate *estimate,
                               struct drawbar_body_reference *tractor, struct drawbar_body_reference *trailer,
                               void *work)
{
    const struct drawbar_body_reference reference = {seen.tractor_x, seen.tractor_y, {0.0, 0.0, 0.0, 0.0}, samples};

    (void)component;
    (void)path;
    memset(work, 0xFF, DRAWBAR_WORK_SIZE);
    called(estimate->time == seen.time + 1.0 ? 'g' : '?');
    *tractor = *trailer = reference;
    return status_of(seen.speed);
}

void drawbar_guidance_rejoin(struct component *component)
{
    (void)component;
}

int drawbar_guidance_finished(struct component *component, const struct path *path)
{
    (void)component;
    return seen.tractor_x >= path_length(path);
}

static int plan(double steering, struct drawbar_body_plan *made)
{
    memset(made, 0, sizeof *made);
    made->steering = steering;
    made->status = status_of(seen.trailer_x);
    return made->status;
}

int drawbar_tractor_feedback(struct component *component, const struct drawbar_estimate *estimate,
                             const struct drawbar_body_reference *reference,
                             const struct drawbar_neighbour *neighbour, struct drawbar_body_plan *made,
                             struct solver_resources *resources)
{
    (void)component;
    (void)estimate;
    (void)reference;
    memset(resources->work, 0xFF, DRAWBAR_WORK_SIZE);
    called(neighbour == NULL ? 't' : '?');
    return plan(seen.tractor_steering, made);
}

int drawbar_trailer_feedback(struct component *component, const struct drawbar_estimate *estimate,
                             const struct drawbar_body_reference *reference,
                             const struct drawbar_neighbour *neighbour, struct drawbar_body_plan *made,
                             struct solver_resources *resources)
{
    (void)component;
    (void)estimate;
    (void)reference;
    memset(resources->work, 0xFF, DRAWBAR_WORK_SIZE);
    called(neighbour != NULL && neighbour->plan != NULL ? 'r' : '?');
    return plan(seen.trailer_steering, made);
}

int drawbar_tractor_ready(struct component *component)
{
    (void)component;
    called('T');
    return 0;
}

int drawbar_trailer_ready(struct component *component)
{
    (void)component;
    called('R');
    return 0;
}

int drawbar_tractor_skip(struct component *component, int left_out)
{
    (void)component;
    (void)left_out;
    called('y');
    return 0;
}

int drawbar_trailer_skip(struct component *component, int left_out)
{
    (void)component;
    (void)left_out;
    called('z');
    return 0;
}

static int apply(const struct drawbar_body_plan *made, struct drawbar_body_steering *steering)
{
    memset(steering, 0, sizeof *steering);
    steering->nominal = steering->command = made->steering;
    steering->margin = 0.25;
    return 0;
}

int drawbar_tractor_law_apply(const struct component *component, const struct drawbar_body_plan *made,
                              struct drawbar_body_steering *steering)
{
    (void)component;
    return apply(made, steering);
}

int drawbar_trailer_law_apply(const struct component *component, const struct drawbar_body_plan *made,
                              struct drawbar_body_steering *steering)
{
    (void)component;
    return apply(made, steering);
}

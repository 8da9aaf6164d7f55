/* The components of an autopilot, each a translation unit of its own, and all that one autopilot remembers.
 *
 * A component's memory is given to it; its content is its own business. `work`, or for those with a solver `resources`,
 * is its own for the length of the call; then others use the same memory.
 *
 * drawbar_components.h is generated. It defines which components there are (DRAWBAR_CENTRALISED, DRAWBAR_IDENTIFIED,
 * DRAWBAR_DEAD_TIME) and, in an exported library, the bytes that each needs (DRAWBAR_<COMPONENT>_SIZE), the bytes of `work`
 * (DRAWBAR_WORK_SIZE) and the numbers of struct step_settings (DRAWBAR_STEP_SETTINGS). In Python's own library
 * (DRAWBAR_HOSTED) memory and numbers are the caller's; see hosted_step.h.
 */
#ifndef DRAWBAR_STEP_COMPONENTS_H
#define DRAWBAR_STEP_COMPONENTS_H

#include "drawbar.h"
#include "drawbar_components.h"
#include "solver_resources.h"
#include "neighbour.h"
#include "path.h"
#include "signals.h"

#ifdef DRAWBAR_HOSTED
#define MEMORY(memory, size) double *memory
#else
#define MEMORY(memory, size) double memory[((size) + 7) / 8]   /* for structures of doubles, so aligned as one */
#endif
#define COMPONENT(memory) ((struct component *)(memory))

struct component;                          /* another one in each unit */

/* What there can be; a library has the functions of its own components. */

int drawbar_alignment_initialise(struct component *component);
int drawbar_alignment_begin(struct component *component, const struct drawbar_measurement *first,
                            struct drawbar_measurement *aligned);
void drawbar_alignment_departure(const struct component *component, double *departure);
void drawbar_alignment_report(const struct component *component, struct drawbar_actuation *found);
int drawbar_alignment_apply(struct component *component, const struct drawbar_measurement *measurement,
                            const struct drawbar_estimate *last, const struct drawbar_estimate *expected,
                            struct drawbar_measurement *aligned);

int drawbar_estimator_initialise(struct component *component);
int drawbar_estimator_begin(struct component *component, const struct drawbar_measurement *first);
int drawbar_estimator_expected(struct component *component, struct drawbar_estimate *estimate);
int drawbar_estimator_update(struct component *component, const struct drawbar_measurement *measurement,
                             struct drawbar_estimate *estimate, struct solver_resources *resources);
int drawbar_estimator_ready(struct component *component, const struct drawbar_command *acting);
int drawbar_estimator_skip(struct component *component, const struct drawbar_command *acting);

int drawbar_estimator_actuation(struct component *component, const struct drawbar_actuation *known);
int drawbar_actuation_initialise(struct component *component);
int drawbar_actuation_measured(struct component *component, const struct drawbar_measurement *measurement);
int drawbar_actuation_sent(struct component *component, struct drawbar_command *command);
int drawbar_actuation_ready(struct component *component);
int drawbar_actuation_adapt(const struct component *component, const struct drawbar_estimate *then, double joint_scale,
                            double *tractor, double *trailer);
int drawbar_actuation_report(const struct component *component, struct drawbar_actuation *report);
int drawbar_predictor_actuation(struct component *component, const struct drawbar_actuation *known);
int drawbar_controller_actuation(struct component *component, const struct drawbar_actuation *known);
int drawbar_tractor_actuation(struct component *component, const struct drawbar_actuation *known);
int drawbar_trailer_actuation(struct component *component, const struct drawbar_actuation *known);

int drawbar_predictor_initialise(struct component *component);
int drawbar_predictor_ahead(struct component *component, const struct drawbar_estimate *now,
                            struct drawbar_estimate *then);
int drawbar_predictor_measured(struct component *component, const struct drawbar_estimate *last,
                               struct drawbar_measurement *measurement, struct drawbar_actuation *report);
int drawbar_predictor_sent(struct component *component, const struct drawbar_command *newest,
                           struct drawbar_command *acting);

int drawbar_guidance_initialise(struct component *component);
int drawbar_guidance_begin(struct component *component, const struct path *path, double start,
                           const struct drawbar_measurement *first, double *distance);
int drawbar_guidance_change(struct component *component, const struct path *path, double start,
                            const struct drawbar_estimate *estimate);
int drawbar_guidance_reference(struct component *component, const struct path *path,
                               const struct drawbar_estimate *estimate, struct drawbar_body_reference *tractor,
                               struct drawbar_body_reference *trailer, void *work);
void drawbar_guidance_rejoin(struct component *component);
int drawbar_guidance_finished(struct component *component, const struct path *path);

int drawbar_controller_initialise(struct component *component);
int drawbar_controller_feedback(struct component *component, const struct drawbar_estimate *estimate,
                                const struct drawbar_body_reference *tractor_reference,
                                const struct drawbar_body_reference *trailer_reference,
                                struct drawbar_body_plan *tractor, struct drawbar_body_plan *trailer,
                                struct solver_resources *resources);
int drawbar_controller_ready(struct component *component);
int drawbar_controller_skip(struct component *component, int samples);
int drawbar_tractor_initialise(struct component *component);
int drawbar_tractor_feedback(struct component *component, const struct drawbar_estimate *estimate,
                             const struct drawbar_body_reference *reference, const struct drawbar_neighbour *neighbour,
                             struct drawbar_body_plan *plan, struct solver_resources *resources);
int drawbar_tractor_ready(struct component *component);
int drawbar_tractor_skip(struct component *component, int samples);
int drawbar_trailer_initialise(struct component *component);
int drawbar_trailer_feedback(struct component *component, const struct drawbar_estimate *estimate,
                             const struct drawbar_body_reference *reference, const struct drawbar_neighbour *neighbour,
                             struct drawbar_body_plan *plan, struct solver_resources *resources);
int drawbar_trailer_ready(struct component *component);
int drawbar_trailer_skip(struct component *component, int samples);

int drawbar_tractor_law_initialise(struct component *component);
int drawbar_tractor_law_apply(const struct component *component, const struct drawbar_body_plan *plan,
                              struct drawbar_body_steering *steering);
int drawbar_trailer_law_initialise(struct component *component);
int drawbar_trailer_law_apply(const struct component *component, const struct drawbar_body_plan *plan,
                              struct drawbar_body_steering *steering);

int drawbar_sanity_initialise(struct component *component);
int drawbar_sanity_judge(struct component *component, const struct drawbar_measurement *reported,
                         const struct drawbar_measurement *measurement, const struct drawbar_estimate *estimate,
                         const struct drawbar_body_reference *tractor, const struct drawbar_body_reference *trailer,
                         double departure, double *share);

int drawbar_gate_initialise(struct component *component);
int drawbar_gate_begin(struct component *component, const struct drawbar_measurement *first);
int drawbar_gate_stop(struct component *component, double time, struct drawbar_command *given);
int drawbar_gate_stand(const struct component *component, double time, struct drawbar_command *given);
int drawbar_gate_hold(struct component *component, double time, struct drawbar_command *given);
int drawbar_gate_check(struct component *component, const struct drawbar_command *wanted,
                       struct drawbar_command *given);
int drawbar_gate_skip(struct component *component, struct drawbar_command *given);

int drawbar_run_monitor_initialise(struct component *component);
void drawbar_run_monitor_rejoin(struct component *component);
int drawbar_run_monitor_watch(struct component *component, const struct drawbar_estimate *estimate,
                             const struct drawbar_body_reference *tractor, int released);

enum { TRACTOR_BODY, TRAILER_BODY, BOTH_BODIES };

/* The step's own settings. */
struct step_settings {
    double sample_time;                    /* s */
    double speed;                          /* set speed, and the largest that drawbar_set_speed takes, m/s */
    double planned_speed;                  /* least speed that plans reckon with, m/s; -INFINITY: none */
    double acceleration;                   /* fastest change of the speed that is commanded, m/s^2 */
    double patience;                       /* for how long a command may act without a new one, s */
    double endurance;                      /* for how long the vehicle may be driven on predictions alone, s */
    double curvature;                      /* tightest line that may be driven beside a path, 1/m */
    double shift_curvature;                /* largest of a shift from one line to the next beside it, 1/m */
    double shift_rate;                     /* largest change of that along the way, 1/m^2 */
    double iterations;                     /* of interior points, for all solvers of a step */
};

/* What the newest step decided, one component after the other. */
struct decisions {
    struct drawbar_estimate estimate;
    struct drawbar_body_reference references[BOTH_BODIES];
    struct drawbar_body_plan plans[BOTH_BODIES];
    struct drawbar_body_steering steerings[BOTH_BODIES];
};

enum { WITH_NOTHING, WITH_ESTIMATE, WITH_REFERENCES, WITH_PLANS };   /* how far a feedback got */

/* Everything that one autopilot remembers. */
struct autopilot {
    uint32_t magic;                        /* INITIALISED */
    int32_t started;                       /* the run has started: its first measurement is complete */
    int32_t ended;                         /* enum drawbar_status with which the run did, or 0 */
    int32_t called;                        /* drawbar_feedback has been, since drawbar_prepare */
    int32_t due;                           /* and the components have something to prepare */
    int32_t released;                      /* the commands are not carried out: somebody else drives */
    int32_t reached;                       /* how far the newest feedback got */
    double time;                           /* of the newest measurement, s */
    double start;                          /* arc length at which the run is to begin, m */
    double wanted_speed;                   /* set speed, m/s */
    double speed;                          /* the one that is commanded, m/s */
    double sane;                           /* part of the set speed that may be driven, see safety/sanity.h */
    double unsolved;                       /* since estimator and controllers have all had a solution, s */
    double overdue;                        /* by which samples came late, less half of what has passed since, s */
    double counted;                        /* time that samples were taken for, beyond what has passed, s */
    struct step_settings settings;
    struct path path;                      /* count 0: none */
    struct line_offset offset;             /* of the line that is driven beside the path */
    struct decisions made;
    struct drawbar_command acting;         /* the command that acts until the next measurement */
    struct drawbar_actuation known;        /* identified of both steerings and of sensors */
    struct drawbar_diagnostics diagnostics;
    MEMORY(alignment, DRAWBAR_ALIGNMENT_SIZE);
    MEMORY(estimator, DRAWBAR_ESTIMATOR_SIZE);
    MEMORY(guidance, DRAWBAR_GUIDANCE_SIZE);
#ifdef DRAWBAR_IDENTIFIED
    MEMORY(actuation, DRAWBAR_ACTUATION_SIZE);
#endif
#ifdef DRAWBAR_DEAD_TIME
    MEMORY(predictor, DRAWBAR_PREDICTOR_SIZE);
#endif
#ifdef DRAWBAR_CENTRALISED
    MEMORY(controller, DRAWBAR_CONTROLLER_SIZE);
#else
    MEMORY(tractor, DRAWBAR_TRACTOR_SIZE);
    MEMORY(trailer, DRAWBAR_TRAILER_SIZE);
#endif
    MEMORY(tractor_law, DRAWBAR_TRACTOR_LAW_SIZE);
    MEMORY(trailer_law, DRAWBAR_TRAILER_LAW_SIZE);
    MEMORY(gate, DRAWBAR_GATE_SIZE);
    MEMORY(run_monitor, DRAWBAR_RUN_MONITOR_SIZE);
    MEMORY(sanity, DRAWBAR_SANITY_SIZE);
    MEMORY(work, DRAWBAR_WORK_SIZE);
#ifdef DRAWBAR_HOSTED
    double times[3][2];                    /* of estimator, tractor, trailer: preparation, feedback, s */
    const struct drawbar_command *sent;    /* at this sample, which is computed again; NULL: it is a new one */
#endif
};

#ifdef DRAWBAR_HOSTED
#include "clock.h"
#define TIMED(a, solver, phase, call)                                                                        \
    do {                                                                                                     \
        const int64_t began = clock_now();                                                                   \
        (void)(call);                                                                                        \
        (a)->times[solver][phase] = (double)(clock_now() - began) / 1e9;                                     \
    } while (0)
#else
#define TIMED(a, solver, phase, call) (void)(call)
#endif
enum { TIMED_ESTIMATOR, TIMED_TRACTOR, TIMED_TRAILER };
enum { PREPARATION, FEEDBACK };

#endif

/* The parts of an exported autopilot, each a unit of its own: memory is given to it, what is in there is its business.
 * `work` is lent to it for the length of the call, and to all others after it.
 *
 * drawbar_components.h is generated. It tells which parts there are (DRAWBAR_CENTRALISED, DRAWBAR_DEAD_TIME), the bytes that
 * each needs (DRAWBAR_<PART>_SIZE) and what is lent to all (DRAWBAR_WORK_SIZE), and three numbers: DRAWBAR_SPEED to drive at, m/s; DRAWBAR_PATIENCE, for how long a
 * command may act without a new one, s; DRAWBAR_SAMPLE_TIME (in drawbar_size.h), s.
 */
#ifndef DRAWBAR_COMPONENTS_H
#define DRAWBAR_COMPONENTS_H

#include "drawbar.h"
#include "drawbar_components.h"
#include "path.h"
#include "signals.h"

#define MEMORY(size) [((size) + sizeof(double) - 1) / sizeof(double)]
#define COMPONENT(memory) ((struct component *)(memory))

struct component;                               /* another one in each unit */

int drawbar_estimator_initialise(struct component *component);
int drawbar_estimator_begin(struct component *component, const struct drawbar_measurement *first);
int drawbar_estimator_update(struct component *component, const struct drawbar_measurement *measurement,
                             struct drawbar_estimate *estimate, void *work);
int drawbar_estimator_ready(struct component *component, const struct drawbar_command *acting);

#ifdef DRAWBAR_DEAD_TIME
int drawbar_predictor_initialise(struct component *component);
int drawbar_predictor_ahead(struct component *component, const struct drawbar_estimate *now, struct drawbar_estimate *then);
int drawbar_predictor_sent(struct component *component, const struct drawbar_command *newest, struct drawbar_command *acting);
#endif

int drawbar_guidance_initialise(struct component *component);
int drawbar_guidance_begin(struct component *component, const struct path *path, const struct drawbar_measurement *first);
int drawbar_guidance_reference(struct component *component, const struct path *path, const struct drawbar_estimate *estimate,
                               struct drawbar_body_reference *tractor, struct drawbar_body_reference *trailer,
                               void *work);
int drawbar_guidance_finished(struct component *component, const struct path *path);

#ifdef DRAWBAR_CENTRALISED
int drawbar_controller_initialise(struct component *component);
int drawbar_controller_feedback(struct component *component, const struct drawbar_estimate *estimate,
                                const struct drawbar_body_reference *tractor_reference,
                                const struct drawbar_body_reference *trailer_reference,
                                struct drawbar_body_plan *tractor, struct drawbar_body_plan *trailer, void *work);
int drawbar_controller_ready(struct component *component);
#else
int drawbar_tractor_initialise(struct component *component);
int drawbar_tractor_feedback(struct component *component, const struct drawbar_estimate *estimate,
                             const struct drawbar_body_reference *reference,
                             const struct drawbar_body_plan *neighbour, struct drawbar_body_plan *plan, void *work);
int drawbar_tractor_ready(struct component *component);
int drawbar_trailer_initialise(struct component *component);
int drawbar_trailer_feedback(struct component *component, const struct drawbar_estimate *estimate,
                             const struct drawbar_body_reference *reference,
                             const struct drawbar_body_plan *neighbour, struct drawbar_body_plan *plan, void *work);
int drawbar_trailer_ready(struct component *component);
#endif

int drawbar_tractor_law_initialise(struct component *component);
int drawbar_tractor_law_apply(const struct component *component, const struct drawbar_body_plan *plan,
                              struct drawbar_body_steering *steering);
int drawbar_trailer_law_initialise(struct component *component);
int drawbar_trailer_law_apply(const struct component *component, const struct drawbar_body_plan *plan,
                              struct drawbar_body_steering *steering);

int drawbar_gate_initialise(struct component *component);
int drawbar_gate_begin(struct component *component, const struct drawbar_measurement *first);
int drawbar_gate_stop(struct component *component, double time, struct drawbar_command *given);
int drawbar_gate_stand(const struct component *component, double time, struct drawbar_command *given);
int drawbar_gate_hold(struct component *component, double time, struct drawbar_command *given);
int drawbar_gate_check(struct component *component, const struct drawbar_command *wanted, struct drawbar_command *given);

int drawbar_supervisor_initialise(struct component *component);
int drawbar_supervisor_watch(struct component *component, const struct drawbar_estimate *estimate,
                             const struct drawbar_body_reference *tractor);

/* Everything that one autopilot remembers. */
struct autopilot {
    uint32_t magic;                        /* INITIALISED */
    int32_t begun;                         /* the first measurement of the run has been seen */
    int32_t ended;                         /* enum drawbar_status with which the run did, or 0 */
    int32_t called;                        /* drawbar_feedback has been, since drawbar_prepare */
    int32_t due;                           /* and the parts have something to prepare */
    int32_t late;                          /* the newest measurement was */
    double time;                           /* of the newest measurement, s */
    struct path path;                      /* count 0: none */
    struct drawbar_estimate estimate;
    struct drawbar_command acting;         /* the command that acts until the next measurement */
    struct drawbar_diagnostics diagnostics;
    double estimator MEMORY(DRAWBAR_ESTIMATOR_SIZE);
    double guidance MEMORY(DRAWBAR_GUIDANCE_SIZE);
#ifdef DRAWBAR_DEAD_TIME
    double predictor MEMORY(DRAWBAR_PREDICTOR_SIZE);
#endif
#ifdef DRAWBAR_CENTRALISED
    double controller MEMORY(DRAWBAR_CONTROLLER_SIZE);
#else
    double tractor MEMORY(DRAWBAR_TRACTOR_SIZE);
    double trailer MEMORY(DRAWBAR_TRAILER_SIZE);
#endif
    double tractor_law MEMORY(DRAWBAR_TRACTOR_LAW_SIZE);
    double trailer_law MEMORY(DRAWBAR_TRAILER_LAW_SIZE);
    double gate MEMORY(DRAWBAR_GATE_SIZE);
    double supervisor MEMORY(DRAWBAR_SUPERVISOR_SIZE);
    double work MEMORY(DRAWBAR_WORK_SIZE);
};

#endif

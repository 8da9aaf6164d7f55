/* drawbar: an autopilot for a tractor with a trailer, generated from one configuration.
 *
 * Once:                 drawbar_init, drawbar_set_path
 * Each sample:          drawbar_feedback, then send the command to the actuators, then drawbar_prepare;
 *                       or drawbar_step, which is both, where a millisecond of latency does not matter
 *
 * drawbar_size.h has DRAWBAR_SAMPLE_TIME in seconds. Call at every sample, even when the sensors report nothing: a missing
 * value is NaN. Let each measurement begin as DRAWBAR_NOTHING_MEASURED: a zero is a measurement. The state holds everything
 * that is remembered: one per vehicle, used by one thread at a time; a copy of it continues like the original. No
 * function allocates memory, reads a clock or keeps anything outside the state. Floating-point exceptions must be masked, as
 * they are when a program begins: a comparison with a missing value raises FE_INVALID.
 *
 * Signals, statuses and their units: drawbar_signals.h.
 *
 * Functions that return an int return enum drawbar_status: DRAWBAR_OK, or why the call was wrong (NULL, order, range, ...).
 * Only drawbar_feedback and drawbar_step return others; their command may be sent whatever the status.
 *
 *     below DRAWBAR_REFUSED     a new command; the number is a set of enum drawbar_flag, 0: no remark
 *     from DRAWBAR_REFUSED on   no new command; the last one is repeated, for at most one second by the time stamps and by
 *                               the number of samples; then the vehicle is stopped, and a run that has begun ends
 *     from DRAWBAR_FINISHED on  the run has ended: the command stops the vehicle with its steering held, until the next
 *                               drawbar_set_path
 *     from DRAWBAR_NULL on      the call was wrong: nothing was computed, and the command stops the vehicle
 *
 * Where estimator or controllers have no solution, or samples come late, the vehicle continues along its last plan for as long
 * as that reaches (controller.horizon times sample_time), three seconds at most; after a sixth of this it is slower
 * (DRAWBAR_SLOWED), then it stops (DRAWBAR_UNSOLVED, DRAWBAR_OVERDUE).
 * Where calls come, by their time stamps, at another rate than DRAWBAR_SAMPLE_TIME, it is stopped (DRAWBAR_RATE).
 */
#ifndef DRAWBAR_H
#define DRAWBAR_H

#include <stdint.h>
#include "drawbar_api.h"
#include "drawbar_signals.h"
#include "drawbar_size.h"

#ifdef __cplusplus
extern "C" {
#endif

/* All that one autopilot remembers. Its content is private. */
struct drawbar_state {
    double memory[DRAWBAR_STATE_DOUBLES];
};

/* Prepare the state for its first path.
 *
 * When the compiler's arithmetic is not IEEE's (DRAWBAR_ARITHMETIC) nothing changes, and a new state stays without use. */
DRAWBAR_API int drawbar_init(struct drawbar_state *state);

/* Begin a run at the start of a path, with the next measurement. May be called at any time: it ends the present run, and
 * drawbar_feedback comes next even where drawbar_prepare was due.
 *
 * nodes: count (at least 2) poses with arc lengths that begin at zero and increase by 1 mm to 0.25 m, joined by arcs:
 *     no jumps, no kinks, yaw continuous. The library keeps the pointer, not a copy: keep the table unchanged until the
 *     run ends or another path is set.
 *
 * When it is refused (DRAWBAR_PATH) nothing changes. While the run cannot begin the vehicle stands, and status and
 * start_distance of the diagnostics show why: an antenna's position is missing, or the tractor is further than
 * guidance.maximum_start_distance of config.toml from where the run is to begin. */
DRAWBAR_API int drawbar_set_path(struct drawbar_state *state, const struct drawbar_path_node *nodes,
                                 int32_t count);

/* Let the run that drawbar_set_path has announced begin elsewhere on the path.
 *
 * arc_length: from 0 to below the path's length, m.
 *
 * When it is refused (DRAWBAR_RANGE; DRAWBAR_ORDER: the run has begun) nothing changes. */
DRAWBAR_API int drawbar_begin_at(struct drawbar_state *state, double arc_length);

/* Continue along another path, without a stop. Its nodes are as those of drawbar_set_path; the tractor must be within 1 m of
 * it, near an arc length (m), and face along it within 60 degrees.
 *
 * When it is refused (DRAWBAR_ELSEWHERE: the tractor is not there, DRAWBAR_PATH, DRAWBAR_RANGE, DRAWBAR_NO_RUN) nothing
 * changes and the run goes on. */
DRAWBAR_API int drawbar_change_path(struct drawbar_state *state, const struct drawbar_path_node *nodes, int32_t count,
                                    double arc_length);

/* Drive along the line so far to the left of the path (right: negative), m; 0, the path itself, after drawbar_set_path and
 * drawbar_change_path. Neighbouring passes and an implement's offset need no other path.
 *
 * Before a run begins, and while somebody else drives, the line is there at once. Else it is shifted, beginning beside the
 * tractor, over a length within which it bends by a tenth of vehicle.curvature_limit and guidance.curvature_rate_limit at
 * most (0.3 m: 8.4 m with the defaults); an offset that is set meanwhile comes after that.
 *
 * Refused (DRAWBAR_RANGE, nothing changes): what is not finite or beyond 100 m, or a line that inside of a curve would be
 * tighter than vehicle.curvature_limit and the path. Takes as long as drawbar_set_path: it looks at every node. */
DRAWBAR_API int drawbar_set_offset(struct drawbar_state *state, double offset);

/* Change the set speed, m/s, from 0 to the configuration's own; else DRAWBAR_RANGE, and nothing changes. In a run the
 * commanded speed approaches it by the configuration's acceleration. */
DRAWBAR_API int drawbar_set_speed(struct drawbar_state *state, double speed);

/* Set whether the vehicle carries out the commands; after drawbar_init it does. While it does not (engaged is 0) somebody
 * else drives: the command repeats the estimated steering, with speed zero (DRAWBAR_RELEASED), and estimate and plans follow
 * what the vehicle does. Once it does again, the command starts from there. drawbar_set_path does not change this. */
DRAWBAR_API int drawbar_set_engaged(struct drawbar_state *state, int32_t engaged);

/* Compute the command for the newest measurement; send it before anything else. */
DRAWBAR_API int drawbar_feedback(struct drawbar_state *state, const struct drawbar_measurement *measurement,
                                 struct drawbar_command *command);

/* Prepare the next sample, after the command has been sent; most of the arithmetic. */
DRAWBAR_API int drawbar_prepare(struct drawbar_state *state);

/* drawbar_feedback and drawbar_prepare. */
DRAWBAR_API int drawbar_step(struct drawbar_state *state, const struct drawbar_measurement *measurement,
                             struct drawbar_command *command);

/* The last step's estimate, and how its command came about. Zero before the first step. */
DRAWBAR_API int drawbar_get_estimate(const struct drawbar_state *state, struct drawbar_estimate *estimate);
DRAWBAR_API int drawbar_get_diagnostics(const struct drawbar_state *state, struct drawbar_diagnostics *diagnostics);

/* What both steerings make of their commands, as far as the run has shown; all zero where the configuration does not ask
 * for it (actuation.identify). */
DRAWBAR_API int drawbar_get_actuation(const struct drawbar_state *state, struct drawbar_actuation *actuation);

/* What a status means, in one line. */
DRAWBAR_API const char *drawbar_status_text(int status);

/* The version of drawbar that generated this library, the hash of the configuration, and the precision of its numbers. With
 * the headers of another export a state may have too little memory: where strcmp() finds this unlike DRAWBAR_VERSION, do not
 * go on. */
DRAWBAR_API const char *drawbar_version(void);

/* Bytes of a struct drawbar_state, for callers that allocate it without this header; aligned as a double. */
DRAWBAR_API int32_t drawbar_state_size(void);

#ifdef __cplusplus
}
#endif

#endif

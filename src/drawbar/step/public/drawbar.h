/* drawbar: an autopilot for a tractor with a trailer, generated from one configuration.
 *
 * Once:                 drawbar_init, drawbar_set_path
 * Each sample:          drawbar_feedback, then send the command to the actuators, then drawbar_prepare;
 *                       or drawbar_step, which is both, where a millisecond of latency does not matter
 *
 * drawbar_size.h has DRAWBAR_SAMPLE_TIME in seconds. Call at every sample, also where sensors report nothing: what is
 * missing is NaN. All that is remembered is in the state, so any number of vehicles can be steered, each by one thread
 * at a time. No function allocates memory, reads a clock or keeps anything outside the state.
 *
 * Signals and their units: drawbar_signals.h.
 */
#ifndef DRAWBAR_H
#define DRAWBAR_H

#include <stdint.h>
#include "drawbar_signals.h"
#include "drawbar_size.h"

#if defined(__GNUC__) && !defined(_WIN32)  /* of a shared library's functions only these are seen from outside */
#define DRAWBAR_API __attribute__((visibility("default")))
#else
#define DRAWBAR_API                        /* drawbar.def tells */
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* What a call returns. The command that a step gives can be sent to the actuators whatever the status. */
enum drawbar_status {
    DRAWBAR_OK = 0,

    /* The command is a new one, but look at the diagnostics. */
    DRAWBAR_MEASUREMENT = 1,               /* a value was infinite or absurd, and was taken for missing */
    DRAWBAR_LATE = 2,                      /* a sample or more was left out */
    DRAWBAR_LIMITED = 3,                   /* the steering was brought nearer to the wheels; no actuator can tell */
    DRAWBAR_SOLVER = 4,                    /* a solver failed; estimate or plan is its own prediction */

    /* There is no new command: the last one is repeated, for at most a second; then the vehicle is stopped, and its run
     * ends if it had begun: DRAWBAR_STOPPED. */
    DRAWBAR_REFUSED = 16,                  /* the command was not finite or beyond its limits */
    DRAWBAR_TIME = 17,                     /* the time stamp is not finite or does not increase */
    DRAWBAR_POSITION = 18,                 /* the run cannot begin: an antenna's position is missing */
    DRAWBAR_START = 19,                    /* the run cannot begin: the tractor is too far from the path's start */

    /* The run has ended: the command stops the vehicle, with its steering held, until the next drawbar_set_path. */
    DRAWBAR_FINISHED = 32,                 /* the tractor has reached the end of the path */
    DRAWBAR_OFF_COURSE = 33,               /* the tractor is too far from the path */
    DRAWBAR_BLIND = 34,                    /* neither antenna has had a valid fix for too long */
    DRAWBAR_GUIDANCE = 35,                 /* the estimate is not finite, or no way leads back onto the path */
    DRAWBAR_GAP = 36,                      /* samples were left out for longer than a command may be repeated */
    DRAWBAR_STOPPED = 37,                  /* no command could be given for longer than one may be repeated */

    /* The call was wrong: nothing was computed, and a command stops the vehicle. */
    DRAWBAR_NULL = 64,                     /* a pointer is NULL */
    DRAWBAR_NOT_INITIALISED = 65,          /* drawbar_init has not been called on this state */
    DRAWBAR_NO_PATH = 66,                  /* drawbar_set_path has not been called, or not with success */
    DRAWBAR_ORDER = 67,                    /* feedback and prepare do not alternate */
    DRAWBAR_PATH = 68                      /* the path's table is not a smooth path; see drawbar_set_path */
};

/* All that one autopilot remembers. Its content is nobody else's business. */
struct drawbar_state {
    double memory[DRAWBAR_STATE_DOUBLES];
};

struct drawbar_body_diagnostics {
    double progress;                       /* of the body along the path, m */
    double lateral_error;                  /* of the body from the path, left positive, m */
    double nominal, ancillary;             /* the two parts of the steering before its bound, rad */
    double margin;                         /* 1 at the centre of the tube, 0 on its boundary; NaN: there is none */
    int32_t saturated;                     /* the steering ended at its bound */
    int32_t solver;                        /* as in struct drawbar_estimate */
    int32_t fix;                           /* enum drawbar_fix */
    int32_t reserved;
};

struct drawbar_diagnostics {
    struct drawbar_body_diagnostics tractor, trailer;
    int32_t estimator;                     /* solver, as in struct drawbar_estimate */
    int32_t gate;                          /* 0: passed, 1: limited, 2: last command repeated, 3: vehicle stopped */
    int32_t status;                        /* enum drawbar_status of the last feedback */
    int32_t missing;                       /* measured values that were infinite or absurd */
};

/* Prepare the state for its first path. */
DRAWBAR_API int drawbar_init(struct drawbar_state *state);

/* Begin a run along a path; the next measurement starts it.
 *
 * nodes: count (at least 2) poses with arc lengths that begin at zero and increase by 1 mm to 0.25 m, joined by arcs:
 *     no jumps, no kinks, yaw continuous. The table stays the caller's and must outlive the run unchanged.
 *
 * When it is refused nothing changes. */
DRAWBAR_API int drawbar_set_path(struct drawbar_state *state, const struct drawbar_path_node *nodes,
                                 int32_t count);

/* From the newest measurement to a command. */
DRAWBAR_API int drawbar_feedback(struct drawbar_state *state, const struct drawbar_measurement *measurement,
                                 struct drawbar_command *command);

/* Do what can be done before the next measurement: most of the arithmetic. */
DRAWBAR_API int drawbar_prepare(struct drawbar_state *state);

/* drawbar_feedback and drawbar_prepare. */
DRAWBAR_API int drawbar_step(struct drawbar_state *state, const struct drawbar_measurement *measurement,
                             struct drawbar_command *command);

/* The last step's estimate, and how its command came about. Zero before the first step. */
DRAWBAR_API int drawbar_get_estimate(const struct drawbar_state *state, struct drawbar_estimate *estimate);
DRAWBAR_API int drawbar_get_diagnostics(const struct drawbar_state *state, struct drawbar_diagnostics *diagnostics);

/* What a status means, in one line. */
DRAWBAR_API const char *drawbar_status_text(int status);

/* The version of drawbar that generated this library, and the hash of the configuration. */
DRAWBAR_API const char *drawbar_version(void);

/* Bytes of a struct drawbar_state, for callers that allocate it without this header; aligned as a double. */
DRAWBAR_API int32_t drawbar_state_size(void);

#ifdef __cplusplus
}
#endif

#endif

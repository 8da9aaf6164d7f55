/* Subsystem: what the nominal controllers of either body share.
 *
 * The header of a body defines POSE_STATES (1: its states are a pose and what follows it; 0: angles of the body itself),
 * includes this one, and then defines struct component, which holds `rti` first and `subsystem`, and
 *
 *     body_state     the estimate in the states of the body's model, NX values
 *     fill           writes parameters and references into the solver
 *     guess          linearises along a first guess, made of what was filled in (iteration.h)
 *     body_command   the nominal command of the plan's first sample, rad; lets the plan's first input be what it does
 *     body_hold      the command that leads the steering to an angle, rad
 *     body_plan      the predicted antenna poses (N + 1 rows) and the planned steering angles (N)
 *
 * Its last line includes subsystem_phases.h.
 */
#ifndef DRAWBAR_SUBSYSTEM_H
#define DRAWBAR_SUBSYSTEM_H

#include "geometry.h"
#include "iteration.h"
#include "neighbour.h"
#include "nominal_state.h"
#include "signals.h"
#include "unit.h"

#define DEVIATIONS (NX - POSE_STATES)

/* What the trailer's controller assumes of the tractor's motion (g_2 in equation nonlinearmodel). */
enum coupling { NEGLECTED, MEASURED, FOLLOWING, PLANNED };

struct subsystem {
    int32_t restarts;                      /* the problem starts at the estimate, not at the last plan's successor */
    double reach[NX];                      /* optimised: largest |x^ - successor| at which x_0 may be chosen anew */
    double half_widths[NX];                /* optimised: the box around x^ that it is chosen from */

    struct iteration iteration;
    int32_t predicts;                      /* the last plan was solved: `successor` holds */
    int32_t solved;                        /* a plan has been solved; poses and steerings are of the last such */
    double successor[NX];                  /* the nominal state one sample after that plan's first */
    double frame[3];                       /* optimised: pose of the frame in which all of this is stated */

    double estimated[NX], nominal[NX];     /* x^, and the nominal state beside it */
    double poses[N + 1][3], steerings[N], deviation[NX];   /* the plan's */
};

#define SUBSYSTEM_FIELDS                                                                                    \
    SETTING(component, subsystem.restarts, 1, 1, 0, 0) SETTING(component, subsystem.reach, 0, NX, 0, 0)               \
    SETTING(component, subsystem.half_widths, 0, NX, 0, 0) FIELD(component, subsystem.predicts, 1, 1, 0, 0)           \
    FIELD(component, subsystem.successor, 0, NX, 0, 0) FIELD(component, subsystem.frame, 0, 3, 0, 0)                  \
    FIELD(component, subsystem.poses, 0, N + 1, 3, 0) FIELD(component, subsystem.steerings, 0, N, 0, 0)               \
    FIELD(component, subsystem.deviation, 0, DEVIATIONS, 0, 0)

#endif

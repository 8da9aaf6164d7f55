/* Centralised control: one problem for both bodies (the paper's CeNMPC). The coupling needs no assumption here: the
 * model holds it.
 *
 * The header of a model defines TRACTOR_DEVIATIONS and TRAILER_DEVIATIONS, the numbers of the ancillary laws'
 * coordinates, includes this one, and then defines struct component, which holds `rti` first and `centralised`, and
 *
 *     vehicle_state       the estimate in the model's states, NX values
 *     vehicle_deviation   x^ - x- of tractor and trailer in the coordinates of their ancillary laws
 *     fill                writes parameters and references into the solver
 *     guess               linearises along a first guess, made of what was filled in (iteration.h)
 *     vehicle_command     both nominal commands of the plan's first sample, rad; lets its first input be what they do
 *     vehicle_hold        both commands that lead the steerings to two angles, rad
 *     vehicle_plan        the predicted antenna poses (N + 1 rows) and planned steering angles (N) of the plan
 *
 * Its last line includes centralised_phases.h.
 */
#ifndef DRAWBAR_CENTRALISED_H
#define DRAWBAR_CENTRALISED_H

#include "iteration.h"
#include "nominal_state.h"
#include "signals.h"
#include "unit.h"

struct centralised {
    struct iteration iteration;
    int32_t predicts;                      /* the last plan was solved: `predicted` holds */
    int32_t solved;                        /* a plan has been solved; the plans below are of the last such */
    double predicted[NX];                  /* the state one sample after that plan's first */
    /* the plans */
    double tractor_poses[N + 1][3], trailer_poses[N + 1][3];
    double tractor_steerings[N], trailer_steerings[N];
    double tractor_deviation[TRACTOR_DEVIATIONS], trailer_deviation[TRAILER_DEVIATIONS];
};

#endif

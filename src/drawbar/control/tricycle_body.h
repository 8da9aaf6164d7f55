/* Tricycle body: what the paper's two nominal controllers share; states are poses, the input is the steering angle
 * itself. */
#ifndef DRAWBAR_TRICYCLE_BODY_H
#define DRAWBAR_TRICYCLE_BODY_H

#define POSE_STATES 1

#include "subsystem.h"

/* References: the path's positions, and the last measured steering (rad). */
static inline void fill_references(struct rti *solver, const struct drawbar_body_reference *reference, double steering)
{
    for (int k = 0; k <= N; ++k) {
        solver->y[k][Y_X] = reference->samples[k][AT_X];
        solver->y[k][Y_Y] = reference->samples[k][AT_Y];
        solver->y[k][Y_STEERING] = steering;
    }
}

/* Linearise along standing still. */
static void guess(struct rti *solver)
{
    iteration_rest(solver);
}

static inline void pose_state(const struct drawbar_pose *pose, double *state)
{
    state[X_X] = pose->x;
    state[X_Y] = pose->y;
    state[X_YAW] = pose->yaw;
}

static inline void pose_plan(struct subsystem *body, const struct rti *solver)
{
    for (int k = 0; k <= N; ++k)
        memcpy(body->poses[k], STATE(solver->z, k), sizeof body->poses[k]);
    for (int k = 0; k < N; ++k)
        body->steerings[k] = INPUT(solver->z, k)[U_STEERING];
}

#endif

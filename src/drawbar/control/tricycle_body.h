/* What the paper's two nominal controllers have in common: states are poses, the input is the steering angle itself;
 * outputs: position and steering. */
#ifndef DRAWBAR_TRICYCLE_BODY_H
#define DRAWBAR_TRICYCLE_BODY_H

#define POSE_STATES 1

#include "subsystem.h"

/* References: the path's positions, and the last measured steering (rad). */
static inline void fill_references(struct rti *solver, const struct drawbar_body_reference *reference, double steering)
{
    for (int k = 0; k <= N; ++k) {
        memcpy(&solver->y[k][0], reference->samples[k], 2 * sizeof(double));
        solver->y[k][2] = steering;
    }
}

/* Linearise along standing still. */
static void guess(struct rti *solver)
{
    iteration_rest(solver);
}

static inline void pose_state(const struct drawbar_pose *pose, double *state)
{
    state[0] = pose->x;
    state[1] = pose->y;
    state[2] = pose->yaw;
}

static inline void pose_plan(struct subsystem *body, const struct rti *solver)
{
    memcpy(body->poses, STATE(solver->z, 0), sizeof body->poses);
    memcpy(body->steerings, INPUT(solver->z, 0), sizeof body->steerings);
}

#endif

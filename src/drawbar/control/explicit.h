/* Explicit controller, in closed form: a steering law for the tractor, a PI controller for the trailer.
 *
 * It steers without a prediction; its plan is the motion under the held command: the tractor continues at
 * constant speed and curvature, the bicycle's, and the trailer is on its reference.
 *
 * The unit defines N, the samples of the path ahead. The header of a law defines struct law, LAW_FIELDS and
 * law_steering, the tractor's steering before its limit, rad; its last line includes this one.
 */
#ifndef DRAWBAR_EXPLICIT_H
#define DRAWBAR_EXPLICIT_H

#include <string.h>

#include "chain.h"
#include "solver_resources.h"
#include "no_plan.h"
#include "proportional_integral.h"
#include "status.h"
#include "tangent.h"
#include "unit.h"

struct component {
    /* settings */
    struct law law;                        /* of the tractor */
    struct proportional_integral trailer;
    struct chain chain;
    double interval;                       /* sample time, s */
    double limit;                          /* of the tractor's steering, rad */
    double joint_sign;                     /* -1 where the trailer's actuator is reversed, else 1 */
    /* plans */
    double tractor_poses[N + 1][3], trailer_poses[N + 1][3];
    double tractor_steerings[N], trailer_steerings[N];
};

#define COMPONENT_FIELDS                                                                                          \
    LAW_FIELDS CHAIN_FIELDS(component, chain) SETTING(component, interval, 0, 1, 0, 0)                            \
    SETTING(component, limit, 0, 1, 0, 0) SETTING(component, joint_sign, 0, 1, 0, 0)                                   \
    SETTING(component, trailer.proportional, 0, 1, 0, 0) SETTING(component, trailer.integral, 0, 1, 0, 0)              \
    SETTING(component, trailer.interval, 0, 1, 0, 0) SETTING(component, trailer.limit, 0, 1, 0, 0)

/* The tractor's poses on the arc that the steering (rad) means, one per sample. */
static void roll_out(struct component *component, const struct drawbar_estimate *estimate, double steering)
{
    const struct drawbar_pose *pose = &estimate->tractor;
    const double pace = estimate->longitudinal_slip * estimate->speed * component->interval;

    for (int k = 0; k <= N; ++k) {
        const double distance = pace * k, half = 0.5 * distance * tan(steering) / component->chain.wheelbase;
        const double chord = half == 0.0 ? distance : distance * sin(half) / half;
        component->tractor_poses[k][AT_X] = pose->x + chord * cos(pose->yaw + half);
        component->tractor_poses[k][AT_Y] = pose->y + chord * sin(pose->yaw + half);
        component->tractor_poses[k][AT_YAW] = pose->yaw + 2.0 * half;
    }
}

/* The plan of a body that holds a steering (rad), asked for by a command (rad). */
static struct drawbar_body_plan held(double command, double steering, double *steerings, double (*poses)[3])
{
    for (int k = 0; k < N; ++k)
        steerings[k] = steering;
    return (struct drawbar_body_plan){
        .steering = command, .poses = (const double (*)[3])poses, .steerings = steerings, .status = SOLVED
    };
}

/* Both bodies' commands and what would follow from them. */
int UNIT(feedback)(struct component *component, const struct drawbar_estimate *estimate,
                   const struct drawbar_body_reference *tractor_reference,
                   const struct drawbar_body_reference *trailer_reference, struct drawbar_body_plan *tractor,
                   struct drawbar_body_plan *trailer, struct solver_resources *resources)
{
    const double wanted = law_steering(&component->law, &component->chain, estimate, tractor_reference);
    const double front = clipped(wanted, component->limit);
    const double error = tangent_distance(&estimate->trailer, trailer_reference);
    const double joint = proportional_integral(&component->trailer, error);

    (void)resources;
    roll_out(component, estimate, front);
    for (int k = 0; k <= N; ++k)
        memcpy(component->trailer_poses[k], trailer_reference->samples[k], sizeof component->trailer_poses[k]);
    *tractor = held(front, front, component->tractor_steerings, component->tractor_poses);
    *trailer = held(component->joint_sign * joint, joint, component->trailer_steerings, component->trailer_poses);
    return SOLVED;
}

#endif

/* The paper's centralised controller (CeNMPC): both positions tracked on the whole tricycle model.
 *
 * Costs Q, R, S of both bodies; steering references are the last measured angles, as in the decentralised pair.
 */
#ifndef DRAWBAR_CENTRALISED_TRICYCLE_H
#define DRAWBAR_CENTRALISED_TRICYCLE_H

#define TRACTOR_DEVIATIONS 2               /* lateral, heading */
#define TRAILER_DEVIATIONS 2

#include "centralised.h"

struct component {
    struct rti rti;
    struct centralised centralised;
};

#define COMPONENT_FIELDS

static void vehicle_state(const struct drawbar_estimate *estimate, double *x)
{
    x[X_TRACTOR_X] = estimate->tractor.x;
    x[X_TRACTOR_Y] = estimate->tractor.y;
    x[X_TRACTOR_YAW] = estimate->tractor.yaw;
    x[X_TRAILER_X] = estimate->trailer.x;
    x[X_TRAILER_Y] = estimate->trailer.y;
    x[X_TRAILER_YAW] = estimate->trailer.yaw;
}

static void tractor_pose(const double *x, double *pose)
{
    pose[AT_X] = x[X_TRACTOR_X];
    pose[AT_Y] = x[X_TRACTOR_Y];
    pose[AT_YAW] = x[X_TRACTOR_YAW];
}

static void trailer_pose(const double *x, double *pose)
{
    pose[AT_X] = x[X_TRAILER_X];
    pose[AT_Y] = x[X_TRAILER_Y];
    pose[AT_YAW] = x[X_TRAILER_YAW];
}

static void vehicle_deviation(struct centralised *both, const double *estimated, const double *predicted,
                              const struct drawbar_body_reference *tractor,
                              const struct drawbar_body_reference *trailer)
{
    double pose[3], nominal[3];

    tractor_pose(estimated, pose);
    tractor_pose(predicted, nominal);
    move_beside(nominal, tractor->closest);
    pose_deviation(pose, nominal, 3, both->tractor_deviation);
    trailer_pose(estimated, pose);
    trailer_pose(predicted, nominal);
    move_beside(nominal, trailer->closest);
    pose_deviation(pose, nominal, 3, both->trailer_deviation);
}

static void fill(struct component *component, const struct drawbar_estimate *estimate,
                 const struct drawbar_body_reference *tractor, const struct drawbar_body_reference *trailer)
{
    for (int k = 0; k <= N; ++k) {
        double *p = component->rti.p[k], *y = component->rti.y[k];

        p[P_LONGITUDINAL_SLIP] = estimate->longitudinal_slip;
        p[P_TRACTOR_SLIP] = estimate->tractor_slip;
        p[P_TRAILER_SLIP] = estimate->trailer_slip;
        p[P_HITCH_ANGLE] = estimate->hitch_angle;
        p[P_SPEED] = estimate->speed;
        y[Y_TRACTOR_X] = tractor->samples[k][AT_X];
        y[Y_TRACTOR_Y] = tractor->samples[k][AT_Y];
        y[Y_TRAILER_X] = trailer->samples[k][AT_X];
        y[Y_TRAILER_Y] = trailer->samples[k][AT_Y];
        y[Y_TRACTOR_STEERING] = estimate->tractor_steering;
        y[Y_TRAILER_STEERING] = estimate->trailer_steering;
    }
}

/* Linearise along standing still. */
static void guess(struct rti *solver)
{
    iteration_rest(solver);
}

static void vehicle_command(struct component *component, double *commands)
{
    const double *u = INPUT(component->rti.z, 0);

    commands[0] = u[U_TRACTOR_STEERING];
    commands[1] = u[U_TRAILER_STEERING];
}

static void vehicle_hold(const struct component *component, double tractor, double trailer, double *commands)
{
    (void)component;
    commands[0] = tractor;
    commands[1] = trailer;
}

static void vehicle_plan(struct component *component)
{
    struct centralised *both = &component->centralised;

    for (int k = 0; k <= N; ++k) {
        tractor_pose(STATE(component->rti.z, k), both->tractor_poses[k]);
        trailer_pose(STATE(component->rti.z, k), both->trailer_poses[k]);
    }
    for (int k = 0; k < N; ++k) {
        both->tractor_steerings[k] = INPUT(component->rti.z, k)[U_TRACTOR_STEERING];
        both->trailer_steerings[k] = INPUT(component->rti.z, k)[U_TRAILER_STEERING];
    }
}

/* The steering itself is the input: no rate is bounded. */
static void allow_rates(struct component *component, const struct drawbar_actuation *known)
{
    (void)component, (void)known;
}

#include "centralised_phases.h"

#endif

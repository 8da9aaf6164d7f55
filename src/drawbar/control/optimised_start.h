/* Optimised start: an initial state that the nominal problem chooses itself, within the tube around the estimate (Mayne et al.
 * 2005).
 *
 * The initial state is free in a box, whose sides are offset and heading in the path's frame at the estimate, the frame in which
 * problem and last plan are stated. While the successor of the last nominal state is in the box around the estimate, all of the
 * box may be chosen: both keep the vehicle in its tube. Outside the box only that successor surely does, and is kept.
 */
#ifndef DRAWBAR_OPTIMISED_START_H
#define DRAWBAR_OPTIMISED_START_H

#include "subsystem.h"

/* Transform a pose x, y (m), yaw (rad) to a frame: ahead, left, relative yaw. */
static inline void to_frame(const double *frame, double *pose)
{
    const double cosine = cos(frame[AT_YAW]), sine = sin(frame[AT_YAW]);
    const double east = pose[AT_X] - frame[AT_X], north = pose[AT_Y] - frame[AT_Y];

    pose[AT_X] = cosine * east + sine * north;
    pose[AT_Y] = cosine * north - sine * east;
    pose[AT_YAW] -= frame[AT_YAW];
}

/* Transform a pose from a frame to the world; the inverse of to_frame. */
static inline void from_frame(const double *frame, double *pose)
{
    const double cosine = cos(frame[AT_YAW]), sine = sin(frame[AT_YAW]);
    const double ahead = pose[AT_X], left = pose[AT_Y];

    pose[AT_X] = frame[AT_X] + cosine * ahead - sine * left;
    pose[AT_Y] = frame[AT_Y] + sine * ahead + cosine * left;
    pose[AT_YAW] += frame[AT_YAW];
}

/* Bounds of the initial state, from the estimate and the successor of the last nominal state. */
static inline void allow_first_state(const struct subsystem *body, struct rti *solver)
{
    int inside = 1;

    for (int i = 0; i < NX; ++i)
        inside &= fabs(body->estimated[i] - body->nominal[i]) <= body->reach[i];
    for (int i = 0; i < NX; ++i) {
        solver->lower[i] = inside ? body->estimated[i] - body->half_widths[i] : body->nominal[i];
        solver->upper[i] = inside ? body->estimated[i] + body->half_widths[i] : body->nominal[i];
    }
}

/* Change to the path's frame at the estimate, and transform the last plan to it. */
static inline void change_frame(struct subsystem *body, struct rti *solver, const double *closest)
{
    double old[3];

    memcpy(old, body->frame, sizeof old);
    memcpy(body->frame, closest, sizeof old);
    for (int k = 0; k <= N; ++k) {
        from_frame(old, STATE(solver->z, k));
        to_frame(body->frame, STATE(solver->z, k));
    }
    from_frame(old, body->successor);
    to_frame(body->frame, body->successor);
    rti_prepare(solver);
}

static inline void pose_to_frame(const double *frame, struct drawbar_pose *pose)
{
    double seen[3] = {pose->x, pose->y, pose->yaw};

    to_frame(frame, seen);
    *pose = (struct drawbar_pose){seen[AT_X], seen[AT_Y], seen[AT_YAW]};
}

/* Transform estimate and reference to the frame; samples: N + 1 rows for the reference. */
static inline void state_in_frame(struct subsystem *body, struct drawbar_estimate *estimate,
                                  struct drawbar_body_reference *reference, double (*samples)[4])
{
    pose_to_frame(body->frame, &estimate->tractor);
    pose_to_frame(body->frame, &estimate->trailer);
    to_frame(body->frame, reference->closest);
    memcpy(samples, reference->samples, (N + 1) * sizeof *samples);
    for (int k = 0; k <= N; ++k)
        to_frame(body->frame, samples[k]);
    reference->samples = (const double (*)[4])samples;
}

/* Transform the plan's poses from the frame to the world. */
static inline void place_in_world(struct subsystem *body)
{
    for (int k = 0; k <= N; ++k)
        from_frame(body->frame, body->poses[k]);
}

#endif

/* A nominal state that the nominal problem chooses itself, within the tube around the estimate (Mayne et al. 2005).
 *
 * The first state is free in a box, whose sides are offset and heading in the path's frame at the estimate: there the
 * problem, and all that is remembered of it, is stated. While the state that the nominal model got to is in the box
 * around the estimate, all of the box may be chosen; both leave the vehicle in its tube. Outside the box that state is
 * the only one that surely does, and is kept.
 */
#ifndef DRAWBAR_OPTIMISED_START_H
#define DRAWBAR_OPTIMISED_START_H

#include "subsystem.h"

/* A pose x, y (m), yaw (rad) as seen from a frame: ahead, left, turned. */
static inline void seen_from(const double *frame, double *pose)
{
    const double cosine = cos(frame[AT_YAW]), sine = sin(frame[AT_YAW]);
    const double east = pose[AT_X] - frame[AT_X], north = pose[AT_Y] - frame[AT_Y];

    pose[AT_X] = cosine * east + sine * north;
    pose[AT_Y] = cosine * north - sine * east;
    pose[AT_YAW] -= frame[AT_YAW];
}

/* A pose, given as seen from a frame, in the world; the inverse of seen_from. */
static inline void placed_at(const double *frame, double *pose)
{
    const double cosine = cos(frame[AT_YAW]), sine = sin(frame[AT_YAW]);
    const double ahead = pose[AT_X], left = pose[AT_Y];

    pose[AT_X] = frame[AT_X] + cosine * ahead - sine * left;
    pose[AT_Y] = frame[AT_Y] + sine * ahead + cosine * left;
    pose[AT_YAW] += frame[AT_YAW];
}

/* The least and the largest first state, from the estimate and where the nominal model got. */
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

/* Take the path's frame here for what follows; state what is remembered of the problem in it. */
static inline void change_frame(struct subsystem *body, struct rti *solver, const double *closest)
{
    double old[3];

    memcpy(old, body->frame, sizeof old);
    memcpy(body->frame, closest, sizeof old);
    for (int k = 0; k <= N; ++k) {
        placed_at(old, STATE(solver->z, k));
        seen_from(body->frame, STATE(solver->z, k));
    }
    placed_at(old, body->successor);
    seen_from(body->frame, body->successor);
    rti_prepare(solver);
}

static inline void pose_seen(const double *frame, struct drawbar_pose *pose)
{
    double seen[3] = {pose->x, pose->y, pose->yaw};

    seen_from(frame, seen);
    *pose = (struct drawbar_pose){seen[AT_X], seen[AT_Y], seen[AT_YAW]};
}

/* What the problem is made of as seen from the frame; samples: N + 1 rows for the reference. */
static inline void see_from_frame(struct subsystem *body, struct drawbar_estimate *estimate,
                                  struct drawbar_body_reference *reference, double (*samples)[4])
{
    pose_seen(body->frame, &estimate->tractor);
    pose_seen(body->frame, &estimate->trailer);
    seen_from(body->frame, reference->closest);
    memcpy(samples, reference->samples, (N + 1) * sizeof *samples);
    for (int k = 0; k <= N; ++k)
        seen_from(body->frame, samples[k]);
    reference->samples = (const double (*)[4])samples;
}

/* The plan's poses, which the frame saw. */
static inline void place_in_world(struct subsystem *body)
{
    for (int k = 0; k <= N; ++k)
        placed_at(body->frame, body->poses[k]);
}

#endif

/* Guidance: from where the vehicle is to what its two controllers shall follow; what both kinds of it share.
 *
 * The closest point of each body is searched in a window around that body's last progress, never on the whole path:
 * where the path crosses itself a global search would jump to the other branch. The including unit defines STAGES.
 */
#ifndef DRAWBAR_GUIDANCE_H
#define DRAWBAR_GUIDANCE_H

#include "geometry.h"
#include "guidance_status.h"
#include "path.h"
#include "signals.h"

enum { TRACTOR, TRAILER, BODIES };

struct guidance {
    double window_behind, window_ahead;    /* of the last progress, m */
    double start_distance;                 /* largest distance of the tractor from the path's start, m */
    double progress[BODIES];               /* arc length of the closest points, m */
    double samples[BODIES][STAGES + 1][4]; /* as path_sample, yaw on the branch of the estimate */
};

#define GUIDANCE_FIELDS(type, prefix)                                                                        \
    SETTING(type, prefix window_behind, 0, 1, 0, 0) SETTING(type, prefix window_ahead, 0, 1, 0, 0)           \
    SETTING(type, prefix start_distance, 0, 1, 0, 0) FIELD(type, prefix progress, 0, BODIES, 0, 0)           \
    FIELD(type, prefix samples, 0, BODIES, STAGES + 1, 4)

/* Place both bodies on the path from where they stand when the run begins. */
static inline int guidance_begin(struct guidance *guidance, const struct path *path,
                                 const struct drawbar_measurement *first)
{
    const double reach = guidance->start_distance;
    double start[4], error;

    path_sample(path, 0.0, start);
    if (!(hypot(first->tractor_x - start[AT_X], first->tractor_y - start[AT_Y]) <= reach))
        return GUIDANCE_FAR_FROM_START;
    if (!isfinite(first->trailer_x + first->trailer_y))
        return GUIDANCE_POSE_NOT_FINITE;
    guidance->progress[TRACTOR] = path_project(path, first->tractor_x, first->tractor_y, -reach, reach, &error);
    /* the trailer stands behind the tractor, which may itself stand behind the start */
    guidance->progress[TRAILER] = path_project(path, first->trailer_x, first->trailer_y, -3.0 * reach, reach, &error);
    return GUIDANCE_FINE;
}

/* Whether the tractor has reached the end of the path. */
static inline int guidance_finished(const struct guidance *guidance, const struct path *path)
{
    return guidance->progress[TRACTOR] >= path_length(path);
}

/* The arc length (m) of the point closest to a pose, in the window around an arc length `last` (m). */
static inline double guidance_closest(const struct guidance *guidance, const struct path *path,
                                      const struct drawbar_pose *pose, double last, double *error)
{
    return path_project(path, pose->x, pose->y, last - guidance->window_behind, last + guidance->window_ahead, error);
}

static inline int is_finite_pose(const struct drawbar_pose *pose)
{
    return isfinite(pose->x + pose->y + pose->yaw);
}

/* Move the progress to beside the estimate, and fill in what the references say of the closest points. */
static inline int guidance_advance(struct guidance *guidance, const struct path *path,
                                   const struct drawbar_estimate *estimate,
                                   struct drawbar_body_reference *const references[BODIES])
{
    const struct drawbar_pose *const poses[BODIES] = {&estimate->tractor, &estimate->trailer};

    if (!is_finite_pose(poses[TRACTOR]) || !is_finite_pose(poses[TRAILER]))
        return GUIDANCE_POSE_NOT_FINITE;
    for (int i = 0; i < BODIES; ++i) {
        struct drawbar_body_reference *reference = references[i];
        guidance->progress[i]
            = guidance_closest(guidance, path, poses[i], guidance->progress[i], &reference->lateral_error);
        reference->progress = guidance->progress[i];
        path_sample(path, reference->progress, reference->closest);
        reference->samples = (const double (*)[4])guidance->samples[i];
    }
    return GUIDANCE_FINE;
}

/* Shift the samples' continuous yaws by the multiple of 2 pi that brings the first nearest to the estimate's. */
static inline void guidance_to_branch(struct guidance *guidance, const struct drawbar_estimate *estimate)
{
    const double targets[BODIES] = {estimate->tractor.yaw, estimate->trailer.yaw};

    for (int i = 0; i < BODIES; ++i) {
        const double first = guidance->samples[i][0][AT_YAW], shift = nearest_branch(first, targets[i]) - first;
        for (int j = 0; j <= STAGES; ++j)
            guidance->samples[i][j][AT_YAW] += shift;
    }
}

#endif

/* Guidance: references of both controllers from the estimate and the path; shared by both kinds of guidance.
 *
 * The closest point of each body is searched in a window around that body's last progress, never on the whole path:
 * where the path crosses itself a global search would jump to the other branch. The including unit defines STAGES.
 */
#ifndef DRAWBAR_GUIDANCE_H
#define DRAWBAR_GUIDANCE_H

#include <string.h>
#include "geometry.h"
#include "path.h"
#include "signals.h"
#include "tracked.h"

#define GUIDANCE_UNDER 1.0                 /* largest distance from a path that begins under the vehicle, m */
#define FACING_AWAY (DRAWBAR_PI / 3.0)     /* heading error beyond which the controllers' linearisations do not converge, rad */

enum { TRACTOR, TRAILER, BODIES };

struct guidance {
    double window_behind, window_ahead;    /* of the last progress, m */
    double start_distance;                 /* largest distance of the tractor from where a run begins, m */
    struct tracked tracked[BODIES];
    double progress[BODIES];               /* arc length of the closest points, m */
    double samples[BODIES][STAGES + 1][4]; /* as path_sample, yaw on the branch of the estimate */
};

#define TRACKED_FIELDS(type, place)                                                                          \
    SETTING(type, place.arm, 0, 2, 0, 0) SETTING(type, place.axle, 0, 1, 0, 0)
#define GUIDANCE_FIELDS(type, prefix)                                                                        \
    SETTING(type, prefix window_behind, 0, 1, 0, 0) SETTING(type, prefix window_ahead, 0, 1, 0, 0)           \
    SETTING(type, prefix start_distance, 0, 1, 0, 0) TRACKED_FIELDS(type, prefix tracked[TRACTOR])           \
    TRACKED_FIELDS(type, prefix tracked[TRAILER]) FIELD(type, prefix progress, 0, BODIES, 0, 0)           \
    FIELD(type, prefix samples, 0, BODIES, STAGES + 1, 4)

/* Place both bodies (x, y, m) on the path near an arc length (m); `distance` becomes the tractor's from there (m). */
static inline int guidance_place(struct guidance *guidance, const struct path *path, double start,
                                 const double *tractor, const double *trailer, double *distance)
{
    const double reach = guidance->start_distance;
    double beginning[4], error;

    drawbar_path_sample(path, start, beginning);
    *distance = hypot(tractor[0] - beginning[AT_X], tractor[1] - beginning[AT_Y]);
    if (!(*distance <= reach))
        return DRAWBAR_GUIDANCE_FAR_FROM_START;
    if (!isfinite(trailer[0] + trailer[1]))
        return DRAWBAR_GUIDANCE_POSE_NOT_FINITE;
    guidance->progress[TRACTOR] = drawbar_path_project(path, tractor[0], tractor[1], start - reach, start + reach, &error);
    /* the trailer stands behind the tractor, which may itself stand behind the start */
    guidance->progress[TRAILER]
        = drawbar_path_project(path, trailer[0], trailer[1], start - 3.0 * reach, start + reach, &error);
    return DRAWBAR_GUIDANCE_FINE;
}

/* The estimate with the poses of the tracked points in place of the bodies'. */
static inline struct drawbar_estimate guidance_tracked(const struct guidance *guidance,
                                                       const struct drawbar_estimate *estimate)
{
    struct drawbar_estimate tracked = *estimate;
    struct drawbar_pose *const poses[BODIES] = {&tracked.tractor, &tracked.trailer};
    double place[2];

    for (int i = 0; i < BODIES; ++i) {
        tracked_place(guidance->tracked[i].arm, poses[i]->x, poses[i]->y, poses[i]->yaw, place);
        poses[i]->x = place[0];
        poses[i]->y = place[1];
    }
    return tracked;
}

/* Place both bodies from where they are measured when the run begins; see guidance_place. */
static inline int guidance_begin(struct guidance *guidance, const struct path *path, double start,
                                 const struct drawbar_measurement *first, double *distance)
{
    const double tractor[] = {first->tractor_x, first->tractor_y}, trailer[] = {first->trailer_x, first->trailer_y};
    const int status = guidance_place(guidance, path, start, tractor, trailer, distance);

    for (int i = 0; i < BODIES; ++i)       /* without a yaw yet: the window covers the error */
        guidance->progress[i] += guidance->tracked[i].arm[0];
    return status;
}

/* Place both bodies on another path, from where they are estimated; nothing changes where the tractor is not on it, or
 * faces away. */
static inline int guidance_change(struct guidance *guidance, const struct path *path, double start,
                                  const struct drawbar_estimate *estimate)
{
    const struct drawbar_estimate tracked = guidance_tracked(guidance, estimate);
    const double tractor[] = {tracked.tractor.x, tracked.tractor.y};
    const double trailer[] = {tracked.trailer.x, tracked.trailer.y};
    struct guidance placed = *guidance;
    double sample[4], distance;
    const int status = guidance_place(&placed, path, start, tractor, trailer, &distance);

    if (status != DRAWBAR_GUIDANCE_FINE)
        return status;
    drawbar_path_sample(path, placed.progress[TRACTOR], sample);
    if (!(hypot(tractor[0] - sample[AT_X], tractor[1] - sample[AT_Y]) <= GUIDANCE_UNDER
          && fabs(wrapped(estimate->tractor.yaw - sample[AT_YAW])) <= FACING_AWAY))
        return DRAWBAR_GUIDANCE_FAR_FROM_START;
    *guidance = placed;
    return DRAWBAR_GUIDANCE_FINE;
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
    return drawbar_path_project(path, pose->x, pose->y, last - guidance->window_behind, last + guidance->window_ahead, error);
}

static inline int is_finite_pose(const struct drawbar_pose *pose)
{
    return isfinite(pose->x + pose->y + pose->yaw);
}

/* Update the progress to the points closest to the estimate, and fill in these points of the references. */
static inline int guidance_advance(struct guidance *guidance, const struct path *path,
                                   const struct drawbar_estimate *estimate,
                                   struct drawbar_body_reference *const references[BODIES])
{
    const struct drawbar_pose *const poses[BODIES] = {&estimate->tractor, &estimate->trailer};

    if (!is_finite_pose(poses[TRACTOR]) || !is_finite_pose(poses[TRAILER]))
        return DRAWBAR_GUIDANCE_POSE_NOT_FINITE;
    for (int i = 0; i < BODIES; ++i) {
        struct drawbar_body_reference *reference = references[i];
        guidance->progress[i]
            = guidance_closest(guidance, path, poses[i], guidance->progress[i], &reference->lateral_error);
        reference->progress = guidance->progress[i];
        drawbar_path_sample(path, reference->progress, reference->closest);
        reference->samples = (const double (*)[4])guidance->samples[i];
    }
    return DRAWBAR_GUIDANCE_FINE;
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

/* Convert the references of the tracked points to those of the bodies' own points. */
static inline void guidance_to_bodies(struct guidance *guidance, const struct drawbar_estimate *estimate,
                                      struct drawbar_body_reference *const references[BODIES])
{
    const double yaws[BODIES] = {estimate->tractor.yaw, estimate->trailer.yaw};
    const double crabs[BODIES] = {estimate->tractor_crab, estimate->trailer_crab};

    for (int i = 0; i < BODIES; ++i) {
        if (tracked_is_body(&guidance->tracked[i]))
            continue;
        tracked_body(&guidance->tracked[i], estimate, yaws[i], crabs[i], guidance->samples[i]);
        memcpy(references[i]->closest, guidance->samples[i][0], sizeof references[i]->closest);
    }
}

#endif

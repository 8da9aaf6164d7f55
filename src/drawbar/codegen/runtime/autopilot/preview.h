/* Preview guidance: the path itself, at the pace at which the vehicle will cover it over the horizon.
 *
 * Stage j of each body is the path at its progress plus j mu v dt; it never moves back. A tractor that faces away from
 * what it shall follow is led onto the path by turns (approach.h); the trailer comes after as it may.
 */
#ifndef DRAWBAR_PREVIEW_H
#define DRAWBAR_PREVIEW_H

#include "approach.h"
#include "guidance.h"
#include "unit.h"

#define ASTRAY (DRAWBAR_PI / 3.0)          /* heading error up to which the controllers find their way by themselves;
                                              beyond it their linearisations do not, rad */

struct part {
    struct guidance guidance;
    struct turn_limits limits;
    double interval;                       /* s */
    double wheelbase;                      /* m */
    double room;                           /* how far beside the path turns may lead, m */
    double furthest[BODIES];               /* progress so far, m */
    double approached;                     /* progress on the approach, m */
    struct approach approach;
};

#define WORK struct onto_line              /* what the search for turns borrows, see workspace.h */
#define PART_FIELDS                                                                                          \
    GUIDANCE_FIELDS(part, guidance.) SETTING(part, limits.curvature, 0, 1, 0, 0)                             \
    SETTING(part, limits.rate, 0, 1, 0, 0) SETTING(part, interval, 0, 1, 0, 0)                               \
    SETTING(part, wheelbase, 0, 1, 0, 0) SETTING(part, room, 0, 1, 0, 0)

/* Place both bodies on the path from where they stand when the run begins; returns an enum guidance_status. */
int UNIT(begin)(struct part *part, const struct path *path, const struct drawbar_measurement *first)
{
    part->furthest[TRACTOR] = part->furthest[TRAILER] = -INFINITY;
    part->approach.count = 0;
    return guidance_begin(&part->guidance, path, first);
}

/* Whether the tractor has reached the end of the path. */
int UNIT(finished)(struct part *part, const struct path *path)
{
    return guidance_finished(&part->guidance, path);
}

/* Move the progress forward, on an approach as long as there is one. */
static void preview_advance(struct part *part, const struct drawbar_pose *tractor)
{
    const struct guidance *guidance = &part->guidance;
    const struct path track = approach_track(&part->approach);
    double error;

    for (int i = 0; i < BODIES; ++i)
        part->furthest[i] = fmax(part->furthest[i], guidance->progress[i]);
    if (track.count == 0)
        return;
    part->approached = fmax(part->approached, guidance_closest(guidance, &track, tractor, part->approached, &error));
    if (part->approached < path_length(&track))
        return;
    part->approach.count = 0;
    for (int i = 0; i < BODIES; ++i)       /* the turns may have led back behind where they began */
        part->furthest[i] = guidance->progress[i];
}

/* Sample what the tractor follows at a distance (m) ahead. */
static void preview_ahead(const struct part *part, const struct path *path, double distance, double *sample)
{
    if (part->approach.count > 0)
        approach_sample(&part->approach, path, part->approached + distance, sample);
    else
        path_sample(path, part->furthest[TRACTOR] + distance, sample);
}

/* Whether a heading (rad) is too far from that of what the tractor follows. */
static int preview_astray(const struct part *part, const struct path *path, double yaw)
{
    double sample[4];

    preview_ahead(part, path, 0.0, sample);
    return fabs(wrapped(yaw - sample[2])) > ASTRAY;
}

/* Begin turns where the tractor faces away from the path, and leave those that it faces away from. Returns 0 where no
 * turns lead onto the path. */
static int preview_turn(struct part *part, const struct path *path, const struct drawbar_estimate *estimate,
                        struct onto_line *line)
{
    const struct drawbar_pose *tractor = &estimate->tractor;

    if (part->approach.count > 0 && preview_astray(part, path, tractor->yaw))
        part->approach.count = 0;
    if (part->approach.count > 0 || !preview_astray(part, path, tractor->yaw))
        return 1;
    const double angle = estimate->tractor_slip * estimate->tractor_steering + estimate->steering_offset;
    const struct beside_path beside
        = beside_path(path, tractor, part->guidance.progress[TRACTOR], tan(angle) / part->wheelbase);
    part->approached = 0.0;
    return approach_find(&part->approach, path, &beside, &part->limits, part->room, line);
}

/* What both controllers shall follow now; returns an enum guidance_status. */
int UNIT(reference)(struct part *part, const struct path *path, const struct drawbar_estimate *estimate,
                    struct drawbar_body_reference *tractor, struct drawbar_body_reference *trailer, void *work)
{
    struct guidance *guidance = &part->guidance;
    struct drawbar_body_reference *const references[BODIES] = {tractor, trailer};
    const double speed = estimate->longitudinal_slip * estimate->speed;
    const int status = guidance_advance(guidance, path, estimate, references);

    if (status != GUIDANCE_FINE)
        return status;
    if (!isfinite(speed))
        return GUIDANCE_SPEED_NOT_FINITE;
    preview_advance(part, &estimate->tractor);
    if (!preview_turn(part, path, estimate, work))
        return GUIDANCE_NO_WAY;
    for (int j = 0; j <= STAGES; ++j) {
        const double distance = speed * (part->interval * j);
        preview_ahead(part, path, distance, guidance->samples[TRACTOR][j]);
        path_sample(path, part->furthest[TRAILER] + distance, guidance->samples[TRAILER][j]);
    }
    guidance_to_branch(guidance, estimate);
    return GUIDANCE_FINE;
}

#endif

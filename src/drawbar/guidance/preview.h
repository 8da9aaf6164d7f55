/* Preview guidance: the path itself, sampled as the vehicle will cover it over the horizon.
 *
 * Stage j of each body is the path at its progress plus j mu v dt; it never moves back. A tractor whose heading is
 * too far from its reference is led onto the path by turns (approach.h); the trailer follows without a reference of its own.
 * A vehicle that faces along the line but begins beside it is led onto it by a shift (line_offset.h), the longer the faster it
 * is: taken back at once, the offset would make the steering turn to and fro while its dead time and lag are not known yet.
 */
#ifndef DRAWBAR_PREVIEW_H
#define DRAWBAR_PREVIEW_H

#include "noinline.h"
#include "approach.h"
#include "guidance.h"
#include "unit.h"

#define JOIN_JERK 0.2                      /* largest change of the lateral acceleration while a line is joined, m/s^3 */
#define JOIN_SLOWEST 0.1                   /* speed that a join is laid for at least, m/s */
#define JOIN_WIDEST 0.5                    /* of the tightest turn's radius: from further beside the line there is no join */

struct component {
    struct guidance guidance;
    struct turn_limits limits;
    double interval;                       /* s */
    double wheelbase;                      /* m */
    double room;                           /* how far beside the path turns may lead, m */
    double furthest[BODIES];               /* progress so far, m */
    double approached;                     /* progress on the approach, m */
    struct approach approach;
    struct offset_shift joins[BODIES];     /* of each body, onto the line from where it began beside it; change 0: none,
                                              length 0: to be laid with the next references */
};

#define WORK struct onto_line              /* scratch memory of the search for turns, see workspace.h */
#define COMPONENT_FIELDS                                                                                          \
    GUIDANCE_FIELDS(component, guidance.) SETTING(component, limits.curvature, 0, 1, 0, 0)                             \
    SETTING(component, limits.rate, 0, 1, 0, 0) SETTING(component, interval, 0, 1, 0, 0)                               \
    SETTING(component, wheelbase, 0, 1, 0, 0) SETTING(component, room, 0, 1, 0, 0)

/* Let the next references lead onto the line from where the bodies then are. */
void UNIT(rejoin)(struct component *component)
{
    component->joins[TRACTOR].length = component->joins[TRAILER].length = 0.0;
}

/* Forget where the bodies were on a path. */
static void preview_restart(struct component *component)
{
    component->furthest[TRACTOR] = component->furthest[TRAILER] = -(double)INFINITY;
    component->approach.count = 0;
}

/* Place both bodies on the path from where they stand when the run begins; returns an enum drawbar_guidance. */
int UNIT(begin)(struct component *component, const struct path *path, double start,
                const struct drawbar_measurement *first, double *distance)
{
    preview_restart(component);
    UNIT(rejoin)(component);
    return guidance_begin(&component->guidance, path, start, first, distance);
}

/* Go on along another path; nothing changes where the vehicle is not on it. Joins continue beside that path. */
int UNIT(change)(struct component *component, const struct path *path, double start,
                 const struct drawbar_estimate *estimate)
{
    const double *progress = component->guidance.progress, before[BODIES] = {progress[TRACTOR], progress[TRAILER]};
    const int status = guidance_change(&component->guidance, path, start, estimate);

    if (status != DRAWBAR_GUIDANCE_FINE)
        return status;
    preview_restart(component);
    for (int i = 0; i < BODIES; ++i)
        component->joins[i].start += progress[i] - before[i];
    return status;
}

/* Whether the tractor has reached the end of the path. */
int UNIT(finished)(struct component *component, const struct path *path)
{
    return guidance_finished(&component->guidance, path);
}

/* Move the progress forward, on an approach as long as there is one. */
static void preview_advance(struct component *component, const struct drawbar_pose *tractor)
{
    const struct guidance *guidance = &component->guidance;
    const struct path track = approach_track(&component->approach);
    double error;

    for (int i = 0; i < BODIES; ++i)
        component->furthest[i] = fmax(component->furthest[i], guidance->progress[i]);
    if (track.count == 0)
        return;
    component->approached = fmax(component->approached, guidance_closest(guidance, &track, tractor, component->approached, &error));
    if (component->approached < path_length(&track))
        return;
    component->approach.count = 0;
    for (int i = 0; i < BODIES; ++i)       /* the turns may have led back behind where they began */
        component->furthest[i] = guidance->progress[i];
}

/* Whether a tractor of this yaw (rad) faces away from what it follows: the path, or the turns onto it. */
static int preview_faces_away(const struct component *component, const struct path *path, double yaw)
{
    double sample[4];

    if (component->approach.count > 0)
        approach_sample(&component->approach, path, component->approached, sample);
    else
        drawbar_path_sample(path, component->furthest[TRACTOR], sample);
    return fabs(wrapped(yaw - sample[AT_YAW])) > FACING_AWAY;
}

/* Begin turns where the tractor faces away from the path, and leave those that it faces away from. Returns 0 where no
 * turns lead onto the path. */
static int preview_turn(struct component *component, const struct path *path, const struct drawbar_estimate *estimate,
                        struct onto_line *line)
{
    const struct drawbar_pose *tractor = &estimate->tractor;

    if (component->approach.count > 0 && preview_faces_away(component, path, tractor->yaw))
        component->approach.count = 0;
    if (component->approach.count > 0 || !preview_faces_away(component, path, tractor->yaw))
        return 1;
    const double angle = estimate->tractor_slip * estimate->tractor_steering + estimate->steering_offset;
    const struct beside_path beside
        = beside_path(path, tractor, component->guidance.progress[TRACTOR], tan(angle) / component->wheelbase);
    component->approached = 0.0;
    return approach_find(&component->approach, path, &beside, &component->limits, component->room, line);
}

/* A body's way onto the line, from so far (m) to its left and at a speed, m/s. */
static struct offset_shift preview_join(const struct component *component, int body, double left, double speed)
{
    const double pace = fmax(speed, JOIN_SLOWEST), rate = JOIN_JERK / (pace * pace * pace);
    const int joins = fabs(left) * component->limits.curvature <= JOIN_WIDEST;

    return (struct offset_shift){
        component->furthest[body], offset_length(left, (double)INFINITY, rate), joins ? -left : 0.0};
}

/* Lay the ways onto the line where there are none yet, and forget those that are at their end, or that turns replace. */
static void preview_lay_joins(struct component *component, struct drawbar_body_reference *const references[BODIES],
                              double speed)
{
    for (int i = 0; i < BODIES; ++i) {
        struct offset_shift *join = &component->joins[i];
        if (join->length == 0.0)
            *join = preview_join(component, i, references[i]->lateral_error, speed);
        if (component->approach.count > 0 || component->furthest[i] > join->start + join->length)
            join->change = 0.0;
    }
}

/* Lead a sample of the line, at an arc length (m), onto the join. Returns how much faster that continues than the line. */
static double preview_apply_join(const struct offset_shift *join, double arc_length, double *sample)
{
    const struct line_offset offset = {.passed = -join->change, .shifts = {*join}, .count = 1};
    const double curvature = sample[AT_CURVATURE];
    double at[3];

    offset_at(&offset, arc_length, at);
    offset_apply(&offset, arc_length, sample);
    return offset_stretch(at, curvature);
}

/* Sample what a body follows at every stage, so far (m) from one to the next, where that is not the path itself, or beside it.
 * What is tracked to the left of a body continues slower in a curve to the left, and faster in one to the right. */
static void preview_samples_beside(struct component *component, const struct path *path, int body, double step)
{
    double (*samples)[4] = component->guidance.samples[body], place = component->furthest[body];
    const double left = component->guidance.tracked[body].arm[1];

    for (int j = 0; j <= STAGES; ++j) {
        double stretch = 1.0;
        if (body == TRACTOR && component->approach.count > 0) {
            approach_sample(&component->approach, path, component->approached + step * j, samples[j]);
        } else {
            drawbar_path_sample(path, place, samples[j]);
            stretch = preview_apply_join(&component->joins[body], place, samples[j]);
        }
        place = path_ahead(path, place, step / fmax(stretch + left * samples[j][AT_CURVATURE], 0.2));
    }
}

/* The same on any line, at a speed over ground, m/s. */
static NOINLINE void preview_samples(struct component *component, const struct path *path, int body, double speed)
{
    double places[STAGES + 1];

    if ((body == TRACTOR && component->approach.count > 0) || component->guidance.tracked[body].arm[1] != 0.0
        || !offset_is_none(path->offset) || component->joins[body].change != 0.0) {
        preview_samples_beside(component, path, body, speed * component->interval);
        return;
    }
    for (int j = 0; j <= STAGES; ++j)
        places[j] = component->furthest[body] + speed * (component->interval * j);
    drawbar_path_samples(path, places, STAGES + 1, component->guidance.samples[body]);
}

/* What both controllers shall follow now; returns an enum drawbar_guidance. */
int UNIT(reference)(struct component *component, const struct path *path, const struct drawbar_estimate *estimate,
                    struct drawbar_body_reference *tractor, struct drawbar_body_reference *trailer, void *work)
{
    struct guidance *guidance = &component->guidance;
    struct drawbar_body_reference *const references[BODIES] = {tractor, trailer};
    const double speed = estimate->longitudinal_slip * estimate->speed;
    const struct drawbar_estimate tracked = guidance_tracked(guidance, estimate);
    const int status = guidance_advance(guidance, path, &tracked, references);

    if (status != DRAWBAR_GUIDANCE_FINE)
        return status;
    if (!isfinite(speed))
        return DRAWBAR_GUIDANCE_SPEED_NOT_FINITE;
    preview_advance(component, &tracked.tractor);
    if (!preview_turn(component, path, &tracked, work))
        return DRAWBAR_GUIDANCE_NO_WAY;
    preview_lay_joins(component, references, speed);
    for (int i = 0; i < BODIES; ++i)
        preview_samples(component, path, i, speed);
    guidance_to_branch(guidance, estimate);
    guidance_to_bodies(guidance, estimate, references);
    return DRAWBAR_GUIDANCE_FINE;
}

#endif

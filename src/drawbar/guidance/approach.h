/* Approach: the track onto the path for a vehicle that faces away from it, three turns within its limits (turns.h).
 *
 * The turns are found beside a straight line, then laid along the path: a point of theirs is an arc length of the path
 * and a distance to its left. Beside a curved path they become a little tighter or wider by that. Laying is what costs:
 * a candidate is checked on its arcs first, where the limits are exceeded if anywhere, and only a few are laid.
 */
#ifndef DRAWBAR_APPROACH_H
#define DRAWBAR_APPROACH_H

#include "noinline.h"
#include "onto_line.h"
#include "signals.h"

#define APPROACH_NODES 240                 /* longest track, in pieces of up to 0.25 m */
#define APPROACH_TIGHTER 1.4               /* how much tighter than their limit turns may become beside a curve */
#define APPROACH_LOOK (DRAWBAR_PI / 4.0)   /* between the directions in which an arc is looked at, rad */
#define APPROACH_LOOKS 18                  /* of them in a turn, at most */
#define APPROACH_FOUND 64                  /* candidates whose last turn is solved for, at most */
#define APPROACH_PLACES 448                /* of all candidates together, that are checked or traced and laid, at most */

/* A tractor's pose relative to the path. */
struct beside_path {
    double near;                           /* arc length of the path beside it, m */
    double offset;                         /* from the path, left positive, m */
    double heading;                        /* against the path, were it straight, rad */
    double curvature;                      /* of its motion as its wheels stand, 1/m */
};

/* A track from where the tractor stands to the path. */
struct approach {
    struct drawbar_path_node nodes[APPROACH_NODES];
    int32_t count;                         /* of the track's nodes; 0: there is no approach */
    double joins_at;                       /* arc length of the path at the track's end, m */
};

static inline struct path approach_track(const struct approach *approach)
{
    const struct path track = {approach->nodes, approach->count, NULL};
    return track;
}

/* Sample the track at an arc length (m) of it; beyond its end the path. */
static inline void approach_sample(const struct approach *approach, const struct path *path, double arc_length,
                                   double *sample)
{
    const struct path track = approach_track(approach);
    const double beyond = arc_length - path_length(&track);

    if (beyond > 0.0)
        drawbar_path_sample(path, approach->joins_at + beyond, sample);
    else
        drawbar_path_sample(&track, arc_length, sample);
}

/* What a track may do, and how much the search for one may cost. */
struct approach_limits {
    double widest;                         /* distance from the line, m */
    double tightest;                       /* curvature beside the path, 1/m */
    int32_t places;                        /* left to check, or to trace */
};

/* A unit vector along a direction, rad. */
struct approach_unit {
    double cosine, sine;
};

static NOINLINE struct approach_unit approach_unit(double direction)
{
    return (struct approach_unit){lane_cos(direction), lane_sin(direction)};
}

/* The track's largest distance from the line, m. */
static inline double approach_widest(const struct approach *approach)
{
    double widest = 0.0;

    for (int32_t i = 0; i < approach->count; ++i)
        widest = fmax(widest, fabs(approach->nodes[i].y));
    return widest;
}

/* Lay a node, found beside a straight line, beside the path. Its direction (rad) against the line becomes another one
 * against the path. */
static inline void approach_lay_node(struct drawbar_path_node *node, const struct path *path, double direction)
{
    const double left = node->y;
    double sample[4];

    drawbar_path_sample(path, node->x, sample);
    const struct approach_unit ahead = approach_unit(sample[AT_YAW]), along = approach_unit(direction);
    node->x = sample[AT_X] - left * ahead.sine;
    node->y = sample[AT_Y] + left * ahead.cosine;
    node->yaw = sample[AT_YAW] + atan2(along.sine, (1.0 - left * sample[AT_CURVATURE]) * along.cosine);
}

/* Join two laid nodes: continuous yaw, arc length from the chord. Returns 0 where the piece is none, or begins tighter
 * than the given curvature, 1/m. */
static inline int approach_join(struct drawbar_path_node *a, double tightest)
{
    struct drawbar_path_node *b = a + 1;

    b->yaw = nearest_branch(b->yaw, a->yaw);
    const double half_turn = 0.5 * (b->yaw - a->yaw);
    const double arc = half_turn != 0.0 ? half_turn / approach_unit(half_turn).sine : 1.0;
    b->arc_length = a->arc_length + arc * hypot(b->x - a->x, b->y - a->y);
    if (!(b->arc_length > a->arc_length))
        return 0;
    const struct path joined = {a, 2, NULL};
    const struct path_cubic piece = drawbar_path_cubic(&joined, 1);
    return fabs(2.0 * (piece.x[1] * piece.y[2] - piece.y[1] * piece.x[2])) <= tightest;
}

/* Lay a track that was found beside a straight line along the path. Returns 0 where it cannot be, or is tighter than the
 * given curvature, 1/m. */
static inline int approach_lay(struct approach *approach, const struct path *path, double tightest)
{
    struct drawbar_path_node *nodes = approach->nodes, *last = &nodes[approach->count - 1];
    const double end = last->yaw;
    double closest[4];

    approach->joins_at = last->x;
    for (int32_t i = 0; i < approach->count; ++i) {
        approach_lay_node(&nodes[i], path, nodes[i].yaw - end);
        if (i > 0 && !approach_join(&nodes[i - 1], tightest))
            return 0;
    }
    /* the track ends in the path's direction; whole rounds before that are not the path's */
    drawbar_path_sample(path, approach->joins_at, closest);
    const double rounds = last->yaw - closest[AT_YAW];
    for (int32_t i = 0; i < approach->count; ++i)
        nodes[i].yaw -= rounds;
    return approach->count > 1;
}

/* The tractor's pose relative to the path's tangent at the arc length `near` (m). */
static inline struct beside_path beside_path(const struct path *path, const struct drawbar_pose *pose, double near,
                                             double curvature)
{
    double closest[4];

    drawbar_path_sample(path, near, closest);
    const double offset = cos(closest[AT_YAW]) * (pose->y - closest[AT_Y])
        - sin(closest[AT_YAW]) * (pose->x - closest[AT_X]);
    const double turned = wrapped(pose->yaw - closest[AT_YAW]);
    const double heading = atan2((1.0 - closest[AT_CURVATURE] * offset) * sin(turned), cos(turned));
    const struct beside_path beside = {near, offset, heading, curvature};
    return beside;
}

/* Trace turns by these angles (rad) beside a straight line, by `most` nodes: x is an arc length of the path, y a
 * distance to its left. */
static inline void approach_trace(struct approach *approach, const struct beside_path *from,
                                  const struct turn_limits *limits, const double *angles, int turns, int32_t most)
{
    const struct curve curve = curve_of_turns(limits, angles, turns, from->curvature);
    approach->count = curve_trace(&curve, from->near, from->offset, from->heading, approach->nodes,
                                  most < APPROACH_NODES ? most : APPROACH_NODES);
}

/* The curvature (1/m) that a curve gets where it is laid beside a path, from its own (1/m) in a direction beside a
 * straight line; the path is sampled where the curve is `left` (m) of it. */
static inline double approach_bend(const double *sample, double left, struct approach_unit direction, double bend)
{
    const double curvature = sample[AT_CURVATURE], nearer = 1.0 - left * curvature;
    const double cosine = direction.cosine, sine = direction.sine;
    const double squared = nearer * nearer * cosine * cosine + sine * sine;

    return (curvature * cosine + (nearer * bend + curvature * sine * sine * cosine) / squared) / sqrt(squared);
}

/* Whether a turn is within the limits on its arc: checked where it is furthest from the line, along it, and between. */
static inline int approach_turn_fits(const struct onto_line *line, const struct path *path, const double *begin,
                                     double angle, struct approach_limits *most)
{
    const struct turn_circle *circle = &line->circle;
    const double side = copysign(1.0, angle), bend = side * line->limits.curvature, ramp = 0.5 * side * circle->least;
    const struct approach_unit from = approach_unit(begin[2]);
    const double x = begin[0] + from.cosine * circle->ahead - from.sine * side * circle->left;
    const double y = begin[1] + from.sine * circle->ahead + from.cosine * side * circle->left;
    const double first = (begin[2] + ramp) / APPROACH_LOOK, last = (begin[2] + angle - ramp) / APPROACH_LOOK;
    double look = ceil(fmin(first, last)), sample[4];

    for (int i = 0; i < APPROACH_LOOKS && fabs(angle) > circle->least && look <= fmax(first, last); ++i) {
        const struct approach_unit direction = approach_unit(APPROACH_LOOK * look);
        const double left = y - direction.cosine / bend;
        if (most->places-- <= 0)
            return 0;
        drawbar_path_sample(path, x + direction.sine / bend, sample);
        if (!(fabs(left) <= most->widest) || !(fabs(approach_bend(sample, left, direction, bend)) <= most->tightest))
            return 0;
        look += 1.0;
    }
    return 1;
}

/* Whether the turns by these angles (rad) are within the limits, as far as that is decided without tracing them. `pose` is
 * where they begin: arc length of the path (m), distance to its left (m), heading against it (rad). */
static inline int approach_promises(const struct onto_line *line, const struct path *path, const double *angles,
                                    const double *pose, struct approach_limits *most)
{
    double now[3] = {pose[0], pose[1], pose[2]};

    for (int i = 0; i < TURNS; ++i) {
        const double chord = turn_chord(&line->limits, &line->circle, angles[i]), middle = now[2] + 0.5 * angles[i];
        if (!approach_turn_fits(line, path, now, angles[i], most))
            return 0;
        const struct approach_unit along = approach_unit(middle);
        now[0] += chord * along.cosine;
        now[1] += chord * along.sine;
        now[2] += angles[i];
    }
    return 1;
}

/* Find the shortest track onto the path that stays within the room (m) beside it, or no further off than the tractor is.
 * `line` is memory for the search. Returns 0 where there is none. */
static inline int approach_find(struct approach *approach, const struct path *path, const struct beside_path *from,
                                const struct turn_limits *limits, double room, struct onto_line *line)
{
    struct approach_limits most
        = {fmax(room, fabs(from->offset)), APPROACH_TIGHTER * limits->curvature, APPROACH_PLACES};
    struct candidate candidate;
    double angles[TURNS];

    approach_trace(approach, from, limits, NULL, 0, APPROACH_NODES);
    if (approach->count == 0)
        return 0;
    const struct drawbar_path_node *straight = &approach->nodes[approach->count - 1];
    const double pose[3] = {straight->x, straight->y, straight->yaw};
    line_candidates(line, limits, pose[1], pose[2], most.widest);
    while (line_take(line, APPROACH_FOUND, &candidate)) {
        candidate_angles(line, &candidate, angles);
        if (!approach_promises(line, path, angles, pose, &most))
            continue;
        approach_trace(approach, from, limits, angles, TURNS, most.places);
        if (approach->count == 0)          /* and those that follow are longer still, or nothing is left to spend */
            return 0;
        most.places -= approach->count;
        if (approach_widest(approach) <= most.widest && approach_lay(approach, path, most.tightest))
            return 1;
    }
    approach->count = 0;
    return 0;
}

#endif

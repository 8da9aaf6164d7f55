/* The way onto the path for a vehicle that faces away from it: three turns within the vehicle's limits (turns.h).
 *
 * The turns are found beside a straight line, then laid along the path: a point of theirs is an arc length of the path
 * and a distance to its left. Beside a curved path they become a little tighter or wider by that.
 */
#ifndef DRAWBAR_APPROACH_H
#define DRAWBAR_APPROACH_H

#include "onto_line.h"
#include "signals.h"

#define APPROACH_NODES 256                 /* longest way, in pieces of up to 0.25 m */
#define APPROACH_TIGHTER 1.4               /* how much tighter than their limit turns may become beside a curve */

/* Where a tractor stands, seen from the path. */
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
    struct onto_line line;                 /* the search that found it */
};

static inline struct path approach_track(const struct approach *approach)
{
    const struct path track = {approach->nodes, approach->count};
    return track;
}

/* Sample the track at an arc length (m) of it; beyond its end the path. */
static inline void approach_sample(const struct approach *approach, const struct path *path, double arc_length,
                                   double *sample)
{
    const struct path track = approach_track(approach);
    const double beyond = arc_length - path_length(&track);

    if (beyond > 0.0)
        path_sample(path, approach->joins_at + beyond, sample);
    else
        path_sample(&track, arc_length, sample);
}

/* How far beside the line the way leads, m. */
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

    path_sample(path, node->x, sample);
    node->x = sample[0] - left * sin(sample[2]);
    node->y = sample[1] + left * cos(sample[2]);
    node->yaw = sample[2] + atan2(sin(direction), (1.0 - left * sample[3]) * cos(direction));
}

/* Join two laid nodes: continuous yaw, arc length from the chord. Returns 0 where the piece is none, or begins tighter
 * than the given curvature, 1/m. */
static inline int approach_join(struct drawbar_path_node *a, double tightest)
{
    struct drawbar_path_node *b = a + 1;

    b->yaw = nearest_branch(b->yaw, a->yaw);
    const double half_turn = 0.5 * (b->yaw - a->yaw), arc = half_turn != 0.0 ? half_turn / sin(half_turn) : 1.0;
    b->arc_length = a->arc_length + arc * hypot(b->x - a->x, b->y - a->y);
    if (!(b->arc_length > a->arc_length))
        return 0;
    const struct path joined = {a, 2};
    const struct path_cubic piece = path_cubic(&joined, 1);
    return fabs(2.0 * (piece.x[1] * piece.y[2] - piece.y[1] * piece.x[2])) <= tightest;
}

/* Lay a way that was found beside a straight line along the path. Returns 0 where it cannot be, or is tighter than the
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
    /* the way ends in the path's direction; whole rounds before that are not the path's */
    path_sample(path, approach->joins_at, closest);
    const double rounds = last->yaw - closest[2];
    for (int32_t i = 0; i < approach->count; ++i)
        nodes[i].yaw -= rounds;
    return approach->count > 1;
}

/* See a tractor at a pose from the path at the arc length `near` (m), where a straight line takes its place. */
static inline struct beside_path beside_path(const struct path *path, const struct drawbar_pose *pose, double near,
                                             double curvature)
{
    double closest[4];

    path_sample(path, near, closest);
    const double offset = cos(closest[2]) * (pose->y - closest[1]) - sin(closest[2]) * (pose->x - closest[0]);
    const double turned = wrapped(pose->yaw - closest[2]);
    const double heading = atan2((1.0 - closest[3] * offset) * sin(turned), cos(turned));
    const struct beside_path beside = {near, offset, heading, curvature};
    return beside;
}

/* Trace turns by these angles (rad) beside a straight line: x is an arc length of the path, y a distance to its
 * left. */
static inline void approach_trace(struct approach *approach, const struct beside_path *from,
                                  const struct turn_limits *limits, const double *angles, int turns)
{
    const struct curve curve = curve_of_turns(limits, angles, turns, from->curvature);
    approach->count
        = curve_trace(&curve, from->near, from->offset, from->heading, approach->nodes, APPROACH_NODES);
}

/* Find the shortest way onto the path that stays within the room (m) beside it, or no further off than the tractor is.
 * Returns 0 where there is none. */
static inline int approach_find(struct approach *approach, const struct path *path, const struct beside_path *from,
                                const struct turn_limits *limits, double room)
{
    const double widest = fmax(room, fabs(from->offset));
    const struct drawbar_path_node *nodes = approach->nodes;
    struct way way;
    double angles[TURNS];

    approach_trace(approach, from, limits, NULL, 0);
    if (approach->count > 0)
        line_ways(&approach->line, limits, nodes[approach->count - 1].y, nodes[approach->count - 1].yaw, widest);
    while (approach->count > 0 && line_take(&approach->line, &way)) {
        way_angles(&approach->line, &way, angles);
        approach_trace(approach, from, limits, angles, TURNS);
        if (approach_widest(approach) <= widest && approach_lay(approach, path, APPROACH_TIGHTER * limits->curvature))
            return 1;
    }
    approach->count = 0;
    return 0;
}

#endif

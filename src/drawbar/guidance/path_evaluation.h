/* Evaluation of a path: what path.h declares, in one unit of a library. */
#ifndef DRAWBAR_PATH_EVALUATION_H
#define DRAWBAR_PATH_EVALUATION_H

#include <string.h>
#include "lanes.h"
#include "path.h"

#define PATH_PROJECTIONS 20                /* Newton steps of a projection, at most */
#define PATH_CONVERGED 1e-6                /* last Newton step, m; what is left after it is of its square */
#define PATH_ALONG 0.5                     /* cosine between two directions that are the same, or nearly */
#define PATH_BESIDE 0.25                   /* by which a later pass must be nearer than the first, m */

/* How many nodes lie before an arc length (m), or at it where `including`. */
static inline int32_t path_nodes_before(const struct path *path, double arc_length, int including)
{
    int32_t low = 0, high = path->count;

    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        const double node = path->nodes[middle].arc_length;
        if (node < arc_length || (including && node <= arc_length))
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* The second and third coefficient of one coordinate, from its mean slope and its slopes at both ends; bent: 0, they are none. */
static inline void path_bend(double *cubic, double mean, double end, double length, double bent)
{
    cubic[2] = bent * (3.0 * mean - 2.0 * cubic[1] - end) / length;
    cubic[3] = bent * (cubic[1] + end - 2.0 * mean) / (length * length);
}

/* How many nodes lie before an arc length (m), or at it: searched first near the number that was found for a place
 * nearby. */
static inline int32_t path_nodes_near(const struct path *path, double arc_length, int32_t near)
{
    const struct drawbar_path_node *nodes = path->nodes;

    for (int32_t i = near; i <= near + 1 && i <= path->count; ++i)
        if ((i == 0 || nodes[i - 1].arc_length <= arc_length) && (i == path->count || arc_length < nodes[i].arc_length))
            return i;
    return path_nodes_before(path, arc_length, 1);
}

/* Both ends of a piece, between two nodes or, for a straight one, from one node on. */
struct path_piece {
    struct drawbar_path_node from, to;
    double bent;                           /* 0 where it is straight, else 1 */
};

/* The ends of the piece in front of a node. */
static inline struct path_piece path_piece(const struct path *path, int32_t piece)
{
    const struct drawbar_path_node *from = &path->nodes[piece > 0 ? piece - 1 : 0];
    struct path_piece ends = {*from, *from, 0.0};

    if (piece > 0 && piece < path->count) {
        ends.to = from[1];
        ends.bent = 1.0;
    } else {
        ends.to.arc_length += 1.0;
    }
    return ends;
}

static inline struct path_cubic path_cubic_of(const struct path_piece *piece)
{
    const struct drawbar_path_node *a = &piece->from, *b = &piece->to;
    const double length = b->arc_length - a->arc_length;
    struct path_cubic cubic = {a->arc_length, a->yaw, {a->x, lane_cos(a->yaw)}, {a->y, lane_sin(a->yaw)}};

    path_bend(cubic.x, (b->x - a->x) / length, lane_cos(b->yaw), length, piece->bent);
    path_bend(cubic.y, (b->y - a->y) / length, lane_sin(b->yaw), length, piece->bent);
    return cubic;
}

struct path_cubic drawbar_path_cubic(const struct path *path, int32_t piece)
{
    const struct path_piece ends = path_piece(path, piece);

    return path_cubic_of(&ends);
}

/* x, y (m), continuous yaw (rad) and curvature (1/m) of a piece at an arc length, m. */
static inline void path_cubic_sample(const struct path_cubic *cubic, double arc_length, double *sample)
{
    const double distance = arc_length - cubic->anchor, *x = cubic->x, *y = cubic->y;
    const double slope_x = distance * x[3], slope_y = distance * y[3];
    const double inner_x = distance * (x[2] + slope_x), inner_y = distance * (y[2] + slope_y);
    const double tangent_x = x[1] + 2.0 * inner_x + distance * slope_x;
    const double tangent_y = y[1] + 2.0 * inner_y + distance * slope_y;
    const double bend_x = x[2] + 3.0 * slope_x, bend_y = y[2] + 3.0 * slope_y; /* half the second derivative */

    sample[AT_X] = x[0] + distance * (x[1] + inner_x);
    sample[AT_Y] = y[0] + distance * (y[1] + inner_y);
    sample[AT_YAW] = cubic->yaw + lane_atan2(tangent_y * x[1] - tangent_x * y[1], tangent_x * x[1] + tangent_y * y[1]);
    sample[AT_CURVATURE] = 2.0 * (tangent_x * bend_y - tangent_y * bend_x);
}

void drawbar_path_sample(const struct path *path, double arc_length, double sample[4])
{
    const struct path_cubic cubic = drawbar_path_cubic(path, path_nodes_before(path, arc_length, 1));

    path_cubic_sample(&cubic, arc_length, sample);
    if (!offset_is_none(path->offset))
        offset_apply(path->offset, arc_length, sample);
}

void drawbar_path_samples(const struct path *path, const double *arc_lengths, int64_t count, double (*samples)[4])
{
    int32_t before = 0;

    for (int64_t base = 0; base < count; base += LANES) {
        double in[9][LANES], out[4][LANES], at[LANES];
        const int lanes = count - base < LANES ? (int)(count - base) : LANES;
        for (int lane = 0; lane < LANES; ++lane) {
            at[lane] = arc_lengths[base + (lane < lanes ? lane : lanes - 1)];
            before = path_nodes_near(path, at[lane], before);
            const struct path_piece piece = path_piece(path, before);
            double numbers[9];
            memcpy(numbers, &piece, sizeof numbers);
            for (int i = 0; i < 9; ++i)
                in[i][lane] = numbers[i];
        }
        for (int lane = 0; lane < LANES; ++lane) {
            const struct path_piece piece = {{in[0][lane], in[1][lane], in[2][lane], in[3][lane]},
                                             {in[4][lane], in[5][lane], in[6][lane], in[7][lane]}, in[8][lane]};
            const struct path_cubic cubic = path_cubic_of(&piece);
            double sample[4];
            path_cubic_sample(&cubic, at[lane], sample);
            for (int i = 0; i < 4; ++i)
                out[i][lane] = sample[i];
        }
        for (int lane = 0; lane < lanes; ++lane) {
            for (int i = 0; i < 4; ++i)
                samples[base + lane][i] = out[i][lane];
            if (!offset_is_none(path->offset))
                offset_apply(path->offset, at[lane], samples[base + lane]);
        }
    }
}

/* The node next to the point (m) among those between two arc lengths, m, and the nearest one beyond either. */
static inline int32_t path_nearest_node(const struct path *path, double x, double y, double low, double high)
{
    const int32_t before = path_nodes_before(path, low, 0), after = path_nodes_before(path, high, 0);
    const int32_t first = before > 0 ? before - 1 : 0, last = after < path->count ? after : path->count - 1;
    double shortest = (double)INFINITY;
    int32_t nearest = first;

    for (int32_t i = first; i <= last; ++i) {
        const double east = path->nodes[i].x - x, north = path->nodes[i].y - y;
        const double squared = east * east + north * north;
        if (squared < shortest) {
            shortest = squared;
            nearest = i;
        }
    }
    return nearest;
}

/* The nearest node starts a Newton iteration on the distance along the tangent. */
double drawbar_path_project(const struct path *path, double x, double y, double low, double high, double *error)
{
    double arc_length = path->nodes[path_nearest_node(path, x, y, low, high)].arc_length;

    arc_length = fmin(fmax(arc_length, low), high);
    int32_t last = path_nodes_before(path, arc_length, 1);
    struct path_cubic cubic = drawbar_path_cubic(path, last);
    for (int iteration = 0; iteration < PATH_PROJECTIONS; ++iteration) {
        const int32_t piece = path_nodes_near(path, arc_length, last);
        if (piece != last)
            cubic = drawbar_path_cubic(path, piece);
        last = piece;
        const double d = arc_length - cubic.anchor, *c = cubic.x, *s = cubic.y;
        const double east = x - c[0] - d * (c[1] + d * (c[2] + d * c[3]));
        const double north = y - s[0] - d * (s[1] + d * (s[2] + d * s[3]));
        const double tangent_x = c[1] + d * (2.0 * c[2] + 3.0 * d * c[3]);
        const double tangent_y = s[1] + d * (2.0 * s[2] + 3.0 * d * s[3]);
        const double curvature
            = 2.0 * (tangent_x * (s[2] + 3.0 * d * s[3]) - tangent_y * (c[2] + 3.0 * d * c[3]));
        const double ahead = east * tangent_x + north * tangent_y;
        *error = north * tangent_x - east * tangent_y;
        /* 1 - curvature * lateral is the slope of the distance along; it vanishes at the centre of curvature, where the
         * bound keeps the step from running away */
        const double step = ahead / fmax(1.0 - curvature * *error, 0.2);
        const double moved = fmin(fmax(arc_length + step, low), high);
        const int converged = fabs(moved - arc_length) <= PATH_CONVERGED;
        arc_length = moved;
        if (converged)
            break;
    }
    if (!offset_is_none(path->offset))
        *error = offset_error(path->offset, arc_length, *error);
    return arc_length;
}

double drawbar_path_nearest(const struct path *path, double x, double y, double yaw, double reach, int both_ways,
                            int *against)
{
    double shortest[2] = {(double)INFINITY, (double)INFINITY};  /* of all nodes, of those that lead along the vehicle */
    int32_t first[2] = {0, 0};

    for (int32_t i = 0; i < path->count; ++i) {
        const double distance = hypot(path->nodes[i].x - x, path->nodes[i].y - y), along = cos(path->nodes[i].yaw - yaw);
        const int alike = distance <= reach && (along >= PATH_ALONG || (both_ways && along <= -PATH_ALONG));
        for (int kind = 0; kind <= alike; ++kind) {
            /* a pass ends where the path has led away by more than its pieces are long */
            const int same = path->nodes[i].arc_length - path->nodes[first[kind]].arc_length <= 2.0 * reach;
            if (distance < shortest[kind] - (same ? 0.0 : PATH_BESIDE)) {
                shortest[kind] = distance;
                first[kind] = i;
            }
        }
    }
    const double near = path->nodes[first[isfinite(shortest[1]) ? 1 : 0]].arc_length;
    double error, sample[4];
    const double arc_length
        = drawbar_path_project(path, x, y, fmax(near - 1.0, 0.0), fmin(near + 1.0, path_length(path)), &error);
    drawbar_path_sample(path, arc_length, sample);
    *against = cos(sample[AT_YAW] - yaw) < -PATH_ALONG;
    return arc_length;
}

#endif

/* A recorded line as a path's table: what smoothing.py and fairing.py make of a line that needs no linear program.
 *
 * The points that minimise sum |p - points|^2 + (0.7 m / step)^6 sum |third difference of p|^2, in equal steps, are the
 * control points of a uniform cubic B-spline; its knots are the path's nodes.
 */
#ifndef DRAWBAR_LINE_PATH_H
#define DRAWBAR_LINE_PATH_H

#include "drawbar_line.h"
#include "lanes.h"
#include "line_given.h"
#include "path.h"

#define LINE_PIECE 0.25                    /* longest step, m: PIECE_LENGTH of path.py */
#define LINE_SHORTEST 0.1                  /* lengths between which a line may be one, m: _SHORTEST of line.py, */
#define LINE_LONGEST 2e6                   /* _LONGEST */
#define LINE_FEWEST 8                      /* steps: _FEWEST_PIECES of smoothing.py, as those below */
#define LINE_DETAIL 0.7                    /* m, _DETAIL */
#define LINE_MARGIN 0.995                  /* of the curvature, _MARGIN */
#define LINE_RATE_MARGIN 1.1               /* _RATE_MARGIN */
#define LINE_SEARCH 2.0                    /* m around where a recorded point was */

typedef double wide;                       /* lengths and points of the whole line: a double in single precision, too, as
                                            * the smoothed points are found to a share of their distance from the origin */

enum { LINE_DIAGONAL, LINE_X = 4, LINE_Y = 5 };   /* of a row: the factor's band (0 to 3), the point */

static inline double line_distance(const struct drawbar_line_point *a, const struct drawbar_line_point *b)
{
    return hypot(b->x - a->x, b->y - a->y);
}

/* The length of the polyline (m), or 0 where it is none. */
static inline wide line_length(const struct drawbar_line_point *points, int32_t count)
{
    wide length = 0.0;

    for (int32_t i = 0; i < count; ++i) {
        if (!(fabs(points[i].x) <= LINE_FARTHEST && fabs(points[i].y) <= LINE_FARTHEST))
            return 0.0;
        if (i > 0 && !(line_distance(&points[i - 1], &points[i]) > 0.0))
            return 0.0;
        length += i > 0 ? line_distance(&points[i - 1], &points[i]) : 0.0;
    }
    return length;
}

/* Points in equal steps along the polyline. */
static inline void line_resample(const struct drawbar_line_point *points, int32_t count, wide step,
                                 struct drawbar_line_row *rows, int32_t n)
{
    wide before = 0.0, piece = line_distance(&points[0], &points[1]);
    int32_t at = 0;

    for (int32_t i = 0; i < n; ++i) {
        while (at + 2 < count && i * step > before + piece) {
            before += piece;
            ++at;
            piece = line_distance(&points[at], &points[at + 1]);
        }
        const wide share = fmin((i * step - before) / piece, 1.0);
        rows[i].memory[LINE_X] = points[at].x + share * (points[at + 1].x - points[at].x);
        rows[i].memory[LINE_Y] = points[at].y + share * (points[at + 1].y - points[at].y);
    }
}

/* An entry of the identity and stiffness D'D, D the third difference, `under` the diagonal. */
static inline wide line_entry(wide stiffness, int32_t row, int under, int32_t n)
{
    static const double third[4] = {-1.0, 3.0, -3.0, 1.0};
    wide sum = under == 0 ? 1.0 : 0.0;

    for (int k = under; k < 4; ++k)        /* the difference that begins at row - k */
        if (row - k >= 0 && row - k <= n - 4)
            sum += stiffness * third[k] * third[k - under];
    return sum;
}

/* Move the points to where the sum above is least: one band of L D L'. */
static inline void line_smooth(struct drawbar_line_row *rows, int32_t n, wide stiffness)
{
    for (int32_t i = 0; i < n; ++i) {
        wide *row = rows[i].memory;
        row[LINE_DIAGONAL] = line_entry(stiffness, i, 0, n);
        for (int k = i < 3 ? (int)i : 3; k > 0; --k) {
            const wide *other = rows[i - k].memory;
            row[k] = line_entry(stiffness, i, k, n);
            for (int m = k + 1; m <= 3 && i - m >= 0; ++m)
                row[k] -= row[m] * rows[i - m].memory[LINE_DIAGONAL] * other[m - k];
            row[k] /= other[LINE_DIAGONAL];
        }
        for (int k = 1; k <= 3 && i - k >= 0; ++k) {
            const wide *other = rows[i - k].memory;
            row[LINE_DIAGONAL] -= row[k] * row[k] * other[LINE_DIAGONAL];
            row[LINE_X] -= row[k] * other[LINE_X];
            row[LINE_Y] -= row[k] * other[LINE_Y];
        }
    }
    for (int32_t i = n - 1; i >= 0; --i) {
        wide *row = rows[i].memory;
        row[LINE_X] /= row[LINE_DIAGONAL];
        row[LINE_Y] /= row[LINE_DIAGONAL];
        for (int k = 1; k <= 3 && i + k < n; ++k) {
            row[LINE_X] -= rows[i + k].memory[k] * rows[i + k].memory[LINE_X];
            row[LINE_Y] -= rows[i + k].memory[k] * rows[i + k].memory[LINE_Y];
        }
    }
}

/* A coordinate of the control polygon, continued at both ends with the curvature that it has there. */
static inline wide line_polygon(const struct drawbar_line_row *rows, int32_t n, int32_t i, int axis)
{
    if (i < 0)
        return 3.0 * (rows[0].memory[axis] - rows[1].memory[axis]) + rows[2].memory[axis];
    if (i >= n)
        return 3.0 * (rows[n - 1].memory[axis] - rows[n - 2].memory[axis]) + rows[n - 3].memory[axis];
    return rows[i].memory[axis];
}

/* The polygon's curvature at an inner point, 1/m. */
static inline double line_curvature(const struct drawbar_line_row *rows, int32_t i)
{
    const wide *a = rows[i - 1].memory, *b = rows[i].memory, *c = rows[i + 1].memory;
    const double ax = b[LINE_X] - a[LINE_X], ay = b[LINE_Y] - a[LINE_Y];
    const double bx = c[LINE_X] - b[LINE_X], by = c[LINE_Y] - b[LINE_Y];

    return 2.0 * atan2(ax * by - ay * bx, ax * bx + ay * by) / (hypot(ax, ay) + hypot(bx, by));
}

/* The first point whose curvature, or its change, is out of the limits; -1: none. */
static inline int32_t line_tight(const struct drawbar_line_row *rows, int32_t n, wide step,
                                 const struct drawbar_line_limits *limits)
{
    double last = line_curvature(rows, 1);

    for (int32_t i = 1; i < n - 1; ++i) {
        const double now = line_curvature(rows, i);
        if (!(fabs(now) <= LINE_MARGIN * limits->curvature) || !(fabs(now - last) <= limits->curvature_rate * step))
            return i;
        last = now;
    }
    return -1;
}

/* A coordinate of a knot of the spline. */
static inline wide line_knot(const struct drawbar_line_row *rows, int32_t n, int32_t i, int axis)
{
    return (line_polygon(rows, n, i - 1, axis) + 4.0 * rows[i].memory[axis] + line_polygon(rows, n, i + 1, axis)) / 6.0;
}

/* The nodes at the spline's knots. */
static inline void line_nodes(const struct drawbar_line_row *rows, int32_t n, struct drawbar_path_node *nodes)
{
    wide along = 0.0;

    for (int32_t i = 0; i < n; ++i) {
        const wide xa = line_polygon(rows, n, i - 1, LINE_X), xb = line_polygon(rows, n, i + 1, LINE_X);
        const wide ya = line_polygon(rows, n, i - 1, LINE_Y), yb = line_polygon(rows, n, i + 1, LINE_Y);
        const wide yaw = atan2(yb - ya, xb - xa);
        const struct drawbar_path_node *last = &nodes[i - (i > 0)];

        nodes[i].x = line_knot(rows, n, i, LINE_X);
        nodes[i].y = line_knot(rows, n, i, LINE_Y);
        if (i == 0) {
            nodes[i].arc_length = 0.0;
            nodes[i].yaw = yaw;
            continue;
        }
        const double turn = atan2(lane_sin(yaw - last->yaw), lane_cos(yaw - last->yaw)), half = 0.5 * turn;
        const double chord = hypot(line_knot(rows, n, i, LINE_X) - line_knot(rows, n, i - 1, LINE_X),
                                   line_knot(rows, n, i, LINE_Y) - line_knot(rows, n, i - 1, LINE_Y));
        along += chord * (fabs(half) > 1e-9 ? half / sin(half) : 1.0);
        nodes[i].yaw = last->yaw + turn;
        nodes[i].arc_length = along;
    }
}

/* The first node from which the path itself is out of the limits; -1: none. Each piece is looked at as if it began at the
 * origin: elsewhere a float has too few digits for its curvature. */
static inline int32_t line_undrivable(const struct drawbar_line_row *rows, const struct path *path,
                                      const struct drawbar_line_limits *limits)
{
    struct drawbar_path_node ends[2] = {{0.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0}};
    const struct path piece = {ends, 2, NULL};
    double last[4] = {0.0}, at[4], middle[4];

    for (int32_t i = 0; i + 1 < path->count; ++i) {
        const double length = path->nodes[i + 1].arc_length - path->nodes[i].arc_length;
        ends[0].yaw = path->nodes[i].yaw;
        ends[1].arc_length = length;
        ends[1].x = line_knot(rows, path->count, i + 1, LINE_X) - line_knot(rows, path->count, i, LINE_X);
        ends[1].y = line_knot(rows, path->count, i + 1, LINE_Y) - line_knot(rows, path->count, i, LINE_Y);
        ends[1].yaw = path->nodes[i + 1].yaw;
        drawbar_path_sample(&piece, 0.0, at);
        drawbar_path_sample(&piece, 0.5 * length, middle);
        const double rate = i > 0 ? fabs(at[AT_CURVATURE] - last[AT_CURVATURE]) / length : 0.0;
        if (!(fmax(fabs(at[AT_CURVATURE]), fabs(middle[AT_CURVATURE])) <= limits->curvature)
            || !(rate <= LINE_RATE_MARGIN * limits->curvature_rate))
            return i;
        last[AT_CURVATURE] = at[AT_CURVATURE];
    }
    return -1;
}

/* The recorded point that is furthest from the path, where that is further than the tolerance; -1: none. */
static inline int32_t line_far(const struct path *path, const struct drawbar_line_point *points, int32_t count,
                               wide step, double tolerance)
{
    double furthest = tolerance;
    wide along = 0.0;
    int32_t far = -1;

    for (int32_t i = 0; i < count; ++i) {
        double error = 0.0;
        along += i > 0 ? line_distance(&points[i - 1], &points[i]) : 0.0;
        const double node = fmin(floor(along / step + 0.5), path->count - 1.0);
        const double guess = path->nodes[(int32_t)node].arc_length;
        drawbar_path_project(path, points[i].x, points[i].y, guess - LINE_SEARCH, guess + LINE_SEARCH, &error);
        if (!(fabs(error) <= furthest)) {
            furthest = fabs(error);
            far = i;
        }
    }
    return far;
}

int drawbar_line_path(const struct drawbar_line_point *points, int32_t count,
                      const struct drawbar_line_limits *limits, struct drawbar_path_node *nodes,
                      struct drawbar_line_row *work, int32_t capacity, int32_t *made)
{
    const struct line_given given[] = {LINE_NUMBERS(points), LINE_NUMBERS(limits), LINE_NUMBERS(nodes), LINE_ROWS(work),
                                       LINE_COUNT(made)};
    const int refused = line_refused(given, 5);
    if (refused)
        return refused;
    *made = 0;
    const wide length = line_length(points, count);
    if (count < 2 || !(length >= LINE_SHORTEST && length <= LINE_LONGEST) || !(limits->curvature > 0.0)
        || !(limits->curvature_rate > 0.0) || !(limits->tolerance > 0.0))
        return DRAWBAR_LINE_POINTS;
    const int32_t steps = (int32_t)fmax(ceil(length / LINE_PIECE), LINE_FEWEST), n = steps + 1;
    *made = n;
    if (capacity < n)
        return DRAWBAR_LINE_MEMORY;
    const wide step = length / steps, ratio = fmin(LINE_DETAIL / step, n);
    line_resample(points, count, step, work, n);
    line_smooth(work, n, ratio * ratio * ratio * ratio * ratio * ratio);
    const int32_t tight = line_tight(work, n, step, limits);
    if (tight >= 0) {
        *made = tight;
        return DRAWBAR_LINE_TIGHT;
    }
    line_nodes(work, n, nodes);
    const struct path path = {nodes, n, NULL};
    const int32_t broken = drawbar_path_check(&path), undrivable = line_undrivable(work, &path, limits);
    if (broken >= 0 || undrivable >= 0) {
        *made = broken >= 0 ? broken : undrivable;
        return DRAWBAR_LINE_TIGHT;
    }
    const int32_t far = line_far(&path, points, count, step, limits->tolerance);
    *made = far >= 0 ? far : n;
    return far >= 0 ? DRAWBAR_LINE_FAR : DRAWBAR_LINE_MADE;
}

#endif

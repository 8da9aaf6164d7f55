/* The path to follow: poses joined by cubic Hermite pieces, continued as straight lines beyond both ends.
 *
 * The table of poses is the caller's own memory; the cubic of a piece is made from its two ends where it is needed. On
 * pieces this short a Hermite cubic with unit tangents has unit speed and follows an arc of radius 6.67 m to 1e-7 m and
 * 1e-6 rad, one of 2.5 m to 1e-6 m and 1e-5 rad.
 *
 * Where the path has an offset (line_offset.h), samples and lateral errors are those of the line beside it; arc lengths
 * stay those of the table.
 */
#ifndef DRAWBAR_PATH_H
#define DRAWBAR_PATH_H

#include <math.h>
#include <stddef.h>
#include "drawbar_signals.h"
#include "geometry.h"
#include "line_offset.h"

#define PATH_LONGEST 0.275                 /* longest piece, m: 0.25 m and an arc's excess over its chord */

struct path {
    const struct drawbar_path_node *nodes;
    int32_t count;
    const struct line_offset *offset;      /* of the line that is followed; NULL: the path itself */
};

/* A piece as a polynomial in the distance from its first node, constant first: m, 1, 1/m, 1/m^2. */
struct path_cubic {
    double anchor, yaw;                    /* arc length (m) and yaw (rad) of the first node */
    double x[4], y[4];
};

static inline double path_length(const struct path *path)
{
    return path->nodes[path->count - 1].arc_length;
}

/* The functions of path_evaluation.h and path_check.h, once in a library. */

/* A piece in front of a node; the first and the last one, 0 and count, are the straight continuations. */
struct path_cubic drawbar_path_cubic(const struct path *path, int32_t piece);

/* x, y (m), continuous yaw (rad) and curvature (1/m) of the path at an arc length, m. */
void drawbar_path_sample(const struct path *path, double arc_length, double sample[4]);

/* The same at count arc lengths in SIMD lanes; those that follow each other are best near each other. */
void drawbar_path_samples(const struct path *path, const double *arc_lengths, int64_t count, double (*samples)[4]);

/* The arc length (m) between low and high of the point of the path closest to (x, y), and the lateral error (m),
 * positive where (x, y) is left of the path. */
double drawbar_path_project(const struct path *path, double x, double y, double low, double high, double *error);

/* Where a vehicle stands that faces along `yaw` (rad; NaN: it is not known): the arc length (m) of the path's nearest place.
 *
 * Within `reach` (m) a place that leads where the vehicle faces, or against that where it may be driven both ways, goes
 * before a nearer one that leads across; of several passes that are alike the first is taken. *against: whether the
 * path leads the other way there, by more than 120 degrees. */
double drawbar_path_nearest(const struct path *path, double x, double y, double yaw, double reach, int both_ways,
                            int *against);

/* The first node that is wrong, or -1 where the path can be followed. */
int32_t drawbar_path_check(const struct path *path);

/* The arc length (m) at which the line that is followed has gone on by a distance (m) from another. */
static inline double path_ahead(const struct path *path, double arc_length, double distance)
{
    const struct path itself = {path->nodes, path->count, NULL};
    double at[3], sample[4];

    if (offset_is_none(path->offset))
        return arc_length + distance;
    drawbar_path_sample(&itself, arc_length, sample);
    offset_at(path->offset, arc_length, at);
    return arc_length + distance / offset_stretch(at, sample[AT_CURVATURE]);
}

/* Whether there is a line so far to the left of the path (m) that is nowhere tighter than a curvature (1/m), or than the
 * path itself; each piece by its mean curvature. */
static inline int path_has_beside(const struct path *path, double offset, double tightest)
{
    for (int32_t i = 1; i < path->count && offset != 0.0; ++i) {
        const struct drawbar_path_node *a = &path->nodes[i - 1], *b = &path->nodes[i];
        const double bend = (b->yaw - a->yaw) / (b->arc_length - a->arc_length), stretch = 1.0 - offset * bend;
        if (!(stretch > OFFSET_LEAST_STRETCH && fabs(bend) <= fmax(tightest, fabs(bend)) * stretch))
            return 0;
    }
    return 1;
}

#endif

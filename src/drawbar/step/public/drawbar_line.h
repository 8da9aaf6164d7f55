/* A recorded line as a path for drawbar_set_path, made on the vehicle's own computer.
 *
 * For a line that the vehicle can follow once details below 0.7 m are smoothed away: then the path is the one of
 * `drawbar path`. A line with kinks is refused (DRAWBAR_LINE_TIGHT); rounding them takes optimisation: `drawbar path`.
 *
 * No function of this header needs a state, allocates memory, or touches anything but its arguments.
 */
#ifndef DRAWBAR_LINE_H
#define DRAWBAR_LINE_H

#include <stdint.h>
#include "drawbar_api.h"
#include "drawbar_signals.h"

#ifdef __cplusplus
extern "C" {
#endif

enum drawbar_line_status {
    DRAWBAR_LINE_MADE = 0,
    DRAWBAR_LINE_NULL = 1,                 /* a pointer is NULL */
    DRAWBAR_LINE_POINTS = 2,               /* fewer than two points, or one that is not finite, beyond 1e7 m, or where
                                            * the one before is; a line shorter than 0.1 m or longer than 2000 km (in
                                            * single precision: beyond 10 km, longer than 10 km); or a limit that is
                                            * not positive */
    DRAWBAR_LINE_MEMORY = 3,               /* more nodes are needed than there is room for: `made`: how many */
    DRAWBAR_LINE_TIGHT = 4,                /* bends, or changes its curvature, faster than the vehicle can, or goes
                                            * back and forth: `made` is the first such node */
    DRAWBAR_LINE_FAR = 5,                  /* a recorded point is further from the path than the tolerance: `made` is
                                            * the furthest */
    DRAWBAR_LINE_UNALIGNED = 6             /* a pointer is not aligned as what it leads to: some processors stop there */
};

struct drawbar_line_point {
    double x, y;                           /* east and north, m */
};

struct drawbar_line_limits {
    double curvature;                      /* vehicle.curvature_limit of the configuration, 1/m */
    double curvature_rate;                 /* guidance.curvature_rate_limit, 1/m^2 */
    double tolerance;                      /* guidance.path_tolerance, m */
};

/* One row of what drawbar_line_path works in, doubles in single precision, too; its content means nothing. */
struct drawbar_line_row {
    double memory[6];
};

/* Make the path along a recorded line. Returns enum drawbar_line_status.
 *
 * points: count of them, in the order of driving.
 * nodes, work: room for `capacity` of each; a line of L m needs ceil(4 L) + 1, and at least 9.
 * made: how many nodes there are; otherwise as described at each status. */
DRAWBAR_API int drawbar_line_path(const struct drawbar_line_point *points, int32_t count,
                                  const struct drawbar_line_limits *limits, struct drawbar_path_node *nodes,
                                  struct drawbar_line_row *work, int32_t capacity, int32_t *made);

/* Find where on a path a vehicle stands: what drawbar_begin_at wants.
 *
 * nodes: count of them, as for drawbar_set_path.
 * x, y, yaw: of the vehicle, m and rad; a yaw of NaN is not known.
 * reach: within it (m) a place that leads where the vehicle faces goes before a nearer one that leads across. Of several
 *     passes that are alike the first is taken.
 * both_ways: not 0: a place that leads against the vehicle is as good.
 * arc_length: of the place, m.
 * against: 1 where the path leads the other way there, by more than 120 degrees: drive what drawbar_line_reverse makes.
 *
 * Returns DRAWBAR_LINE_MADE, DRAWBAR_LINE_NULL, DRAWBAR_LINE_UNALIGNED, or DRAWBAR_LINE_POINTS: no path, a place that is
 * not finite, or a reach that is not positive. */
DRAWBAR_API int drawbar_line_nearest(const struct drawbar_path_node *nodes, int32_t count, double x, double y, double yaw,
                                     double reach, int32_t both_ways, double *arc_length, int32_t *against);

/* Turn a path round, from its end to its start; a place at an arc length s of it is then at its length less s.
 *
 * nodes: count of them, as for drawbar_set_path.
 * reversed: room for as many, apart from `nodes`.
 *
 * Returns DRAWBAR_LINE_MADE, DRAWBAR_LINE_NULL, DRAWBAR_LINE_UNALIGNED, or DRAWBAR_LINE_POINTS: no path. */
DRAWBAR_API int drawbar_line_reverse(const struct drawbar_path_node *nodes, int32_t count,
                                     struct drawbar_path_node *reversed);

#ifdef __cplusplus
}
#endif

#endif

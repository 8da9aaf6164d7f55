/* Path check of a table of poses: the assumptions of path.h. */
#ifndef DRAWBAR_PATH_CHECK_H
#define DRAWBAR_PATH_CHECK_H

#include "path.h"

#define PATH_FARTHEST 1e7                  /* largest number in a table, m or rad: a larger one leaves too few digits */
#define PATH_SHORTEST 0.999e-3             /* shortest piece, m, 1 mm but for rounding: bounds how many a search meets */
#define PATH_TIGHTEST 2.0                  /* largest yaw change per length, 1/m: more is a kink */
#define PATH_GAP 0.01                      /* largest distance of a node from where its piece ends, per length */

static inline int path_is_node(const struct drawbar_path_node *node)
{
    return fabs(node->arc_length) <= PATH_FARTHEST && fabs(node->x) <= PATH_FARTHEST && fabs(node->y) <= PATH_FARTHEST
        && fabs(node->yaw) <= PATH_FARTHEST;
}

/* Whether two nodes are the ends of a piece: arc length, yaws and chord agree with an arc's. */
static inline int path_is_piece(const struct drawbar_path_node *a, const struct drawbar_path_node *b)
{
    const double length = b->arc_length - a->arc_length, turn = b->yaw - a->yaw, middle = a->yaw + 0.5 * turn;
    const double chord = length * (fabs(turn) > 1e-6 ? sin(0.5 * turn) / (0.5 * turn) : 1.0);
    const double gap = hypot(b->x - a->x - chord * cos(middle), b->y - a->y - chord * sin(middle));

    return length >= PATH_SHORTEST && length <= PATH_LONGEST && fabs(turn) <= PATH_TIGHTEST * length
        && gap <= PATH_GAP * length;
}

int32_t drawbar_path_check(const struct path *path)
{
    if (path->nodes == NULL || path->count < 2 || !path_is_node(path->nodes) || path->nodes[0].arc_length != 0.0)
        return 0;
    for (int32_t i = 1; i < path->count; ++i)
        if (!path_is_node(&path->nodes[i]) || !path_is_piece(&path->nodes[i - 1], &path->nodes[i]))
            return i;
    return -1;
}

#endif

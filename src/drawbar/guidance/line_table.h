/* A path's table that is there: where on it a vehicle stands, and the table turned round. */
#ifndef DRAWBAR_LINE_TABLE_H
#define DRAWBAR_LINE_TABLE_H

#include "drawbar_line.h"
#include "line_given.h"
#include "path.h"

int drawbar_line_nearest(const struct drawbar_path_node *nodes, int32_t count, double x, double y, double yaw, double reach,
                         int32_t both_ways, double *arc_length, int32_t *against)
{
    const struct path path = {nodes, count, NULL};
    const struct line_given given[] = {LINE_NUMBERS(nodes), LINE_NUMBERS(arc_length), LINE_COUNT(against)};
    const int refused = line_refused(given, 3);
    int away;

    if (refused)
        return refused;
    if (drawbar_path_check(&path) >= 0 || !(fabs(x) <= LINE_FARTHEST && fabs(y) <= LINE_FARTHEST) || isinf(yaw) || !(reach > 0.0))
        return DRAWBAR_LINE_POINTS;
    *arc_length = drawbar_path_nearest(&path, x, y, yaw, reach, both_ways != 0, &away);
    *against = away;
    return DRAWBAR_LINE_MADE;
}

int drawbar_line_reverse(const struct drawbar_path_node *nodes, int32_t count, struct drawbar_path_node *reversed)
{
    const struct path path = {nodes, count, NULL};
    const struct line_given given[] = {LINE_NUMBERS(nodes), LINE_NUMBERS(reversed)};
    const int refused = line_refused(given, 2);

    if (refused)
        return refused;
    if (drawbar_path_check(&path) >= 0)
        return DRAWBAR_LINE_POINTS;
    for (int32_t i = 0; i < count; ++i) {
        const struct drawbar_path_node *node = &nodes[count - 1 - i];
        reversed[i].arc_length = path_length(&path) - node->arc_length;
        reversed[i].x = node->x;
        reversed[i].y = node->y;
        reversed[i].yaw = node->yaw + DRAWBAR_PI;
    }
    return DRAWBAR_LINE_MADE;
}

#endif

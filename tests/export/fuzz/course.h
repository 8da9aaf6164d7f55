/* Paths from a fuzzer's bytes: mostly smooth ones, now and then with a node that is anything. */
#ifndef COURSE_H
#define COURSE_H

#include "bytes.h"
#include "drawbar.h"
#include "vehicle.h"

#define NODES 2048
#define PIECE 0.25                         /* m */
#define TIGHTEST 0.35                      /* 1/m: somewhat more than may be driven */

struct course {
    struct drawbar_path_node nodes[NODES];
    int32_t count;
};

/* Add a piece that turns by so much (rad). */
static void course_add(struct course *c, double turn)
{
    const struct drawbar_path_node *last = &c->nodes[c->count - 1];
    const double middle = last->yaw + 0.5 * turn;
    const double chord = fabs(turn) > 1e-9 ? PIECE * sin(0.5 * turn) / (0.5 * turn) : PIECE;

    c->nodes[c->count++] = (struct drawbar_path_node){
        last->arc_length + PIECE, last->x + chord * cos(middle), last->y + chord * sin(middle), last->yaw + turn};
}

/* Add up to 32 m whose curvature (1/m) goes linearly from that of the segment before to another. */
static double course_extend(struct course *c, double curvature, struct bytes *b)
{
    const int pieces = 1 + next_byte(b) / 2;
    const double end = TIGHTEST * next_fraction(b);

    for (int i = 0; i < pieces && c->count < NODES; ++i)
        course_add(c, PIECE * (curvature + (end - curvature) * (i + 0.5) / pieces));
    return end;
}

/* A path that comes from straight behind the vehicle and passes it `behind` pieces after its begin, up to `aside` metres
 * beside it and nearly in its direction. */
static void course_make(struct course *c, const struct vehicle *v, int behind, double aside, struct bytes *b)
{
    const int shape = next_byte(b);
    const double yaw = v->yaw + 0.5 * next_fraction(b), back = PIECE * behind;
    double curvature = 0.0;

    c->count = 1;
    c->nodes[0] = (struct drawbar_path_node){0.0, v->x + aside * next_fraction(b) - back * cos(yaw),
                                             v->y + aside * next_fraction(b) - back * sin(yaw), yaw};
    for (int i = 0; i < behind; ++i)
        course_add(c, 0.0);
    for (int i = 0; i <= shape % 8; ++i)
        curvature = course_extend(c, curvature, b);
    if (shape >= 224) {
        double *numbers = &c->nodes[next_choice(b, c->count)].arc_length;
        numbers[next_choice(b, 4)] = next_double(b);
    }
}

#endif

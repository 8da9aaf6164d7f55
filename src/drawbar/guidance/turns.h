/* Continuous-curvature turns: the shortest turns for a steering of limited angle and limited rate.
 *
 * A turn's curvature rises at the rate limit, stays at the curvature limit if it gets there, and falls back to zero:
 * clothoid, arc, clothoid (Fraichard and Scheuer 2004). A turn is symmetric about its middle, so it displaces the
 * vehicle along the mean of its first and last heading.
 */
#ifndef DRAWBAR_TURNS_H
#define DRAWBAR_TURNS_H

#include "noinline.h"
#include "geometry.h"
#include "lanes.h"
#include "path.h"

#define TURNS 3                            /* in a track onto a line, at most */
#define TURNS_PIECE 0.25                   /* longest distance of a traced curve's nodes, m */
#define TURNS_POINT 1e-6                   /* a piece of a curve up to this long is a point, m */
#define TURNS_NODES 12                     /* of Gauss and Legendre's quadrature */

/* How tight and how abrupt turns may be. */
struct turn_limits {
    double curvature;                      /* 1/m */
    double rate;                           /* change of curvature per metre, 1/m^2 */
};

/* The largest curvature of a turn by an angle (rad), without sign, 1/m. */
static inline double turn_peak(const struct turn_limits *limits, double angle)
{
    return fmin(limits->curvature, sqrt(limits->rate * fabs(angle)));
}

/* The length of a turn by an angle (rad), m. */
static inline double turn_length(const struct turn_limits *limits, double angle)
{
    const double peak = turn_peak(limits, angle);
    const double arc = fmax(fabs(angle) - peak * peak / limits->rate, 0.0) / limits->curvature;
    return 2.0 * peak / limits->rate + arc;
}

/* The mean of cos(0.5 * (rate * s^2 - angle)), the direction along a clothoid against the turn's chord, for s from 0 to
 * ramp (m). */
static inline double clothoid_direction(double rate, double ramp, double angle)
{
    static const double nodes[TURNS_NODES / 2] = {0.1252334085114689, 0.3678314989981802, 0.5873179542866175,
                                                  0.7699026741943047, 0.9041172563704748, 0.9815606342467192};
    static const double weights[TURNS_NODES / 2] = {0.2491470458134027, 0.2334925365383546, 0.20316742672306573,
                                                    0.16007832854334642, 0.10693932599531907, 0.04717533638651141};
    double directions[TURNS_NODES], sum = 0.0;

    EACH_LANE (int i = 0; i < TURNS_NODES / 2; ++i) {
        const double before = 0.5 * (1.0 - nodes[i]) * ramp, after = 0.5 * (1.0 + nodes[i]) * ramp;
        directions[2 * i] = lane_cos(0.5 * (rate * before * before - angle));
        directions[2 * i + 1] = lane_cos(0.5 * (rate * after * after - angle));
    }
    for (int i = 0; i < TURNS_NODES / 2; ++i)
        sum += weights[i] * (directions[2 * i] + directions[2 * i + 1]);
    return 0.5 * sum;
}

/* The circle of a turn to the left that reaches the curvature limit: all of them, begun alike, share it. */
struct turn_circle {
    double least;                          /* turns by less do not reach the limit, rad */
    double ahead, left;                    /* its centre, seen from where the turn begins, m */
};

static inline struct turn_circle turn_circle(const struct turn_limits *limits)
{
    const double ramp = limits->curvature / limits->rate, turned = 0.5 * limits->curvature * ramp;
    const double ahead = ramp * clothoid_direction(limits->rate, ramp, 0.0);
    const double left = ramp * clothoid_direction(limits->rate, ramp, DRAWBAR_PI);
    const struct turn_circle circle
        = {2.0 * turned, ahead - sin(turned) / limits->curvature, left + cos(turned) / limits->curvature};
    return circle;
}

/* The distance between the ends of a turn by an angle (rad), m; negative: backwards. */
static NOINLINE double turn_chord(const struct turn_limits *limits, const struct turn_circle *circle, double angle)
{
    const double size = fabs(angle), ramp = sqrt(size / limits->rate);

    if (size < circle->least)
        return 2.0 * ramp * clothoid_direction(limits->rate, ramp, size);
    return 2.0 * (circle->left * lane_sin(0.5 * size) + circle->ahead * lane_cos(0.5 * size));
}

/* A curve by the arc lengths (m) and curvatures (1/m) between which its curvature is linear. */
struct curve {
    double knots[3 * TURNS + 2], bends[3 * TURNS + 2];
    int segments;
};

static inline void curve_go(struct curve *curve, double length, double bend)
{
    const int last = curve->segments++;
    curve->knots[last + 1] = curve->knots[last] + length;
    curve->bends[last + 1] = bend;
}

/* The curve of turns by these angles (rad) one after the other, which first brings the curvature (1/m) that the wheels
 * have to zero. */
static inline struct curve curve_of_turns(const struct turn_limits *limits, const double *angles, int turns,
                                          double curvature)
{
    struct curve curve = {.knots = {0.0}, .bends = {curvature}, .segments = 0};

    curve_go(&curve, fabs(curvature) / limits->rate, 0.0);
    for (int i = 0; i < turns; ++i) {
        const double peak = turn_peak(limits, angles[i]), ramp = peak / limits->rate;
        curve_go(&curve, ramp, copysign(peak, angles[i]));
        curve_go(&curve, turn_length(limits, angles[i]) - 2.0 * ramp, copysign(peak, angles[i]));
        curve_go(&curve, ramp, 0.0);
    }
    return curve;
}

/* Lay down the nodes of a curve from where the first one is; only arc lengths are filled in, and curvatures in the
 * place of yaws. Returns how many there are, 0 where they are more than the capacity. */
static inline int32_t curve_nodes(const struct curve *curve, struct drawbar_path_node *nodes, int32_t capacity)
{
    int32_t count = 0;

    for (int i = 0; i < curve->segments; ++i) {
        const double start = curve->knots[i], length = curve->knots[i + 1] - start;
        const double pieces = length > TURNS_POINT ? ceil((length - TURNS_POINT) / TURNS_PIECE) : 0.0;
        if (!(pieces < capacity - count))
            return 0;
        for (int32_t k = 0; k < (int32_t)pieces; ++k, ++count) {
            const double share = (double)k / pieces;
            nodes[count].arc_length = start + share * length;
            nodes[count].yaw = curve->bends[i] + share * (curve->bends[i + 1] - curve->bends[i]);
        }
    }
    nodes[count].arc_length = curve->knots[curve->segments];
    nodes[count].yaw = curve->bends[curve->segments];
    return count + 1;
}

/* Trace a curve from a point (m) in a heading (rad): its nodes with their continuous headings. Returns how many there
 * are, 0 where they are more than the capacity. */
static inline int32_t curve_trace(const struct curve *curve, double x, double y, double heading,
                                  struct drawbar_path_node *nodes, int32_t capacity)
{
    const int32_t count = curve_nodes(curve, nodes, capacity);
    double cosine = lane_cos(heading), sine = lane_sin(heading);

    for (int32_t i = 0; i < count; ++i) {
        const double first = nodes[i].yaw;
        nodes[i].x = x;
        nodes[i].y = y;
        nodes[i].yaw = heading;
        if (i + 1 == count)
            break;
        const double step = nodes[i + 1].arc_length - nodes[i].arc_length, last = nodes[i + 1].yaw;
        const double middle = heading + 0.125 * (3.0 * first + last) * step;
        const double end = heading + 0.5 * (first + last) * step;
        const double next_cosine = lane_cos(end), next_sine = lane_sin(end);
        /* Simpson's rule for the mean direction */
        x += step * (cosine + 4.0 * lane_cos(middle) + next_cosine) / 6.0;
        y += step * (sine + 4.0 * lane_sin(middle) + next_sine) / 6.0;
        heading = end;
        cosine = next_cosine;
        sine = next_sine;
    }
    return count;
}

#endif

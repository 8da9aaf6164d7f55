/* Line offset: how far to the left of its path a line leads, and how it gets from one offset to the next.
 *
 * A shift by d over a length L follows d S(u), u = (s - start) / L from 0 to 1, S(u) = u^3 (10 - 15 u + 6 u^2): offset,
 * direction and curvature are continuous. On a straight its curvature is at most 10 / sqrt(3) d / L^2 and changes by at most
 * 60 d / L^3, from which L follows; on a curve that comes to the curve's own. One shift ends before the next begins.
 */
#ifndef DRAWBAR_LINE_OFFSET_H
#define DRAWBAR_LINE_OFFSET_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include "drawbar_signals.h"
#include "geometry.h"

#define OFFSET_LARGEST 100.0               /* m */
#define OFFSET_SHIFTS 4                    /* that the trailer has not left behind */
#define OFFSET_SHORTEST 0.5                /* length of a shift, m */
#define OFFSET_SAME 1e-6                   /* a difference that is rounding, m */
#define OFFSET_LEAST_STRETCH 0.1           /* of the line against its path, inside of a curve */
#define OFFSET_BEND 5.773502691896258      /* largest second derivative of S: 10 / sqrt(3) */
#define OFFSET_BEND_RATE 60.0              /* largest third one */

struct offset_shift {
    double start, length, change;          /* arc lengths of the path, and how far to the left, m */
};

struct line_offset {
    double passed;                         /* sum of the finished shifts, m */
    double wanted;                         /* m */
    struct offset_shift shifts[OFFSET_SHIFTS];
    int32_t count;                         /* of the shifts */
};

/* Whether the line is the path itself. */
static inline int offset_is_none(const struct line_offset *offset)
{
    return offset == NULL || (offset->count == 0 && offset->passed == 0.0);
}

/* The offset (m) at an arc length (m) of the path, its slope, and the slope's derivative (1/m). */
static inline void offset_at(const struct line_offset *offset, double arc_length, double *at)
{
    at[0] = offset->passed;
    at[1] = at[2] = 0.0;
    for (int32_t i = 0; i < offset->count; ++i) {
        const struct offset_shift *shift = &offset->shifts[i];
        const double u = clamped((arc_length - shift->start) / shift->length, 0.0, 1.0), v = 1.0 - u;
        const double slope = shift->change / shift->length;

        at[0] += shift->change * (u * u * u * (10.0 + u * (-15.0 + 6.0 * u)));
        at[1] += slope * (30.0 * u * u * v * v);
        at[2] += slope / shift->length * (60.0 * u * v * (v - u));
    }
}

/* How much faster the line continues than its path, whose curvature (1/m) is given; `at` as of offset_at. */
static inline double offset_stretch(const double *at, double curvature)
{
    return hypot(1.0 - curvature * at[0], at[1]);
}

/* Shift a sample of the path to the line beside it. What the change of the path's curvature adds to the line's while it
 * shifts is left out: a product of the offset, its slope and that change. */
static inline void offset_apply(const struct line_offset *offset, double arc_length, double *sample)
{
    double at[3];

    offset_at(offset, arc_length, at);
    const double curvature = sample[AT_CURVATURE], along = 1.0 - curvature * at[0];
    const double stretch = offset_stretch(at, curvature);
    sample[AT_X] -= at[0] * sin(sample[AT_YAW]);
    sample[AT_Y] += at[0] * cos(sample[AT_YAW]);
    sample[AT_YAW] += atan2(at[1], along);
    sample[AT_CURVATURE]
        = (along * (curvature * along + at[2]) + 2.0 * curvature * at[1] * at[1]) / (stretch * stretch * stretch);
}

/* The distance from the line (m, left positive) of a point that is an error (m) beside the path at an arc length (m). */
static inline double offset_error(const struct line_offset *offset, double arc_length, double error)
{
    double at[3];

    offset_at(offset, arc_length, at);
    return (error - at[0]) / sqrt(1.0 + at[1] * at[1]);
}

/* The length (m) of a shift (m) that curves (1/m), and changes its curvature (1/m^2), so much at most. */
static inline double offset_length(double change, double curvature, double rate)
{
    const double far = fabs(change), cube = OFFSET_BEND_RATE * far / rate;

    return fmax(fmax(sqrt(OFFSET_BEND * far / curvature), exp(log(cube) / 3.0)), OFFSET_SHORTEST);
}

/* Lead along the wanted offset at once. */
static inline void offset_begin(struct line_offset *offset)
{
    offset->passed = offset->wanted;
    offset->count = 0;
}

/* Forget the shifts that the hindmost body has left behind. */
static inline void offset_forget(struct line_offset *offset, double hindmost)
{
    while (offset->count > 0 && hindmost > offset->shifts[0].start + offset->shifts[0].length) {
        offset->passed += offset->shifts[0].change;
        --offset->count;
        for (int32_t i = 0; i < offset->count; ++i)
            offset->shifts[i] = offset->shifts[i + 1];
    }
}

/* Begin a shift to the wanted offset beside the foremost body where it has the last one behind it. A shift curves (1/m),
 * and changes its curvature (1/m^2), so much at most; arc lengths of both bodies in m. */
static inline void offset_advance(struct line_offset *offset, double curvature, double rate, double foremost,
                                  double hindmost)
{
    double last = -(double)INFINITY, change = offset->wanted;

    offset_forget(offset, hindmost);
    change -= offset->passed;
    for (int32_t i = 0; i < offset->count; ++i) {
        change -= offset->shifts[i].change;
        last = offset->shifts[i].start + offset->shifts[i].length;
    }
    if (offset->count == 0 && fabs(change) <= OFFSET_SAME) {
        offset->passed = offset->wanted;
    } else if (fabs(change) > OFFSET_SAME && foremost >= last && offset->count < OFFSET_SHIFTS) {
        const struct offset_shift next = {foremost, offset_length(change, curvature, rate), change};
        offset->shifts[offset->count++] = next;
    }
}

#endif

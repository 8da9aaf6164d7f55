/* Ways onto a straight line for a vehicle beside it: three continuous-curvature turns (turns.h), the shortest first.
 *
 * The first turn is tried with multiples of 7.5 degrees. The last one is found by a root search between two of these,
 * and the turn between follows, as it must leave the vehicle in the line's direction. Of a way whose turn has not come
 * only the bracket is known, and the least length that it can have.
 */
#ifndef DRAWBAR_ONTO_LINE_H
#define DRAWBAR_ONTO_LINE_H

#include "geometry.h"
#include "turns.h"

#define LINE_STEP (DRAWBAR_PI / 24.0)      /* between the angles that the first and the last turn are tried with, rad */
#define LINE_STEPS 16                      /* of them to either side */
#define LINE_WAYS 128                      /* most ways that are looked at; 109 have been seen */
#define LINE_ITERATIONS 40                 /* of the root search; some 8 are usual */
#define LINE_REACHED 1e-13                 /* m; nearer is on the line, for every compiler's rounding */
#define LINE_SAME 1e-9                     /* m; ways that differ less are equally long */
#define LINE_SLACK 1e-3                    /* m; how far turns may end outside the room before their way is looked at */

/* Three turns onto a line, by the first and the last one, and how often they turn all round. */
struct way {
    double first, last;                    /* rad; unless found, the last turn is up to LINE_STEP more */
    double length;                         /* m; unless found, at least */
    int16_t rounds, found;
};

/* Where a vehicle stands beside a line, and what the turns that are tried do. */
struct onto_line {
    struct turn_limits limits;
    struct turn_circle circle;
    double offset;                         /* from the line, left positive, m */
    double heading;                        /* against the line, rad */
    double room;                           /* beside the line, m */
    double asides[2 * LINE_STEPS + 1];     /* how far a last turn leads aside, by its angle, m */
    double middles[3][4 * LINE_STEPS + 1]; /* chord of the turn between, by rounds and the other two turns' sum, m */
    double sideways[4 * LINE_STEPS + 1];   /* sine of its direction, by the first turn less the last */
    struct way ways[LINE_WAYS];            /* still to be tried */
    int32_t count;
    int32_t found;                         /* so far */
};

/* The angles (rad) of the three turns. */
static inline void way_angles(const struct onto_line *line, const struct way *way, double angles[TURNS])
{
    angles[0] = way->first;
    angles[1] = 2.0 * DRAWBAR_PI * way->rounds - line->heading - way->first - way->last;
    angles[2] = way->last;
}

/* How far aside a turn by an angle (rad) leads that begins or ends in the line's direction, m. */
static inline double line_aside(const struct onto_line *line, double angle)
{
    return turn_chord(&line->limits, &line->circle, angle) * lane_sin(0.5 * angle);
}

/* How far left of the line the first turn (rad) ends, m. */
static inline double line_after(const struct onto_line *line, double first)
{
    return line->offset + turn_chord(&line->limits, &line->circle, first) * lane_sin(line->heading + 0.5 * first);
}

/* The sine of the middle turn's direction, without whole rounds; `turned` is the first turn less the last, rad. */
static inline double line_sideways(const struct onto_line *line, double turned)
{
    return lane_sin(0.5 * (line->heading + turned));
}

/* How far left of the line all turns end, m: `after` the first, by the chord of the middle one in its direction, and
 * how far the last one leads aside. */
static inline double line_left(const struct way *way, double after, double middle, double sideways, double aside)
{
    return after + middle * (way->rounds % 2 ? -sideways : sideways) - aside;
}

/* On which side of the line that is: 1 left, -1 right, 0 on it. */
static inline int line_side(double left)
{
    return (left > LINE_REACHED) - (left < -LINE_REACHED);
}

static inline double way_left(const struct onto_line *line, const struct way *way, double after)
{
    double angles[TURNS];

    way_angles(line, way, angles);
    const double middle = turn_chord(&line->limits, &line->circle, angles[1]);
    return line_left(way, after, middle, line_sideways(line, way->first - way->last), line_aside(line, way->last));
}

/* The least that can be of an angle's size, rad, which is between two others. */
static inline double smallest_between(double a, double b)
{
    return a * b < 0.0 ? 0.0 : fmin(fabs(a), fabs(b));
}

/* The length of the way, m; unless it is found, a lower bound. */
static inline double way_length(const struct onto_line *line, const struct way *way)
{
    const double bracket = way->found ? 0.0 : LINE_STEP;
    double angles[TURNS];

    way_angles(line, way, angles);
    return turn_length(&line->limits, angles[0])
        + turn_length(&line->limits, smallest_between(angles[1], angles[1] - bracket))
        + turn_length(&line->limits, smallest_between(angles[2], angles[2] + bracket));
}

/* Find the last turn that ends on the line, by the Illinois method (Dowell and Jarratt 1971). */
static inline void way_find(const struct onto_line *line, struct way *way)
{
    const double after = line_after(line, way->first);
    double low = way->last, high = low + LINE_STEP, left_low = way_left(line, way, after), left_high, left = left_low;
    int side = 0;

    if (fabs(left) > LINE_REACHED)
        way->last = high;
    left_high = left = way_left(line, way, after);
    for (int i = 0; i < LINE_ITERATIONS && fabs(left) > LINE_REACHED; ++i) {
        way->last = clamped((low * left_high - high * left_low) / (left_high - left_low), low, high);
        left = way_left(line, way, after);
        if ((left > 0.0) == (left_low > 0.0)) {
            low = way->last;
            left_low = left;
            left_high *= side == -1 ? 0.5 : 1.0;
            side = -1;
        } else {
            high = way->last;
            left_high = left;
            left_low *= side == 1 ? 0.5 : 1.0;
            side = 1;
        }
    }
    way->found = 1;
    way->length = way_length(line, way);
}

/* Bracket the ways that begin with this turn, a number of steps, and these rounds. */
static inline void line_bracket(struct onto_line *line, int first, int rounds)
{
    struct way way = {.first = LINE_STEP * first, .rounds = (int16_t)rounds};
    const double after = line_after(line, way.first);
    int side = 0;

    for (int last = -LINE_STEPS; last <= LINE_STEPS && fabs(after) <= line->room + LINE_SLACK; ++last) {
        const double *asides = &line->asides[last + LINE_STEPS];
        const int before = side;
        way.last = LINE_STEP * last;
        const double middle = line->middles[rounds + 1][first + last + 2 * LINE_STEPS];
        side = line_side(line_left(&way, after, middle, line->sideways[first - last + 2 * LINE_STEPS], *asides));
        if (last == -LINE_STEPS || side == before || line->count == LINE_WAYS
            || smallest_between(asides[-1], *asides) > line->room + LINE_SLACK)
            continue;
        struct way *bracketed = &line->ways[line->count++];
        *bracketed = way;
        bracketed->last = LINE_STEP * (last - 1);
        bracketed->length = way_length(line, bracketed);
    }
}

/* Bracket all ways from an offset (m) and a heading (rad) onto the line, whose turns end within the room (m). */
static inline void line_ways(struct onto_line *line, const struct turn_limits *limits, double offset, double heading,
                             double room)
{
    line->limits = *limits;
    line->circle = turn_circle(limits);
    line->offset = offset;
    line->heading = heading;
    line->room = room;
    line->count = line->found = 0;
    for (int k = -LINE_STEPS; k <= LINE_STEPS; ++k)
        line->asides[k + LINE_STEPS] = line_aside(line, LINE_STEP * k);
    for (int k = -2 * LINE_STEPS; k <= 2 * LINE_STEPS; ++k)
        line->sideways[k + 2 * LINE_STEPS] = line_sideways(line, LINE_STEP * k);
    for (int rounds = -1; rounds <= 1; ++rounds)
        for (int k = -2 * LINE_STEPS; k <= 2 * LINE_STEPS; ++k)
            line->middles[rounds + 1][k + 2 * LINE_STEPS]
                = turn_chord(limits, &line->circle, 2.0 * DRAWBAR_PI * rounds - heading - LINE_STEP * k);
    for (int first = -LINE_STEPS; first <= LINE_STEPS; ++first)
        for (int rounds = -1; rounds <= 1; ++rounds)
            line_bracket(line, first, rounds);
}

/* Take the shortest way out, of those that are equally long the one bracketed first. Returns 0 where none is
 * left, or where the last turns of `most` have been looked for. */
static inline int line_take(struct onto_line *line, int32_t most, struct way *taken)
{
    while (line->count > 0) {
        int shortest = 0;
        for (int i = 1; i < line->count; ++i)
            if (line->ways[i].length < line->ways[shortest].length - LINE_SAME)
                shortest = i;
        *taken = line->ways[shortest];
        if (!taken->found) {
            if (line->found++ >= most)
                return 0;
            way_find(line, &line->ways[shortest]);
            continue;
        }
        --line->count;
        for (int i = shortest; i < line->count; ++i)
            line->ways[i] = line->ways[i + 1];
        if (fabs(line_aside(line, taken->last)) <= line->room + LINE_SLACK)
            return 1;
    }
    return 0;
}

#endif

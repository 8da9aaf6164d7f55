/* Onto a line: three continuous-curvature turns (turns.h) from beside a straight line onto it, the shortest first.
 *
 * The first turn is tried with multiples of 7.5 degrees. The last one is found by a root search between two of these;
 * the middle one follows, as the vehicle must end in the line's direction. A candidate that has not been solved yet holds
 * the bracket of its last turn, and a lower bound of its length.
 */
#ifndef DRAWBAR_ONTO_LINE_H
#define DRAWBAR_ONTO_LINE_H

#include "geometry.h"
#include "turns.h"

#define LINE_STEP (DRAWBAR_PI / 24.0)      /* between the angles that the first and the last turn are tried with, rad */
#define LINE_STEPS 16                      /* of them to either side */
#define LINE_CANDIDATES 128                /* most candidates; 109 have occurred */
#define LINE_ITERATIONS 40                 /* of the root search; typically 8 */
#define LINE_REACHED 1e-13                 /* m; nearer is on the line, for every compiler's rounding */
#define LINE_SAME 1e-9                     /* m; candidates that differ less are equally long */
#define LINE_SLACK 1e-3                    /* m; how far outside the room the turns of a candidate may end */

/* Three turns onto a line: the first and the last one, and how many full circles they make. */
struct candidate {
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
    double offsets[2 * LINE_STEPS + 1];    /* lateral displacement by a last turn, by its angle, m */
    double middles[3][4 * LINE_STEPS + 1]; /* chord of the turn between, by rounds and the other two turns' sum, m */
    double sideways[4 * LINE_STEPS + 1];   /* sine of its direction, by the first turn less the last */
    struct candidate candidates[LINE_CANDIDATES];   /* still to be tried */
    int32_t count;
    int32_t found;                         /* so far */
};

/* The angles (rad) of the three turns. */
static inline void candidate_angles(const struct onto_line *line, const struct candidate *candidate,
                                    double angles[TURNS])
{
    angles[0] = candidate->first;
    angles[1] = 2.0 * DRAWBAR_PI * candidate->rounds - line->heading - candidate->first - candidate->last;
    angles[2] = candidate->last;
}

/* Lateral displacement (m) by a turn (rad) that begins or ends in the line's direction. */
static inline double line_displacement(const struct onto_line *line, double angle)
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
 * the displacement by the last one. */
static inline double line_left(const struct candidate *candidate, double after, double middle, double sideways,
                               double offset)
{
    return after + middle * (candidate->rounds % 2 ? -sideways : sideways) - offset;
}

/* On which side of the line that is: 1 left, -1 right, 0 on it. */
static inline int line_side(double left)
{
    return (left > LINE_REACHED) - (left < -LINE_REACHED);
}

static inline double candidate_left(const struct onto_line *line, const struct candidate *candidate, double after)
{
    double angles[TURNS];

    candidate_angles(line, candidate, angles);
    const double middle = turn_chord(&line->limits, &line->circle, angles[1]);
    const double sideways = line_sideways(line, candidate->first - candidate->last);
    return line_left(candidate, after, middle, sideways, line_displacement(line, candidate->last));
}

/* The least that can be of an angle's size, rad, which is between two others. */
static inline double smallest_between(double a, double b)
{
    return a * b < 0.0 ? 0.0 : fmin(fabs(a), fabs(b));
}

/* The length of the candidate, m; a lower bound unless it is found. */
static inline double candidate_length(const struct onto_line *line, const struct candidate *candidate)
{
    const double bracket = candidate->found ? 0.0 : LINE_STEP;
    double angles[TURNS];

    candidate_angles(line, candidate, angles);
    return turn_length(&line->limits, angles[0])
        + turn_length(&line->limits, smallest_between(angles[1], angles[1] - bracket))
        + turn_length(&line->limits, smallest_between(angles[2], angles[2] + bracket));
}

/* Find the last turn that ends on the line, by the Illinois method (Dowell and Jarratt 1971). */
static inline void candidate_solve(const struct onto_line *line, struct candidate *candidate)
{
    const double after = line_after(line, candidate->first);
    double low = candidate->last, high = low + LINE_STEP;
    double left_low = candidate_left(line, candidate, after), left_high, left = left_low;
    int side = 0;

    if (fabs(left) > LINE_REACHED)
        candidate->last = high;
    left_high = left = candidate_left(line, candidate, after);
    for (int i = 0; i < LINE_ITERATIONS && fabs(left) > LINE_REACHED; ++i) {
        candidate->last = clamped((low * left_high - high * left_low) / (left_high - left_low), low, high);
        left = candidate_left(line, candidate, after);
        if ((left > 0.0) == (left_low > 0.0)) {
            low = candidate->last;
            left_low = left;
            left_high *= side == -1 ? 0.5 : 1.0;
            side = -1;
        } else {
            high = candidate->last;
            left_high = left;
            left_low *= side == 1 ? 0.5 : 1.0;
            side = 1;
        }
    }
    candidate->found = 1;
    candidate->length = candidate_length(line, candidate);
}

/* Bracket the candidates that begin with this turn, a number of steps, and these rounds. */
static inline void line_bracket(struct onto_line *line, int first, int rounds)
{
    struct candidate candidate = {.first = LINE_STEP * first, .rounds = (int16_t)rounds};
    const double after = line_after(line, candidate.first);
    int side = 0;

    for (int last = -LINE_STEPS; last <= LINE_STEPS && fabs(after) <= line->room + LINE_SLACK; ++last) {
        const double *offsets = &line->offsets[last + LINE_STEPS];
        const int before = side;
        candidate.last = LINE_STEP * last;
        const double middle = line->middles[rounds + 1][first + last + 2 * LINE_STEPS];
        side = line_side(line_left(&candidate, after, middle, line->sideways[first - last + 2 * LINE_STEPS], *offsets));
        if (last == -LINE_STEPS || side == before || line->count == LINE_CANDIDATES
            || smallest_between(offsets[-1], *offsets) > line->room + LINE_SLACK)
            continue;
        struct candidate *bracketed = &line->candidates[line->count++];
        *bracketed = candidate;
        bracketed->last = LINE_STEP * (last - 1);
        bracketed->length = candidate_length(line, bracketed);
    }
}

/* Bracket all candidates from an offset (m) and a heading (rad) onto the line, whose turns end within the room (m). */
static inline void line_candidates(struct onto_line *line, const struct turn_limits *limits, double offset,
                                   double heading, double room)
{
    line->limits = *limits;
    line->circle = turn_circle(limits);
    line->offset = offset;
    line->heading = heading;
    line->room = room;
    line->count = line->found = 0;
    for (int k = -LINE_STEPS; k <= LINE_STEPS; ++k)
        line->offsets[k + LINE_STEPS] = line_displacement(line, LINE_STEP * k);
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

/* Take out the shortest candidate, of equally long ones the one bracketed first. Returns 0 where none is
 * left, or where the last turns of `most` have been looked for. */
static inline int line_take(struct onto_line *line, int32_t most, struct candidate *taken)
{
    while (line->count > 0) {
        int shortest = 0;
        for (int i = 1; i < line->count; ++i)
            if (line->candidates[i].length < line->candidates[shortest].length - LINE_SAME)
                shortest = i;
        *taken = line->candidates[shortest];
        if (!taken->found) {
            if (line->found++ >= most)
                return 0;
            candidate_solve(line, &line->candidates[shortest]);
            continue;
        }
        --line->count;
        for (int i = shortest; i < line->count; ++i)
            line->candidates[i] = line->candidates[i + 1];
        if (fabs(line_displacement(line, taken->last)) <= line->room + LINE_SLACK)
            return 1;
    }
    return 0;
}

#endif

/* Held set: a primal-dual active set on factorisations in which held inputs have no choice left (held_sweep.h).
 *
 * One pass costs one factorisation and one sweep of the stages up to the last bound, however many bounds are active. A soft
 * bound whose multiplier would exceed its price gives way. Bounds of a kind that no single input answers for, and two that
 * claim the same input and may not give way, are left to active_set.h; what does not settle is left to interior_point.h.
 */
#ifndef DRAWBAR_HELD_SET_H
#define DRAWBAR_HELD_SET_H

#include "held_sweep.h"

#define HELD_PASSES 8

/* What becomes of a bound: one that lies outside is held, one that a multiplier of the wrong sign holds is let go, one that
 * costs more to hold than its price gives way. */
static inline int held_next(const struct qp *s, const struct held_set *h, int i)
{
    const double value = s->z[s->bound[i]], nu = h->nu[i];
    const int side = h->side[i], sign = side < 0 ? -1 : 1;

    if (side == 0)
        return value < s->lower[i] ? -HELD : value > s->upper[i] ? HELD : 0;
    if (side == sign * BEYOND)
        return sign * (value - held_limit(s, h, i)) < 0.0 ? sign * HELD : side;
    if (!(sign * nu <= 0.0) && s->lower[i] < s->upper[i])
        return 0;
    return fabs(nu) <= s->soft_linear[i] ? side : sign * BEYOND;
}

/* An input at its bound, and a state that it leads to at its own: only one of them can be held. Returns 0 where neither may
 * be let go. */
static inline int held_choose(const struct qp *s, const struct held_set *h, int input, int state, int k, int a, int *next)
{
    const double lead = s->B[k][s->bound[state] % NX][a];
    const int outward = (lead > 0.0 ? next[input] : -next[input]) == next[state];

    if (h->side[state] == next[state])     /* to hold the state took more than the input has */
        next[state] *= outward ? 0 : BEYOND;
    else if (outward)                      /* less than what the input has brings the state to its bound */
        next[input] = 0;
    else
        next[state] *= BEYOND;
    return (next[state] != BEYOND && next[state] != -BEYOND) || s->soft_linear[state] < INFINITY;
}

/* Decide anew about all bounds; returns how many changed, or -1 where one cannot be held here. */
static int held_update(const struct qp *restrict s, struct held_set *restrict h)
{
    int next[AT_LEAST_ONE(NB)], held[AT_LEAST_ONE(NB)], count = 0, changes = 0;

    memset(h->by, -1, sizeof h->by);
    for (int i = 0; i < NB; ++i) {
        next[i] = held_next(s, h, i);
        if (next[i] == HELD || next[i] == -HELD)
            held[count++] = i;
    }
    for (int states = 0; states < 2; ++states)
        for (int r = 0; r < count; ++r) {
            const int i = held[r], k = held_stage(s, i);
            if ((s->bound[i] < (N + 1) * NX) != states)
                continue;
            const int a = held_input(s, i), other = a < 0 ? -1 : h->by[k][a];
            if (a < 0 || (other >= 0 && (!states || s->bound[other] < (N + 1) * NX)))
                return -1;
            if (other >= 0 && !held_choose(s, h, other, i, k, a, next))
                return -1;
            if (next[i] == HELD || next[i] == -HELD)
                h->by[k][a] = i;
        }
    for (int i = 0; i < NB; ++i) {
        if (next[i] == h->side[i])
            continue;
        if (next[i] != 0 && held_stage(s, i) > h->last)
            h->last = held_stage(s, i);
        h->side[i] = next[i];
        ++changes;
    }
    return changes;
}

static void held_publish(struct qp *restrict s, const struct held_set *restrict h)
{
    for (int i = 0; i < NB; ++i) {
        if (h->side[i] == 0)
            continue;
        const int beyond = h->side[i] == BEYOND || h->side[i] == -BEYOND, lower = 2 * i, upper = 2 * i + 1;
        const double violation = fabs(s->z[s->bound[i]] - held_limit(s, h, i));
        s->multiplier[lower] = h->nu[i] > 0.0 ? h->nu[i] : 0.0;
        s->multiplier[upper] = h->nu[i] < 0.0 ? -h->nu[i] : 0.0;
        if (beyond) {
            const int m = h->side[i] < 0 ? lower : upper;
            s->multiplier[m] = s->soft_linear[i] + s->soft_quadratic[i] * violation;
            s->violation[m] = violation;
        }
    }
}

enum held_outcome { HELD_SETTLED, HELD_UNSETTLED, HELD_FOREIGN };

/* Solve with bounds, starting from s->z and s->pi as qp_solve left them without. Where it does not settle, or where bounds
 * are of another kind (foreign), the factorisation and the point are others afterwards. */
static enum held_outcome qp_held_set(struct qp *s, struct held_set *h)
{
    held_begin(s, h);
    s->factored = 0;
    for (s->iterations = 1; s->iterations <= HELD_PASSES; ++s->iterations) {
        const int changes = held_update(s, h);
        if (changes == 0) {
            held_publish(s, h);
            return HELD_SETTLED;
        }
        if (changes < 0 || !held_solve(s, h))
            return s->iterations == 1 ? HELD_FOREIGN : HELD_UNSETTLED;
    }
    return HELD_UNSETTLED;
}

#endif

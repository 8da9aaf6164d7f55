/* Held again: with which bounds the held set begins. A controller has a sequence of problems, each much like the one before.
 * The bounds that held inputs in the last one are kept, move on with the trajectory, and are taken into the factorisation that
 * is made before the problem is complete. Where they are those of the new problem too, two sweeps solve it, as without any
 * bound. Else it goes on from there; where that does not settle, it begins a second time with none.
 */
#ifndef DRAWBAR_HELD_AGAIN_H
#define DRAWBAR_HELD_AGAIN_H

#include "held_set.h"

/* The place in z of what the bound that is kept for an input speaks of; -1 where none is kept, or where the input does not
 * move it by this linearisation. */
static inline int held_place(const struct qp *s, int k, int a)
{
    const int kept = s->kept[k][a], j = (kept < 0 ? -kept : kept) - 1;

    if (j == NX)
        return (N + 1) * NX + k * NU + a;
    return j >= 0 && j < ND && fabs(s->B[k][j][a]) > 0.0 ? (k + 1) * NX + j : -1;
}

/* Factorise with the laws of the bounds that are kept. Returns 0 where there are none, or on failure. */
static inline int held_factor(struct qp *restrict s)
{
    struct held_hessian H ON_STACK;
    double rest[NU][WIDTH];
    int any = 0;

    for (int k = 0; k < N; ++k)
        for (int a = 0; a < NU; ++a)
            any |= s->kept[k][a];
    if (!any)
        return 0;
    memcpy(s->P[N], s->Q[N], sizeof s->P[N]);
    for (int k = N - 1; k >= 0; --k) {
        double asked[NU], limit[NU] = {0.0};
        int at[NU];
        for (int a = 0; a < NU; ++a)
            at[a] = held_place(s, k, a);
        held_hessian(s, NULL, k, &H);
        if (!held_gains(s, k, at, limit, &H, asked))
            return 0;
        held_cost(s, NULL, k, &H, rest);
    }
    return 1;
}

/* held_vectors by the factorisation as it is. No bound has given way. */
static void held_vectors_by_factors(const struct qp *restrict s, struct held_set *restrict h, int k)
{
    double asked[NU], defect[NX], along[WIDTH], slope[NU];

    UNROLLED for (int a = 0; a < NU; ++a) {
        const int i = h->by[k][a], at = i < 0 ? 0 : s->bound[i];
        asked[a] = i < 0 ? 0.0 : held_asks(s, at, k, held_per(s, at, k, a), held_limit(s, h, i));
    }
    memcpy(defect, s->c[k], sizeof defect);
    UNROLLED for (int m = 0; m < ND; ++m)
        UNROLLED for (int a = 0; a < NU; ++a)
            defect[m] += s->B[k][m][a] * asked[a];
    held_along(s, h->p[k + 1], k, defect, along);
    UNROLLED for (int a = 0; a < NU; ++a) {
        slope[a] = held_slope(s, h->g, k, a, along);
        UNROLLED for (int b = 0; b < NU; ++b)
            slope[a] += s->R[k][a][b] * asked[b];
    }
    held_vectors(s, h, k, along, slope, asked);
}

/* Let the next problem of a sequence begin with the bounds that are held; with none where some have given way. */
static void held_keep(struct qp *restrict s, const struct held_set *restrict h)
{
    int gave_way = 0;

    for (int i = 0; i < NB; ++i)
        gave_way |= h->side[i] == BEYOND || h->side[i] == -BEYOND;
    for (int k = 0; k < N; ++k)
        for (int a = 0; a < NU; ++a) {
            const int i = h->by[k][a], at = i < 0 ? 0 : s->bound[i], j = at < (N + 1) * NX ? at % NX : NX;
            s->kept[k][a] = gave_way || i < 0 ? 0 : h->side[i] * (1 + j);
        }
}

/* Hold the bounds that are kept. Returns 0 where one of them is none of this problem. */
static int held_recall(const struct qp *restrict s, struct held_set *restrict h)
{
    int found = 1;

    memset(h->side, 0, sizeof h->side);
    memset(h->by, -1, sizeof h->by);
    memset(h->curve, 0, sizeof h->curve);
    memcpy(h->g, s->g, sizeof h->g);
    h->last = -1;
    held_chain(s, h);
    for (int k = 0; k < N; ++k)
        for (int a = 0; a < NU; ++a) {
            const int at = held_place(s, k, a);
            int by = at < 0 ? -1 : h->first[k][a];
            while (by >= 0 && s->bound[by] != at)
                by = h->next[by];
            if (by >= 0)
                h->side[by] = s->kept[k][a] < 0 ? -HELD : HELD;
            found &= at < 0 || (by >= 0 && isfinite(held_limit(s, h, by)));
            h->by[k][a] = by;
            h->last = by >= 0 ? k : h->last;
        }
    return found;
}

/* Forward by the laws of the bounds that are kept. Returns how many bounds have changed, or -1 where these laws do not apply. */
static int held_first(struct qp *restrict s, struct held_set *restrict h)
{
    if (!held_recall(s, h))
        return -1;
    for (int i = 0; i < NX; ++i)
        h->p[N][i] = STATE(s->g, N)[i];
    for (int k = N - 1; k >= 0; --k)
        held_vectors_by_factors(s, h, k);
    return held_forward(s, h, 0);
}

/* Solve with bounds by a factorisation with the laws of those that are kept, maybe none. Where it does not settle, or where
 * bounds are of another kind (foreign), the factorisation and the point are others afterwards. */
static enum held_outcome qp_held(struct qp *s, struct held_set *h)
{
    const int kept = s->factored == FACTORED_KEPT, changes = held_first(s, h);

    s->factored = NOT_FACTORED;
    s->iterations = kept;
    if (changes < 0)
        return HELD_FOREIGN;
    if (kept && changes == 0 && held_settled(s, h))
        return HELD_SETTLED;
    return held_settle(s, h, changes, kept);
}

#endif

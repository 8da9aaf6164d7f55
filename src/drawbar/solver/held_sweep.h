/* Held sweep: Riccati recursion in which held inputs have no choice left (held_stage.h), from the last held bound on backward.
 *
 * The multiplier of a held bound is what is left of its input's gradient. Bounds that have given way are held by nothing: their
 * price pulls.
 */
#ifndef DRAWBAR_HELD_SWEEP_H
#define DRAWBAR_HELD_SWEEP_H

#include "held_stage.h"

#define HELD 1                             /* side: times -1 at the lower bound, 1 at the upper */
#define BEYOND 2                           /* and given way */

/* What the price of those that give way adds to the cost. */
static void held_price(const struct qp *restrict s, struct held_set *restrict h)
{
    memcpy(h->g, s->g, sizeof h->g);
    memset(h->curve, 0, sizeof h->curve);
    for (int i = 0; i < NB; ++i)
        if (h->side[i] == BEYOND || h->side[i] == -BEYOND) {
            const int at = s->bound[i];
            h->curve[at] += s->soft_quadratic[i];
            h->g[at] += (h->side[i] < 0 ? -1.0 : 1.0) * s->soft_linear[i] - s->soft_quadratic[i] * held_limit(s, h, i);
        }
}

/* Multipliers of the held bounds: what is left of their inputs' gradients. */
static void held_multipliers(struct qp *restrict s, struct held_set *restrict h)
{
    memset(h->nu, 0, sizeof h->nu);
    for (int k = 0; k <= h->last; ++k)
        for (int a = 0; a < NU; ++a) {
            const int i = h->by[k][a], j = i < 0 ? 0 : s->bound[i] % NX;
            double left = INPUT(s->g, k)[a];
            if (i < 0)
                continue;
            for (int b = 0; b < NU; ++b)
                left += s->R[k][a][b] * INPUT(s->z, k)[b];
            for (int b = 0; CROSS && b < NX; ++b)
                left += s->S[k][a][b] * STATE(s->z, k)[b];
            for (int m = 0; m < ND; ++m)
                left += s->B[k][m][a] * STATE(s->pi, k + 1)[m];
            if (s->bound[i] < (N + 1) * NX) {
                left /= s->B[k][j][a];
                STATE(s->pi, k + 1)[j] -= left;
            }
            h->nu[i] = left;
        }
}

/* The price of bound i, which gives way from now on: to the costs at stage k, from which the recursion has not gone on. */
static void held_give_way(struct qp *restrict s, struct held_set *restrict h, int i, int k)
{
    const int at = s->bound[i], sign = h->side[i] < 0 ? -1 : 1;
    const double slope = sign * s->soft_linear[i] - s->soft_quadratic[i] * held_limit(s, h, i);

    h->side[i] = sign * BEYOND;
    h->g[at] += slope;
    h->curve[at] += s->soft_quadratic[i];
    if (at < (N + 1) * NX) {
        h->p[k + 1][at % NX] += slope;
        s->P[k + 1][at % NX][at % NX] += s->soft_quadratic[i];
    }
}

/* Release bounds that hold inputs of a stage back from where the cost falls, and let give way what costs more to hold than
 * its price: the trajectory is where they hold it. Returns whether one gave way: the stage's Hessian is another one then. */
static int held_release(struct qp *restrict s, struct held_set *restrict h, int k, const struct held_hessian *restrict H)
{
    pack x[PACKS];

    read_vector(x, STATE(s->z, k));
    for (int a = 0; a < NU; ++a) {
        const int i = h->by[k][a];
        if (i < 0)
            continue;
        double slope = add_dot(H->hu[a], H->Hux[a], x);
        for (int b = 0; b < NU; ++b)
            slope += H->Huu[a][b] * INPUT(s->z, k)[b];
        const double pull = -slope * h->side[i] / held_lead(s, i, k, a);
        if (pull > s->soft_linear[i]) {
            held_give_way(s, h, i, k);
            h->by[k][a] = -1;
            return 1;
        }
        if (pull < 0.0 && s->lower[i] < s->upper[i]) {
            h->side[i] = 0;
            h->by[k][a] = -1;
        }
    }
    return 0;
}

/* Backward from the last bound that was ever held: releases, laws and costs to go; returns 0 on failure. */
static int held_backward(struct qp *restrict s, struct held_set *restrict h)
{
    struct held_hessian H ON_STACK;

    held_price(s, h);
    if (h->last == N - 1) {
        memcpy(s->P[N], s->Q[N], sizeof s->P[N]);
        for (int i = 0; i < NX; ++i) {
            s->P[N][i][i] += STATE(h->curve, N)[i];
            h->p[N][i] = STATE(h->g, N)[i];
        }
    }
    for (int k = h->last < N - 1 ? h->last + 1 : N - 1; k >= 0; --k) {
        double asked[NU], limit[NU];
        int at[NU];
        for (int a = 0, again = 1; a <= NU && again; ++a) {
            held_hessian(s, h->curve, k, &H);
            held_along(s, h->p[k + 1], k, s->c[k], H.along);
            for (int b = 0; b < NU; ++b)
                H.hu[b] = held_slope(s, h->g, k, b, H.along);
            again = held_release(s, h, k, &H);
        }
        for (int a = 0; a < NU; ++a) {
            const int i = h->by[k][a];
            at[a] = i < 0 ? -1 : s->bound[i];
            limit[a] = i < 0 ? 0.0 : held_limit(s, h, i);
        }
        if (!held_gains(s, k, at, limit, &H, asked))
            return 0;
        held_cost(s, h->curve, k, &H, h->rest[k]);
        held_vectors_by_hessian(s, h, k, asked, &H);
        held_left(h, k, &H);
    }
    return 1;
}

#endif

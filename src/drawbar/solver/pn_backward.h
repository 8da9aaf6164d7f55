/* Backward sweep of projected_newton.h: Riccati recursion with the laws of active bounds (pn_stage.h), from the last active
 * bound on backward.
 *
 * The multiplier of an active bound is its input's gradient. Violated soft bounds have no law; their penalty joins the cost.
 */
#ifndef DRAWBAR_PN_BACKWARD_H
#define DRAWBAR_PN_BACKWARD_H

#include "pn_stage.h"

#define PN_ACTIVE 1                        /* side of a bound: negative at the lower one */
#define PN_VIOLATED 2                      /* soft, and beyond */

/* Gradient and curvature with the penalties of violated bounds. */
static void pn_penalties(const struct qp *restrict s, struct projected_newton *restrict pn)
{
    memcpy(pn->g, s->g, sizeof pn->g);
    memset(pn->penalty_curvature, 0, sizeof pn->penalty_curvature);
    for (int i = 0; i < NB; ++i)
        if (pn->side[i] == PN_VIOLATED || pn->side[i] == -PN_VIOLATED) {
            const int at = s->bound[i];
            pn->penalty_curvature[at] += s->soft_quadratic[i];
            pn->g[at] += (pn->side[i] < 0 ? -1.0 : 1.0) * s->soft_linear[i] - s->soft_quadratic[i] * pn_limit(s, pn, i);
        }
}

/* Multipliers of the active bounds: their inputs' gradients. */
static void pn_multipliers(struct qp *restrict s, struct projected_newton *restrict pn)
{
    memset(pn->nu, 0, sizeof pn->nu);
    for (int k = 0; k <= pn->last; ++k)
        for (int a = 0; a < NU; ++a) {
            const int i = pn->active[k][a], j = i < 0 ? 0 : s->bound[i] % NX;
            double gradient = INPUT(s->g, k)[a];
            if (i < 0)
                continue;
            for (int b = 0; b < NU; ++b)
                gradient += s->R[k][a][b] * INPUT(s->z, k)[b];
            for (int b = 0; CROSS && b < NX; ++b)
                gradient += s->S[k][a][b] * STATE(s->z, k)[b];
            for (int m = 0; m < ND; ++m)
                gradient += s->B[k][m][a] * STATE(s->pi, k + 1)[m];
            if (s->bound[i] < (N + 1) * NX) {
                gradient /= s->B[k][j][a];
                STATE(s->pi, k + 1)[j] -= gradient;
            }
            pn->nu[i] = gradient;
        }
}

/* Penalise bound i, violated from now on: add its penalty to the costs of stage k, which the recursion has not left. */
static void pn_penalise(struct qp *restrict s, struct projected_newton *restrict pn, int i, int k)
{
    const int at = s->bound[i], sign = pn->side[i] < 0 ? -1 : 1;
    const double slope = sign * s->soft_linear[i] - s->soft_quadratic[i] * pn_limit(s, pn, i);

    pn->side[i] = sign * PN_VIOLATED;
    pn->g[at] += slope;
    pn->penalty_curvature[at] += s->soft_quadratic[i];
    if (at < (N + 1) * NX) {
        pn->p[k + 1][at % NX] += slope;
        s->P[k + 1][at % NX][at % NX] += s->soft_quadratic[i];
    }
}

/* Release the active bounds of a stage whose multiplier has the wrong sign on the present trajectory, and penalise one whose
 * multiplier exceeds its linear penalty. Returns whether one is penalised: the stage's Hessian has changed then. */
static int pn_release(struct qp *restrict s, struct projected_newton *restrict pn, int k, const struct pn_hessian *restrict H)
{
    pack x[PACKS];

    read_vector(x, STATE(s->z, k));
    for (int a = 0; a < NU; ++a) {
        const int i = pn->active[k][a];
        if (i < 0)
            continue;
        double slope = add_dot(H->hu[a], H->Hux[a], x);
        for (int b = 0; b < NU; ++b)
            slope += H->Huu[a][b] * INPUT(s->z, k)[b];
        const double multiplier = -slope * pn->side[i] / pn_sensitivity(s, i, k, a);
        if (multiplier > s->soft_linear[i]) {
            pn_penalise(s, pn, i, k);
            pn->active[k][a] = -1;
            return 1;
        }
        if (multiplier < 0.0 && s->lower[i] < s->upper[i]) {
            pn->side[i] = 0;
            pn->active[k][a] = -1;
        }
    }
    return 0;
}

/* Backward from the last bound that was ever active: releases, laws and costs to go; returns 0 on failure. */
static int pn_backward(struct qp *restrict s, struct projected_newton *restrict pn)
{
    struct pn_hessian H ON_STACK;

    pn_penalties(s, pn);
    if (pn->last == N - 1) {
        memcpy(s->P[N], s->Q[N], sizeof s->P[N]);
        for (int i = 0; i < NX; ++i) {
            s->P[N][i][i] += STATE(pn->penalty_curvature, N)[i];
            pn->p[N][i] = STATE(pn->g, N)[i];
        }
    }
    for (int k = pn->last < N - 1 ? pn->last + 1 : N - 1; k >= 0; --k) {
        double offset[NU], limit[NU];
        int at[NU];
        for (int a = 0, again = 1; a <= NU && again; ++a) {
            pn_form_hessian(s, pn->penalty_curvature, k, &H);
            pn_costate(s, pn->p[k + 1], k, s->c[k], H.costate);
            for (int b = 0; b < NU; ++b)
                H.hu[b] = pn_input_gradient(s, pn->g, k, b, H.costate);
            again = pn_release(s, pn, k, &H);
        }
        for (int a = 0; a < NU; ++a) {
            const int i = pn->active[k][a];
            at[a] = i < 0 ? -1 : s->bound[i];
            limit[a] = i < 0 ? 0.0 : pn_limit(s, pn, i);
        }
        if (!pn_gains(s, k, at, limit, &H, offset))
            return 0;
        pn_cost_to_go(s, pn->penalty_curvature, k, &H, pn->gradient_gain[k]);
        pn_vectors_by_hessian(s, pn, k, offset, &H);
        pn_store_gradients(pn, k, &H);
    }
    return 1;
}

#endif

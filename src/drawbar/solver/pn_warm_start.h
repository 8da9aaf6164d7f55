/* Warm start of projected_newton.h. A controller solves a sequence of problems, each much like the one before. The active
 * bounds of the last one are kept, shifted with the trajectory, and their laws taken into the factorisation that is made before
 * the problem is complete. Where they are active in the new problem too, two sweeps solve it, as without any bound. Else passes
 * go on from there; where these do not converge, it begins a second time with no bound active.
 */
#ifndef DRAWBAR_PN_WARM_START_H
#define DRAWBAR_PN_WARM_START_H

#include "projected_newton.h"

/* Index into z of the variable whose bound is kept for an input; -1 where none is kept, or where the input does not move it
 * in this linearisation. */
static inline int pn_kept_variable(const struct qp *s, int k, int a)
{
    const int kept = s->kept[k][a], j = (kept < 0 ? -kept : kept) - 1;

    if (j == NX)
        return (N + 1) * NX + k * NU + a;
    return j >= 0 && j < ND && fabs(s->B[k][j][a]) > 0.0 ? (k + 1) * NX + j : -1;
}

/* Factorise with the laws of the kept bounds. Returns 0 where there are none, or on failure. */
static inline int pn_factor(struct qp *restrict s)
{
    struct pn_hessian H ON_STACK;
    double gradient_gain[NU][WIDTH];
    int any = 0;

    for (int k = 0; k < N; ++k)
        for (int a = 0; a < NU; ++a)
            any |= s->kept[k][a];
    if (!any)
        return 0;
    memcpy(s->P[N], s->Q[N], sizeof s->P[N]);
    for (int k = N - 1; k >= 0; --k) {
        double offset[NU], limit[NU] = {0.0};
        int at[NU];
        for (int a = 0; a < NU; ++a)
            at[a] = pn_kept_variable(s, k, a);
        pn_form_hessian(s, NULL, k, &H);
        if (!pn_gains(s, k, at, limit, &H, offset))
            return 0;
        pn_cost_to_go(s, NULL, k, &H, gradient_gain);
    }
    return 1;
}

/* pn_vectors by the factorisation as it is. No bound is violated. */
static void pn_vectors_by_factors(const struct qp *restrict s, struct projected_newton *restrict pn, int k)
{
    double offset[NU], defect[NX], costate[WIDTH], gradient[NU];

    UNROLLED for (int a = 0; a < NU; ++a) {
        const int i = pn->active[k][a], at = i < 0 ? 0 : s->bound[i];
        offset[a] = i < 0 ? 0.0 : pn_offset(s, at, k, pn_inverse_input(s, at, k, a), pn_limit(s, pn, i));
    }
    memcpy(defect, s->c[k], sizeof defect);
    UNROLLED for (int m = 0; m < ND; ++m)
        UNROLLED for (int a = 0; a < NU; ++a)
            defect[m] += s->B[k][m][a] * offset[a];
    pn_costate(s, pn->p[k + 1], k, defect, costate);
    UNROLLED for (int a = 0; a < NU; ++a) {
        gradient[a] = pn_input_gradient(s, pn->g, k, a, costate);
        UNROLLED for (int b = 0; b < NU; ++b)
            gradient[a] += s->R[k][a][b] * offset[b];
    }
    pn_vectors(s, pn, k, costate, gradient, offset);
}

/* Keep the active bounds for the next problem of a sequence; none where one is violated. */
static void pn_keep(struct qp *restrict s, const struct projected_newton *restrict pn)
{
    int violated = 0;

    for (int i = 0; i < NB; ++i)
        violated |= pn->side[i] == PN_VIOLATED || pn->side[i] == -PN_VIOLATED;
    for (int k = 0; k < N; ++k)
        for (int a = 0; a < NU; ++a) {
            const int i = pn->active[k][a], at = i < 0 ? 0 : s->bound[i], j = at < (N + 1) * NX ? at % NX : NX;
            s->kept[k][a] = violated || i < 0 ? 0 : pn->side[i] * (1 + j);
        }
}

/* Make the kept bounds active. Returns 0 where this problem does not have one of them. */
static int pn_recall(const struct qp *restrict s, struct projected_newton *restrict pn)
{
    int found = 1;

    memset(pn->side, 0, sizeof pn->side);
    memset(pn->active, -1, sizeof pn->active);
    memset(pn->penalty_curvature, 0, sizeof pn->penalty_curvature);
    memcpy(pn->g, s->g, sizeof pn->g);
    pn->last = -1;
    pn_chain(s, pn);
    for (int k = 0; k < N; ++k)
        for (int a = 0; a < NU; ++a) {
            const int at = pn_kept_variable(s, k, a);
            int bound = at < 0 ? -1 : pn->first[k][a];
            while (bound >= 0 && s->bound[bound] != at)
                bound = pn->next[bound];
            if (bound >= 0)
                pn->side[bound] = s->kept[k][a] < 0 ? -PN_ACTIVE : PN_ACTIVE;
            found &= at < 0 || (bound >= 0 && isfinite(pn_limit(s, pn, bound)));
            pn->active[k][a] = bound;
            pn->last = bound >= 0 ? k : pn->last;
        }
    return found;
}

/* First sweeps, by the laws of the kept bounds. Returns how many bounds have changed, or -1 where these laws do not apply. */
static int pn_first_sweep(struct qp *restrict s, struct projected_newton *restrict pn)
{
    if (!pn_recall(s, pn))
        return -1;
    for (int i = 0; i < NX; ++i)
        pn->p[N][i] = STATE(s->g, N)[i];
    for (int k = N - 1; k >= 0; --k)
        pn_vectors_by_factors(s, pn, k);
    return pn_forward(s, pn, 0);
}

/* Solve with bounds, from a factorisation with the laws of the kept ones, maybe none. Where it does not converge, or where there
 * are coupled bounds, factorisation and point have changed afterwards. */
static enum pn_outcome qp_projected_newton(struct qp *s, struct projected_newton *pn)
{
    const int kept = s->factored == FACTORED_KEPT, changes = pn_first_sweep(s, pn);

    s->factored = NOT_FACTORED;
    s->iterations = kept;
    if (changes < 0)
        return PN_COUPLED;
    if (kept && changes == 0 && pn_accept(s, pn))
        return PN_CONVERGED;
    return pn_iterate(s, pn, changes, kept);
}

#endif

/* Primal-dual active set (Hintermueller, Ito, Kunisch 2003) on the factorisation of the problem without bounds.
 *
 * Bounds that are taken as active become equations z_i = bound with a multiplier nu_i each. The solution is linear in
 * them, z = free + sum_i nu_i column_i, where column_i is one sweep for a unit multiplier on z_i, so that a handful of active
 * bounds costs a handful of sweeps and a small dense system (their Schur complement). Bounds of a free first state alone,
 * an estimator's, cost no sweep: their columns are those of its factor's inverse, and they are found before the way
 * forward. Wherever this does not converge the interior point takes over.
 */
#ifndef DRAWBAR_ACTIVE_SET_H
#define DRAWBAR_ACTIVE_SET_H

#include "kkt.h"

#define ACTIVE_ROUNDING 1e-10              /* a pivot this much smaller than what it was taken from is rounding */
#define ACTIVE_PASSES 10
#ifndef COLUMNS
#define COLUMNS 1                          /* 0 where no bound is coupled: projected_newton.h has them all */
#endif

/* How the gradient alone moves everything. */
static void active_sweep(const struct qp *s, struct active_set *a)
{
    static const double zero[N][NX], still[NX];

    qp_solve(s, a->gradient, zero, still, a->dz, a->dpi);
}

/* Are all bounds those of a free first state? */
static int bounds_at_first(const struct qp *s)
{
    int first = FREE_INITIAL;
    for (int i = 0; i < NB; ++i)
        first &= s->bound[i] < NX;
    return first;
}

/* Where a free first state goes, given the gradient of the cost to go from it. */
static void active_first(const struct qp *s, const double *gradient, double *first)
{
    for (int j = 0; j < NX; ++j)
        first[j] = -gradient[j];
    ldl_state_solve((const double (*)[NX])s->P0_L, s->P0_D, first);
}

/* Add changes of the multipliers to a gradient. */
static void active_add_multipliers(const struct qp *s, const struct active_set *a, const double *change, double *gradient)
{
    for (int r = 0; r < a->count; ++r)
        gradient[s->bound[a->member[r]]] -= change[r];
}

/* Make the column of bounded variable i; returns 0 when there is no room for another. */
static int active_add(const struct qp *s, struct active_set *a, int i)
{
    if (a->count == ACTIVE_MOST)
        return 0;
    memset(a->gradient, 0, sizeof a->gradient);
    a->gradient[s->bound[i]] = -1.0;
    if (a->first)
        active_first(s, a->gradient, a->dz);
    else
        active_sweep(s, a);
    for (int j = 0; j < NB; ++j)
        a->column[a->count][j] = a->dz[s->bound[j]];
    a->member[a->count] = i;
    a->slot[i] = a->count++;
    return 1;
}

/* L D L' of the Schur complement: how far the multipliers move the variables at active bounds; released ones have rows of the
 * identity. Returns 0 when the active bounds depend on each other. */
static int active_factor(struct active_set *a)
{
    for (int r = 0; r < a->count; ++r) {
        const int i = a->member[r], active = a->side[i] != 0;
        const double own = active ? a->column[r][i] : 1.0;
        double pivot = own;
        for (int c = 0; c < r; ++c) {
            double v = active && a->side[a->member[c]] != 0 ? a->column[c][i] : 0.0;
            for (int k = 0; k < c; ++k)
                v -= a->L[r][k] * a->L[c][k] * a->D[k];
            a->L[r][c] = v / a->D[c];
            pivot -= a->L[r][c] * v;
        }
        if (!(pivot > ACTIVE_ROUNDING * own))
            return 0;
        a->D[r] = pivot;
    }
    return 1;
}

/* Changes of the multipliers that take the variables of active bounds from s->z to these. */
static void active_solve(const struct qp *s, const struct active_set *a, double *nu)
{
    for (int r = 0; r < a->count; ++r) {
        const int i = a->member[r], side = a->side[i];
        nu[r] = side == 0 ? 0.0 : (side < 0 ? s->lower[i] : s->upper[i]) - s->z[s->bound[i]];
        for (int c = 0; c < r; ++c)
            nu[r] -= a->L[r][c] * nu[c];
    }
    for (int r = a->count - 1; r >= 0; --r) {
        nu[r] /= a->D[r];
        for (int k = r + 1; k < a->count; ++k)
            nu[r] -= a->L[k][r] * nu[k];
    }
}

/* Release bounds with a multiplier of the wrong sign, activate violated ones; returns how many changed, or -1. */
static int active_update(const struct qp *s, struct active_set *a)
{
    int changes = 0;

    for (int i = 0; i < NB; ++i) {
        int side = a->side[i];
        if (side != 0) {
            if (!(side * a->nu[a->slot[i]] <= 0.0) && s->lower[i] < s->upper[i])
                side = 0;
        } else {
            double value = s->z[s->bound[i]];
            for (int r = 0; r < a->count; ++r)
                value += a->nu[r] * a->column[r][i];
            side = value < s->lower[i] ? -1 : value > s->upper[i] ? 1 : 0;
        }
        changes += side != a->side[i];
        a->side[i] = side;
    }
    for (int i = 0; i < NB; ++i)
        if (a->side[i] != 0 && a->slot[i] < 0 && !active_add(s, a, i))
            return -1;
    return changes;
}

/* Find the bounds that are active, starting from s->z as it is without; returns 0 when they do not converge, or when a soft
 * one has to be violated. */
static int active_settle(struct qp *s, struct active_set *a, int first)
{
    a->first = first;
    a->count = 0;
    memset(a->side, 0, sizeof a->side);
    for (int i = 0; i < NB; ++i)
        a->slot[i] = -1;
    for (s->iterations = 0; s->iterations < ACTIVE_PASSES; ++s->iterations) {
        const int changes = active_update(s, a);
        if (changes == 0) {
            for (int r = 0; r < a->count; ++r)
                if (!(fabs(a->nu[r]) <= s->soft_linear[a->member[r]]))
                    return 0;
            return 1;
        }
        if (changes < 0 || !active_factor(a))
            return 0;
        active_solve(s, a, a->nu);
    }
    return 0;
}

static void active_multipliers(struct qp *s, const struct active_set *a, const double *correction)
{
    for (int r = 0; r < a->count; ++r) {
        const double nu = a->nu[r] + correction[r];
        s->multiplier[2 * a->member[r]] = nu > 0.0 ? nu : 0.0;
        s->multiplier[2 * a->member[r] + 1] = nu < 0.0 ? -nu : 0.0;
    }
}

/* Solve with bounds, starting from s->z and s->pi as qp_solve left them without: one sweep with the settled multipliers, and
 * one to correct them for what rounding left. Returns 0, with z, pi and multipliers as they were, when it does not settle. */
static int qp_active_set(struct qp *s, struct active_set *a)
{
    double correction[AT_LEAST_ONE(ACTIVE_MOST)];

    if (!active_settle(s, a, 0))
        return 0;
    memcpy(a->gradient, s->g, sizeof a->gradient);
    active_add_multipliers(s, a, a->nu, a->gradient);
    qp_solve(s, a->gradient, (const double (*)[NX])s->c, s->initial, s->z, s->pi);
    active_solve(s, a, correction);
    memset(a->gradient, 0, sizeof a->gradient);
    active_add_multipliers(s, a, correction, a->gradient);
    active_multipliers(s, a, correction);
    active_sweep(s, a);
    for (int i = 0; i < NZ; ++i)
        s->z[i] += a->dz[i];
    for (int i = 0; i < (N + 1) * NX; ++i)
        s->pi[i] += a->dpi[i];
    return 1;
}

/* Solve where all bounds are those of a free first state; s->iterations stays 0 where none is active. Returns 0, with the
 * solution without bounds, when it does not settle. */
static int qp_first_set(struct qp *s, struct active_set *a)
{
    double feedforward[N][NU], change[NX] = {0}, first[NX], correction[AT_LEAST_ONE(ACTIVE_MOST)];

    solve_backward(s, s->g, (const double (*)[NX])s->c, s->pi, feedforward);
    active_first(s, s->pi, s->z);
    const int settled = active_settle(s, a, 1);
    if (settled && a->count > 0) {         /* with the settled multipliers, then moved by what rounding left */
        active_add_multipliers(s, a, a->nu, s->pi);
        active_first(s, s->pi, s->z);
        active_solve(s, a, correction);
        active_add_multipliers(s, a, correction, change);
        active_multipliers(s, a, correction);
    }
    active_first(s, change, first);
    for (int j = 0; j < NX; ++j)
        first[j] += s->z[j];
    solve_forward(s, (const double (*)[NU])feedforward, (const double (*)[NX])s->c, first, s->z, s->pi);
    return settled;
}

#endif

/* Residuals of the optimality conditions, computed from the problem's data alone: nothing here uses the factorisation.
 *
 * The interior point iterates on these residuals, and every solution, from whatever route, is judged by them.
 */
#ifndef DRAWBAR_KKT_H
#define DRAWBAR_KKT_H

#include <float.h>

#include "kkt_scale.h"

#define CHECK_TOLERANCE 1e-8
#define GAP_TOLERANCE 1e-7                 /* of what the answer may cost above the optimum, relative to the cost's terms */

static inline int all_finite(const double *restrict values, size_t count)
{
    int bad = 0;
    for (size_t i = 0; i < count; ++i)
        bad |= !(fabs(values[i]) < (double)INFINITY);
    return !bad;
}

/* Gradient of the Lagrangian without the bounds' multipliers, and the defects of the dynamics.
 * weight 0 leaves out the cost: what remains is the linear part of an infeasibility certificate. */
static void kkt_residual(const struct qp *restrict s, const double *restrict z, const double *restrict pi, double weight,
                         double *restrict gradient, double (*restrict defect)[NX])
{
    for (int k = 0; k <= N; ++k) {
        const double *x = STATE(z, k);
        pack cost[PACKS], gx[PACKS], state[PACKS];

        read_vector(cost, STATE(s->g, k));
        read_vector(gx, STATE(pi, k));
        for (int j = 0; j < NX; ++j)
            add_row(cost, x[j], s->Q[k][j]);
        EACH_PACK(b)
            gx[b] = k > 0 || !FREE_INITIAL ? -gx[b] : gx[b] * 0.0;
        if (k < N) {
            const double *u = INPUT(z, k), *next = STATE(pi, k + 1);
            pack after[PACKS];

            read_vector(state, x);
            read_vector(after, next);
            for (int a = 0; a < NU; ++a) {
                double gu = CROSS ? add_dot(INPUT(s->g, k)[a], s->S[k][a], state) : INPUT(s->g, k)[a];
                for (int b = 0; b < NU; ++b)
                    gu += s->R[k][a][b] * u[b];
                gu *= weight;
                for (int m = 0; m < ND; ++m)
                    gu += s->B[k][m][a] * next[m];
                INPUT(gradient, k)[a] = gu;
                if (CROSS)
                    add_row(cost, u[a], s->S[k][a]);
            }
            EACH_PACK(b)
                gx[b] += mask_from(ND, b) * after[b];
            for (int m = 0; m < ND; ++m)
                add_row(gx, next[m], s->A[k][m]);
            for (int i = 0; i < ND; ++i) {
                double sum = add_dot(s->c[k][i], s->A[k][i], state);
                for (int a = 0; a < NU; ++a)
                    sum += s->B[k][i][a] * u[a];
                defect[k][i] = sum - STATE(z, k + 1)[i];
            }
            for (int i = ND; i < NX; ++i)
                defect[k][i] = s->c[k][i] + x[i] - STATE(z, k + 1)[i];
        }
        EACH_PACK(b)
            gx[b] += weight * cost[b];
        write_vector(STATE(gradient, k), gx);
    }
    if (!FREE_INITIAL)                     /* pi_0 belongs to the given initial state and may take any value */
        memset(STATE(gradient, 0), 0, NX * sizeof(double));
}

/* Distance of bounded variable i from its lower (side 0) or upper (side 1) bound; negative when violated. */
static inline double bound_distance(const struct qp *s, const double *z, int side)
{
    const int i = side / 2;
    const double value = z[s->bound[i]];
    return side % 2 == 0 ? value - s->lower[i] : s->upper[i] - value;
}

/* Is bounded variable i a hard bound of a given first state? No multiplier can act there. */
static inline int is_given(const struct qp *s, int i)
{
    return !FREE_INITIAL && s->bound[i] < NX && !(s->soft_linear[i] < (double)INFINITY);
}

/* What the bounds add: their multipliers to the gradient, the penalty of violations to the cost; returns their own worst
 * relative residual, and what their multipliers and distances from them cost together, the gap. */
static double kkt_bounds(const struct qp *restrict s, struct kkt_scale *restrict scale, double *restrict gradient,
                         double *restrict total)
{
    double outside[NX + NU] = {0.0}, negative[NX + NU] = {0.0}, worst = 0.0, gap = 0.0;

    for (int m = 0; m < NSIDES; ++m) {
        const int i = m / 2;
        const double lambda = s->multiplier[m], slack = s->violation[m], distance = bound_distance(s, s->z, m) + slack;
        if (lambda == 0.0 && slack == 0.0 && distance >= 0.0)
            continue;
        const int kind = kind_of(s->bound[i]), soft = s->soft_linear[i] < (double)INFINITY;
        gradient[s->bound[i]] -= m % 2 == 0 ? lambda : -lambda;
        outside[kind] = largest(outside[kind], distance < 0.0 ? distance : 0.0);
        outside[kind] = largest(outside[kind], slack < 0.0 || !soft ? slack : 0.0);
        negative[kind] = largest(negative[kind], lambda < 0.0 ? lambda : 0.0);
        gap += fabs(lambda * distance);
        if (soft) {                        /* the multiplier of slack >= 0 is what remains of its cost */
            const double sigma = s->soft_linear[i] + s->soft_quadratic[i] * slack - lambda;
            const double penalty = fabs((s->soft_linear[i] + 0.5 * s->soft_quadratic[i] * slack) * slack);
            scale->slope += penalty;
            scale->terms += penalty;
            negative[kind] = largest(negative[kind], sigma < 0.0 ? sigma : 0.0);
            gap += fabs(sigma) * (fabs(slack) + (distance < 0.0 ? -distance : 0.0));   /* of the slack, stated and true */
        }
    }
    for (int j = 0; j < NX + NU; ++j)
        worst = largest(largest(worst, outside[j] / scale->primal[j]), negative[j] / scale->dual[j]);
    *total = gap;
    return largest(worst, gap / scale->objective);
}

/* Judge z, pi and (bounded: also) the multipliers: sets s->kkt, the largest residual relative to the sizes above, and
 * returns SOLVED, NOT_FINITE or CHECK_FAILED. Leaves the gradient of the Lagrangian and the defects with the caller.
 * Without `bounded` every bound must have been found respected.
 *
 * Where multipliers have run away their own size forgives everything. So what all residuals together may cost is held
 * against the cost itself: a residual of the gradient moves it by as much times the variable, one of the dynamics by as
 * much times the costate, and the gap of bounds and multipliers by itself. No state is known better than to its rounding:
 * what costates of 1e16 make of that is among it. */
static int kkt_check(struct qp *s, int bounded, double *gradient, double (*defect)[NX])
{
    double stationarity[NX + NU] = {0.0}, feasibility[NX] = {0.0}, worst = 0.0, gap = 0.0;
    struct kkt_scale scale ON_STACK;

    if (!all_finite(s->z, NZ) || !all_finite(s->pi, (N + 1) * NX) || (bounded && !all_finite(s->multiplier, NSIDES)))
        return NOT_FINITE;
    kkt_residual(s, s->z, s->pi, 1.0, gradient, defect);
    kkt_scales(s, bounded, &scale);
    if (bounded)
        worst = kkt_bounds(s, &scale, gradient, &gap);
    largest_of_kinds(STATE(gradient, 0), N + 1, NX, stationarity);
    largest_of_kinds(INPUT(gradient, 0), N, NU, stationarity + NX);
    largest_of_kinds(&defect[0][0], N, NX, feasibility);
    for (int j = 0; j < NX && !FREE_INITIAL; ++j)
        feasibility[j] = largest(feasibility[j], s->z[j] - s->initial[j]);
    for (int j = 0; j < NX + NU; ++j) {
        worst = largest(worst, stationarity[j] / scale.dual[j]);
        gap += (N + 1) * stationarity[j] * scale.primal[j];
    }
    for (int j = 0; j < NX; ++j) {
        worst = largest(worst, feasibility[j] / scale.primal[j]);
        gap += ((N + 1) * feasibility[j] + DBL_EPSILON * scale.primal[j]) * scale.dual[j];
    }
    gap *= CHECK_TOLERANCE / GAP_TOLERANCE;   /* as a residual; NaN does not pass */
    const double left = fabs(scale.slope), known = left > DROWNED * ROUNDING * scale.terms ? left : 0.0;
    if (worst <= CHECK_TOLERANCE && !(gap <= CHECK_TOLERANCE * known)) {
        gap /= kkt_cost(s, &scale);
        worst = gap <= worst ? worst : gap;
    }
    s->kkt = worst;
    return s->kkt <= CHECK_TOLERANCE ? SOLVED : CHECK_FAILED;
}

#endif

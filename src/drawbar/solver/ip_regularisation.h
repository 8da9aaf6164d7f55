/* Interior-point regularisation (Friedlander and Orban 2012): proximal terms in the steps. They change no solution, since steps
 * vanish there.
 *
 * Primal: curvature is added to the diagonal of the Hessian, where the cost leaves something undetermined. Dual: a bound gives
 * way by delta dlambda, where barrier weights lambda / t are so large that rounding in the factorisation stands in the way.
 */
#ifndef DRAWBAR_IP_REGULARISATION_H
#define DRAWBAR_IP_REGULARISATION_H

#include "kkt.h"

#define PRIMAL_REGULARISATION 1e-8         /* first share of the curvature of its kind of variable */
#define LEAST_PRIMAL_REGULARISATION 1e-13  /* no less than this share */
#define DUAL_REGULARISATION 1e-12          /* first delta, relative to the reciprocal curvature */
#define LARGEST_DUAL_REGULARISATION 1e-5   /* last delta, likewise */
#define REGULARISATION_FACTOR 100.0        /* by which either changes at once */

static inline double positive(double value)
{
    return value > 0.0 ? value : 0.0;
}

/* The diagonal before any bound: primal regularisation alone. */
static void ip_clear_barrier(struct interior_point *ip)
{
    memset(ip->barrier, 0, sizeof ip->barrier);
    for (int i = 0; ip->primal_regularisation.share > 0.0 && i < NZ; ++i)
        ip->barrier[i] = ip->primal_regularisation.share * ip->primal_regularisation.weight[kind_of(i)];
}

/* Where the cost leaves something undetermined: begin to regularise, from the solution of the problem with all of each kind's
 * curvature added. Returns 0 when the cost has no minimum all the same. */
static int ip_regularise_primal(struct qp *restrict s, struct interior_point *restrict ip)
{
    double *weight = ip->primal_regularisation.weight, heaviest = 0.0;

    memset(&ip->primal_regularisation, 0, sizeof ip->primal_regularisation);
    for (int k = 0; k <= N; ++k)
        for (int j = 0; j < NX; ++j)
            weight[j] = largest(weight[j], positive(s->Q[k][j][j]));
    for (int k = 0; k < N; ++k)
        for (int a = 0; a < NU; ++a) {
            double own = positive(s->R[k][a][a]);
            for (int m = 0; m < ND; ++m)
                own += s->B[k][m][a] * s->B[k][m][a] * positive(s->Q[k + 1][m][m]);
            weight[NX + a] = largest(weight[NX + a], own);
        }
    for (int j = 0; j < NX + NU; ++j)
        heaviest = largest(heaviest, weight[j]);
    for (int i = 0; i < NZ && heaviest == 0.0; ++i)   /* no curvature at all: as much as there is slope */
        heaviest = largest(heaviest, s->g[i]);
    for (int j = 0; j < NX + NU; ++j)
        weight[j] = largest(largest(ROUNDING * heaviest, weight[j]), 1e-100);
    for (int strong = 0; strong <= 1; ++strong) {
        ip->primal_regularisation.share = strong ? 1.0 : PRIMAL_REGULARISATION;
        ip_clear_barrier(ip);
        if (!qp_factor(s, ip->barrier, N + 1))
            return 0;
    }
    ip->primal_regularisation.share = PRIMAL_REGULARISATION;
    qp_solve(s, s->g, (const double (*)[NX])s->c, s->initial, s->z, s->pi);
    return 1;
}

/* Where primal regularisation is most of what is left to descend, it holds back what the cost determines, if only just: lower it.
 * Returns whether it did. */
static int ip_lower_primal_regularisation(struct interior_point *ip)
{
    struct primal_regularisation *primal = &ip->primal_regularisation;
    double regularised = 0.0, left = 0.0;

    if (!(primal->share > LEAST_PRIMAL_REGULARISATION))
        return 0;
    for (int i = 0; i < NZ; ++i) {
        regularised += primal->share * primal->weight[kind_of(i)] * ip->dz[i] * ip->dz[i];
        left += fabs(ip->gradient[i] * ip->dz[i]);
    }
    if (!(regularised > 0.5 * left))
        return 0;
    primal->share /= REGULARISATION_FACTOR;
    return 1;
}

/* By how much hard bounds are violated, relative to the size of their kind of variable. */
static double ip_bound_violation(const struct qp *s)
{
    double size[NX + NU] = {0.0}, outside[NX + NU] = {0.0}, worst = 0.0;

    for (int i = 0; i < NZ; ++i)
        size[kind_of(i)] = largest(size[kind_of(i)], s->z[i]);
    for (int m = 0; m < NSIDES; ++m) {
        const double distance = bound_distance(s, s->z, m) + s->violation[m];
        const int kind = kind_of(s->bound[m / 2]);
        outside[kind] = largest(outside[kind], distance < 0.0 ? distance : 0.0);
    }
    for (int j = 0; j < NX + NU; ++j)
        worst = size[j] > 0.0 ? largest(worst, outside[j] / size[j]) : worst;
    return worst;
}

/* Where rounding in the factorisation stands in the way: raise dual regularisation. Returns 0 where it is the largest already. */
static int ip_raise_dual_regularisation(struct interior_point *ip)
{
    if (!(ip->dual_regularisation < LARGEST_DUAL_REGULARISATION))
        return 0;
    ip->dual_regularisation =
        ip->dual_regularisation > 0.0 ? REGULARISATION_FACTOR * ip->dual_regularisation : DUAL_REGULARISATION;
    return 1;
}

#endif

/* Primal-dual interior point (Mehrotra 1992, predictor and corrector) on the Riccati factorisation.
 *
 * Each side m of a bound has a distance t > 0 to it and a multiplier lambda > 0; a soft side adds a violation
 * v > 0 with multiplier sigma > 0 and cost soft_linear v + 1/2 soft_quadratic v^2. All of them are eliminated, so that
 * a Newton step is one Riccati sweep with a changed diagonal. Infeasible start; infeasibility is only reported with a
 * certificate (Farkas): multipliers that no point within the bounds can satisfy.
 */
#ifndef DRAWBAR_INTERIOR_POINT_H
#define DRAWBAR_INTERIOR_POINT_H

#include "active_set.h"

#define IP_ITERATIONS 60
#define FARKAS_MARGIN 1e1              /* infeasible unless a point lies this much further out than the iterate */
#define IP_TOLERANCE 1e-10                 /* on the duality measure and the residuals, relative */

struct interior_point {
    double t[AT_LEAST_ONE(NSIDES)], lambda[AT_LEAST_ONE(NSIDES)], v[AT_LEAST_ONE(NSIDES)], sigma[AT_LEAST_ONE(NSIDES)];
    double dt[AT_LEAST_ONE(NSIDES)], dlambda[AT_LEAST_ONE(NSIDES)], dv[AT_LEAST_ONE(NSIDES)],
        dsigma[AT_LEAST_ONE(NSIDES)];
    double gradient[NZ], defect[N][NX];
    double barrier[NZ], dz[NZ], dpi[(N + 1) * NX];
};

static inline int side_exists(const struct qp *s, int m)
{
    return m % 2 == 0 ? s->lower[m / 2] > -INFINITY : s->upper[m / 2] < INFINITY;
}

static inline int side_soft(const struct qp *s, int m)
{
    return s->soft_linear[m / 2] < INFINITY;
}

static inline double side_sign(int m)
{
    return m % 2 == 0 ? 1.0 : -1.0;
}

/* Start from the solution without bounds, with every distance pushed well inside. */
static double ip_start(const struct qp *s, struct interior_point *ip)
{
    double worst[NX + NU] = {0.0}, size[NX + NU] = {0.0}, mu = 0.0;
    int pairs = 0;

    for (int i = 0; i < NZ; ++i)
        size[kind_of(i)] = largest(size[kind_of(i)], s->z[i]);
    for (int m = 0; m < NSIDES; ++m) {
        const int kind = kind_of(s->bound[m / 2]);
        const double distance = side_exists(s, m) ? bound_distance(s, s->z, m) : 0.0;
        worst[kind] = largest(worst[kind], distance < 0.0 ? distance : 0.0);
        ip->t[m] = 1.0;
        ip->lambda[m] = ip->v[m] = ip->sigma[m] = 0.0;
    }
    for (int m = 0; m < NSIDES; ++m) {
        if (!side_exists(s, m))
            continue;
        const int i = s->bound[m / 2], kind = kind_of(i), u = i - (N + 1) * NX;
        const double distance = bound_distance(s, s->z, m), least = 1e-3 * size[kind] + 1e-12;
        const double margin = worst[kind] > least ? worst[kind] : least;
        const double curvature = u < 0 ? s->P[i / NX][i % NX][i % NX] : 1.0 / s->D[u / NU][u % NU];
        ip->t[m] = distance > margin ? distance : margin;
        ip->lambda[m] = margin * margin * (curvature > 1e-12 ? curvature : 1e-12) / ip->t[m];
        if (side_soft(s, m)) {             /* starts where its own multipliers add up to the violation's price */
            ip->lambda[m] = ip->lambda[m] < 0.5 * s->soft_linear[m / 2] ? ip->lambda[m] : 0.5 * s->soft_linear[m / 2];
            ip->v[m] = ip->lambda[m] * ip->t[m] / (s->soft_linear[m / 2] - ip->lambda[m]);
            ip->sigma[m] = s->soft_linear[m / 2] + s->soft_quadratic[m / 2] * ip->v[m] - ip->lambda[m];
            mu += ip->sigma[m] * ip->v[m];
            ++pairs;
        }
        mu += ip->lambda[m] * ip->t[m];
        ++pairs;
    }
    return pairs > 0 ? mu / pairs : 0.0;
}

/* One Newton step for the complementarity target tau, with `second` times Mehrotra's second-order term of the step
 * before; fresh: the barrier has changed and is factorised. */
static int ip_step(struct qp *s, struct interior_point *ip, double tau, double second, int fresh)
{
    double gradient[NZ], elastic[AT_LEAST_ONE(NSIDES)], constant[AT_LEAST_ONE(NSIDES)], inverse[AT_LEAST_ONE(NSIDES)];
    double pair[AT_LEAST_ONE(NSIDES)], soft_pair[AT_LEAST_ONE(NSIDES)], gap[AT_LEAST_ONE(NSIDES)];

    memcpy(gradient, ip->gradient, sizeof gradient);
    if (fresh)
        memset(ip->barrier, 0, sizeof ip->barrier);
    for (int m = 0; m < NSIDES; ++m) {
        if (!side_exists(s, m))
            continue;
        const int i = s->bound[m / 2];
        const double w = ip->lambda[m] / ip->t[m];
        gap[m] = bound_distance(s, s->z, m) + ip->v[m] - ip->t[m];
        pair[m] = tau - ip->t[m] * ip->lambda[m] - (second > 0.0 ? second * ip->dt[m] * ip->dlambda[m] : 0.0);
        elastic[m] = inverse[m] = soft_pair[m] = 0.0;
        if (side_soft(s, m)) {
            soft_pair[m] = tau - ip->v[m] * ip->sigma[m] - (second > 0.0 ? second * ip->dv[m] * ip->dsigma[m] : 0.0);
            const double dual = s->soft_linear[m / 2] + s->soft_quadratic[m / 2] * ip->v[m] - ip->lambda[m] - ip->sigma[m];
            inverse[m] = 1.0 / (s->soft_quadratic[m / 2] + w + ip->sigma[m] / ip->v[m]);
            elastic[m] = (pair[m] / ip->t[m] - w * gap[m] + soft_pair[m] / ip->v[m] - dual) * inverse[m];
        }
        constant[m] = pair[m] / ip->t[m] - w * (gap[m] + elastic[m]);
        gradient[i] -= side_sign(m) * (ip->lambda[m] + constant[m]);
        if (fresh)
            ip->barrier[i] += w * (1.0 - w * inverse[m]);
    }
    if (fresh && !qp_factor(s, ip->barrier))
        return 0;
    double initial[NX];
    for (int i = 0; i < NX; ++i)
        initial[i] = s->initial[i] - s->z[i];
    qp_solve(s, gradient, (const double (*)[NX])ip->defect, initial, ip->dz, ip->dpi);
    for (int m = 0; m < NSIDES; ++m) {
        if (!side_exists(s, m))
            continue;
        const double w = ip->lambda[m] / ip->t[m];
        const double move = side_sign(m) * ip->dz[s->bound[m / 2]];
        ip->dv[m] = elastic[m] - w * inverse[m] * move;
        ip->dt[m] = move + ip->dv[m] + gap[m];
        ip->dlambda[m] = (pair[m] - ip->lambda[m] * ip->dt[m]) / ip->t[m];
        ip->dsigma[m] = side_soft(s, m) ? (soft_pair[m] - ip->sigma[m] * ip->dv[m]) / ip->v[m] : 0.0;
    }
    return 1;
}

/* Largest step that keeps every distance and multiplier non-negative, at most 1. */
static double ip_longest(const struct qp *s, const struct interior_point *ip)
{
    double step = 1.0;
    for (int m = 0; m < NSIDES; ++m) {
        if (!side_exists(s, m))
            continue;
        if (ip->dt[m] * step < -ip->t[m])
            step = -ip->t[m] / ip->dt[m];
        if (ip->dlambda[m] * step < -ip->lambda[m])
            step = -ip->lambda[m] / ip->dlambda[m];
        if (!side_soft(s, m))
            continue;
        if (ip->dv[m] * step < -ip->v[m])
            step = -ip->v[m] / ip->dv[m];
        if (ip->dsigma[m] * step < -ip->sigma[m])
            step = -ip->sigma[m] / ip->dsigma[m];
    }
    return step;
}

/* Mean complementarity after a step of the given length. */
static double ip_measure(const struct qp *s, const struct interior_point *ip, double step)
{
    double sum = 0.0;
    int pairs = 0;
    for (int m = 0; m < NSIDES; ++m) {
        if (!side_exists(s, m))
            continue;
        sum += (ip->t[m] + step * ip->dt[m]) * (ip->lambda[m] + step * ip->dlambda[m]);
        ++pairs;
        if (side_soft(s, m)) {
            sum += (ip->v[m] + step * ip->dv[m]) * (ip->sigma[m] + step * ip->dsigma[m]);
            ++pairs;
        }
    }
    return pairs > 0 ? sum / pairs : 0.0;
}

/* Do the multipliers prove that the hard bounds and the dynamics exclude each other? */
static int ip_infeasible(const struct qp *s, const struct interior_point *ip)
{
    double gradient[NZ], defect[N][NX], value = 0.0, slack = 0.0, size[NX + NU] = {0.0};

    kkt_residual(s, s->z, s->pi, 0.0, gradient, defect);
    for (int i = 0; i < NZ; ++i)
        size[kind_of(i)] = largest(size[kind_of(i)], s->z[i]);
    for (int m = 0; m < NSIDES; ++m) {
        if (!side_exists(s, m) || side_soft(s, m))
            continue;
        const double bound = m % 2 == 0 ? s->lower[m / 2] : -s->upper[m / 2];
        gradient[s->bound[m / 2]] -= side_sign(m) * ip->lambda[m];
        value += ip->lambda[m] * bound;
    }
    if (!FREE_INITIAL)
        for (int i = 0; i < NX; ++i) {     /* pi_0 takes whatever value makes the first state's entry vanish */
            double pi_0 = 0.0;
            for (int j = 0; j < NX; ++j)
                pi_0 += (j < ND ? s->A[0][j][i] : (j == i ? 1.0 : 0.0)) * STATE(s->pi, 1)[j];
            value += (pi_0 + gradient[i]) * s->initial[i];
            gradient[i] = 0.0;
        }
    for (int k = 0; k < N; ++k)
        for (int i = 0; i < NX; ++i)
            value += STATE(s->pi, k + 1)[i] * s->c[k][i];
    for (int i = 0; i < NZ; ++i)
        slack += fabs(gradient[i]) * size[kind_of(i)];
    return FARKAS_MARGIN * slack < value;
}

static void ip_publish(struct qp *s, const struct interior_point *ip)
{
    for (int m = 0; m < NSIDES; ++m) {
        s->multiplier[m] = side_exists(s, m) ? ip->lambda[m] : 0.0;
        s->violation[m] = side_exists(s, m) && side_soft(s, m) ? ip->v[m] : 0.0;
    }
}

/* The best answer so far: near the limit of the arithmetic the next iterate may be worse. */
struct ip_answer {
    double kkt, z[NZ], pi[(N + 1) * NX], multiplier[AT_LEAST_ONE(NSIDES)], violation[AT_LEAST_ONE(NSIDES)];
};

static void ip_keep(const struct qp *s, struct ip_answer *best)
{
    best->kkt = s->kkt;
    memcpy(best->z, s->z, sizeof best->z);
    memcpy(best->pi, s->pi, sizeof best->pi);
    memcpy(best->multiplier, s->multiplier, sizeof best->multiplier);
    memcpy(best->violation, s->violation, sizeof best->violation);
}

static int ip_restore(struct qp *s, const struct ip_answer *best)
{
    s->kkt = best->kkt;
    memcpy(s->z, best->z, sizeof s->z);
    memcpy(s->pi, best->pi, sizeof s->pi);
    memcpy(s->multiplier, best->multiplier, sizeof s->multiplier);
    memcpy(s->violation, best->violation, sizeof s->violation);
    return SOLVED;
}

/* Solve with bounds, starting from s->z and s->pi as qp_solve left them without bounds. */
static int qp_interior_point(struct qp *s)
{
    struct interior_point ip ON_STACK;
    double mu = ip_start(s, &ip);
    double step = 1.0;
    struct ip_answer best ON_STACK = {.kkt = INFINITY};

    for (s->iterations = 1; s->iterations <= IP_ITERATIONS; ++s->iterations) {
        kkt_residual(s, s->z, s->pi, 1.0, ip.gradient, ip.defect);
        if (!ip_step(s, &ip, 0.0, 0.0, 1))
            return best.kkt <= CHECK_TOLERANCE ? ip_restore(s, &best) : ip_infeasible(s, &ip) ? INFEASIBLE : NOT_FINITE;
        const double last = step;
        step = ip_longest(s, &ip);
        const double affine = ip_measure(s, &ip, step);
        const double ratio = affine / mu;
        const int stalled = s->iterations % 5 == 0 && last < 0.7;   /* breaks the corrector's cycles */
        ip_step(s, &ip, stalled ? mu : ratio * ratio * ratio * mu, stalled ? 0.0 : step * step, 0);
        step = ip_longest(s, &ip);
        step = step < 1.0 ? 0.995 * step : 1.0;
        for (int i = 0; i < NZ; ++i)
            s->z[i] += step * ip.dz[i];
        for (int i = 0; i < (N + 1) * NX; ++i)
            s->pi[i] += step * ip.dpi[i];
        for (int m = 0; m < NSIDES; ++m) {
            if (!side_exists(s, m))
                continue;
            ip.t[m] += step * ip.dt[m];
            ip.lambda[m] += step * ip.dlambda[m];
            if (side_soft(s, m)) {
                ip.v[m] += step * ip.dv[m];
                ip.sigma[m] += step * ip.dsigma[m];
            }
        }
        for (int m = 0; m < NSIDES; ++m)
            ip.dt[m] = ip.dlambda[m] = ip.dv[m] = ip.dsigma[m] = 0.0;
        mu = ip_measure(s, &ip, 0.0);
        ip_publish(s, &ip);
        const int status = kkt_check(s, 1);
        if (status == NOT_FINITE)
            return best.kkt <= CHECK_TOLERANCE ? ip_restore(s, &best) : NOT_FINITE;
        if (s->kkt <= IP_TOLERANCE)
            return SOLVED;
        if (best.kkt <= CHECK_TOLERANCE && s->kkt >= 0.5 * best.kkt)
            return ip_restore(s, &best);
        if (status == SOLVED)
            ip_keep(s, &best);
        if (ip_infeasible(s, &ip))
            return INFEASIBLE;
    }
    return MAXIMUM_ITERATIONS;
}

/* One sweep (factored beforehand if s->factored) when no bound is active, the active set when few are, the interior
 * point otherwise; the answer is judged by kkt_check. */
static int qp_optimise(struct qp *s)
{
    int invalid = 0, violated = 0;

    s->iterations = 0;
    s->kkt = INFINITY;
    memset(s->multiplier, 0, sizeof s->multiplier);
    memset(s->violation, 0, sizeof s->violation);
    for (int i = 0; i < NB; ++i)
        invalid |= !(s->lower[i] <= s->upper[i]) | (s->bound[i] < 0) | (s->bound[i] >= NZ)
            | !(s->soft_linear[i] > 0.0) | !(s->soft_quadratic[i] >= 0.0) | !(s->soft_quadratic[i] < INFINITY);
    if (invalid)
        return BAD_INPUT;
    if (!s->factored && !qp_factor(s, NULL))
        return NOT_FINITE;
    s->factored = 1;
    qp_solve(s, s->g, (const double (*)[NX])s->c, s->initial, s->z, s->pi);
    for (int i = 0; i < NB; ++i) {
        const double value = s->z[s->bound[i]];
        violated |= (value < s->lower[i]) | (value > s->upper[i]);
    }
    if (!violated)
        return kkt_check(s, 0);
    if (qp_active_set(s)) {
        if (kkt_check(s, 1) == SOLVED)
            return SOLVED;
        memset(s->multiplier, 0, sizeof s->multiplier);
        qp_solve(s, s->g, (const double (*)[NX])s->c, s->initial, s->z, s->pi);
    }
    s->factored = 0;                       /* the barrier changes it */
    return qp_interior_point(s);
}

#endif

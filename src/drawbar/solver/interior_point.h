/* Primal-dual interior point (Mehrotra 1992, predictor and corrector) on the Riccati factorisation.
 *
 * Each side m of a bound has a distance t > 0 to it and a multiplier lambda > 0; a soft side adds a violation
 * v > 0 with multiplier sigma > 0 and cost soft_linear v + 1/2 soft_quadratic v^2. All of them are eliminated, so that
 * a Newton step is one Riccati sweep with a changed diagonal. Infeasible start; infeasibility is only reported with a
 * certificate (farkas.h).
 */
#ifndef DRAWBAR_INTERIOR_POINT_H
#define DRAWBAR_INTERIOR_POINT_H

#include "active_set.h"
#include "farkas.h"

#ifndef IP_ITERATIONS
#define IP_ITERATIONS 60                   /* a unit whose time is short says less */
#endif
#define IP_TOLERANCE 1e-12                 /* on the relative KKT residual */
#define BOUNDARY 0.995                     /* share of the way to the nearest boundary that a step may go */
#define CENTRING 0.3                       /* target of a step without the second-order term, of the measure */
#define FARKAS_EVERY 2                     /* iterations between two looks for a certificate */

/* Largest of many non-negative numbers. */
static double most(const double *restrict values)
{
    double top[BLOCK] = {0.0}, result = 0.0;

    for (int base = 0; base < 2 * NLOWER; base += BLOCK)
        for (int j = 0; j < BLOCK; ++j)
            top[j] = values[base + j] > top[j] ? values[base + j] : top[j];
    for (int j = 0; j < BLOCK; ++j)
        result = top[j] > result ? top[j] : result;
    return result;
}

/* Distances of the bounded variables from their bounds, and the reciprocals that both steps of an iteration share. */
static void ip_look(const struct qp *restrict s, struct interior_point *restrict ip)
{
    for (int i = 0; i < NB; ++i) {
        ip->distance[i] = ip->offset[i] + s->z[s->bound[i]];
        ip->distance[NLOWER + i] = ip->offset[NLOWER + i] - s->z[s->bound[i]];
    }
    for (int m = 0; m < 2 * NLOWER; ++m) {
        ip->per_t[m] = 1.0 / ip->t[m];
        ip->per_v[m] = 1.0 / (ip->v[m] + (1.0 - ip->soft[m]));
    }
}

static void ip_publish(struct qp *restrict s, const struct interior_point *restrict ip)
{
    for (int i = 0; i < NB; ++i) {
        s->multiplier[2 * i] = ip->lambda[i];
        s->multiplier[2 * i + 1] = ip->lambda[NLOWER + i];
        s->violation[2 * i] = ip->v[i];
        s->violation[2 * i + 1] = ip->v[NLOWER + i];
    }
}

/* Mean complementarity after a step of the given length. */
static double ip_measure(const struct interior_point *restrict ip, double step)
{
    double sum[BLOCK] = {0.0}, total = 0.0;

    for (int base = 0; base < 2 * NLOWER; base += BLOCK)
        for (int j = 0; j < BLOCK; ++j) {
            const int m = base + j;
            sum[j] += (ip->t[m] + step * ip->dt[m]) * (ip->lambda[m] + step * ip->dlambda[m])
                + (ip->v[m] + step * ip->dv[m]) * (ip->sigma[m] + step * ip->dsigma[m]);
        }
    for (int j = 0; j < BLOCK; ++j)
        total += sum[j];
    return total / ip->pairs;
}

/* Start from the solution without bounds, with every distance pushed well inside. */
static void ip_start(struct qp *restrict s, struct interior_point *restrict ip)
{
    double worst[NX + NU] = {0.0}, size[NX + NU] = {0.0};

    memset(ip, 0, sizeof *ip);
    for (int m = 0; m < 2 * NLOWER; ++m)
        ip->t[m] = ip->distance[m] = 1.0;
    for (int i = 0; i < NZ; ++i)
        size[kind_of(i)] = largest(size[kind_of(i)], s->z[i]);
    for (int m = 0; m < NSIDES; ++m) {
        const int slot = m % 2 * NLOWER + m / 2, kind = kind_of(s->bound[m / 2]);
        const double bound = m % 2 == 0 ? s->lower[m / 2] : s->upper[m / 2];
        if (!(fabs(bound) < INFINITY))
            continue;
        const double distance = bound_distance(s, s->z, m);
        ip->exists[slot] = 1.0;
        ip->offset[slot] = m % 2 == 0 ? -bound : bound;
        ip->pairs += 1.0;
        worst[kind] = largest(worst[kind], distance < 0.0 ? distance : 0.0);
    }
    for (int m = 0; m < NSIDES; ++m) {
        const int slot = m % 2 * NLOWER + m / 2, i = s->bound[m / 2], kind = kind_of(i), u = i - (N + 1) * NX;
        if (ip->exists[slot] == 0.0)
            continue;
        const double distance = bound_distance(s, s->z, m), least = 1e-3 * size[kind] + 1e-12;
        const double margin = worst[kind] > least ? worst[kind] : least, price = s->soft_linear[m / 2];
        const double curvature = u < 0 ? s->P[i / NX][i % NX][i % NX] : 1.0 / s->D[u / NU][u % NU];
        double lambda;
        ip->t[slot] = distance > margin ? distance : margin;
        lambda = margin * margin * (curvature > 1e-12 ? curvature : 1e-12) / ip->t[slot];
        if (price < INFINITY) {            /* starts where its own multipliers add up to the violation's price */
            lambda = lambda < 0.5 * price ? lambda : 0.5 * price;
            ip->soft[slot] = 1.0;
            ip->linear[slot] = price;
            ip->quadratic[slot] = s->soft_quadratic[m / 2];
            ip->v[slot] = lambda * ip->t[slot] / (price - lambda);
            ip->sigma[slot] = price + ip->quadratic[slot] * ip->v[slot] - lambda;
            ip->pairs += 1.0;
        }
        ip->lambda[slot] = lambda;
    }
    ip_publish(s, ip);
}

/* How many stages there are up to the last one with a bound: only they see the barrier. */
static int ip_stages(const struct qp *s)
{
    int stages = 0;

    for (int i = 0; i < NB; ++i) {
        const int at = s->bound[i], k = at < (N + 1) * NX ? at / NX : (at - (N + 1) * NX) / NU;
        stages = k < stages ? stages : k + 1;
    }
    return stages;
}

/* One Newton step for the complementarity target tau, with `second` times Mehrotra's second-order term of the step
 * before. The barrier is factorised in the first `stages`; 0: it has not changed. */
static int ip_step(struct qp *restrict s, struct interior_point *restrict ip, double tau, double second, int stages)
{
    double gradient[NZ], initial[NX];
    double gap[NSLOTS], pair[NSLOTS], soft_pair[NSLOTS], elastic[NSLOTS], give[NSLOTS], push[NSLOTS], weight[NSLOTS],
        move[NSLOTS] = {0.0};

    for (int m = 0; m < 2 * NLOWER; ++m) {
        const double exists = ip->exists[m], soft = ip->soft[m], w = ip->lambda[m] * ip->per_t[m];
        const double dual = soft * (ip->linear[m] + ip->quadratic[m] * ip->v[m] - ip->lambda[m] - ip->sigma[m]);
        const double inverse = soft / (ip->quadratic[m] + w + ip->sigma[m] * ip->per_v[m] + (1.0 - soft));
        gap[m] = exists * (ip->distance[m] + ip->v[m] - ip->t[m]);
        pair[m] = exists * (tau - ip->t[m] * ip->lambda[m] - second * ip->dt[m] * ip->dlambda[m]);
        soft_pair[m] = soft * (tau - ip->v[m] * ip->sigma[m] - second * ip->dv[m] * ip->dsigma[m]);
        elastic[m] = (pair[m] * ip->per_t[m] - w * gap[m] + soft_pair[m] * ip->per_v[m] - dual) * inverse;
        give[m] = w * inverse;
        push[m] = pair[m] * ip->per_t[m] - w * (gap[m] + elastic[m]);
        weight[m] = w * (1.0 - give[m]);
    }
    memcpy(gradient, ip->gradient, sizeof gradient);
    for (int i = 0; i < NB; ++i)
        gradient[s->bound[i]] -= push[i] - push[NLOWER + i];
    if (stages > 0) {
        memset(ip->barrier, 0, sizeof ip->barrier);
        for (int i = 0; i < NB; ++i)
            ip->barrier[s->bound[i]] += weight[i] + weight[NLOWER + i];
        if (!qp_factor(s, ip->barrier, stages))
            return 0;
    }
    for (int i = 0; i < NX; ++i)
        initial[i] = s->initial[i] - s->z[i];
    qp_solve(s, gradient, (const double (*)[NX])ip->defect, initial, ip->dz, ip->dpi);
    for (int i = 0; i < NB; ++i) {
        move[i] = ip->dz[s->bound[i]];
        move[NLOWER + i] = -move[i];
    }
    for (int m = 0; m < 2 * NLOWER; ++m) {
        const double exists = ip->exists[m], soft = ip->soft[m];
        const double dv = soft * (elastic[m] - give[m] * move[m]), dt = exists * (move[m] + dv + gap[m]);
        ip->dv[m] = dv;
        ip->dt[m] = dt;
        ip->dlambda[m] = (pair[m] - ip->lambda[m] * dt) * ip->per_t[m];
        ip->dsigma[m] = (soft_pair[m] - ip->sigma[m] * dv) * ip->per_v[m];
    }
    return 1;
}

/* Longest step, at most 1, that goes no more than `part` of the way to where a distance or multiplier is zero. */
static double ip_longest(const struct interior_point *restrict ip, double part)
{
    double share[NSLOTS];                  /* of its way to zero that a full step goes */

    for (int m = 0; m < 2 * NLOWER; ++m) {
        const double t = -ip->dt[m] * ip->per_t[m], v = -ip->dv[m] * ip->per_v[m];
        const double lambda = -ip->dlambda[m] / (ip->lambda[m] + (1.0 - ip->exists[m]));
        const double sigma = -ip->dsigma[m] / (ip->sigma[m] + (1.0 - ip->soft[m]));
        const double hard = t > lambda ? t : lambda, soft = v > sigma ? v : sigma;
        share[m] = hard > soft ? hard : soft;
    }
    const double largest_share = most(share);
    return largest_share > part ? part / largest_share : 1.0;
}

static void ip_move(struct qp *restrict s, struct interior_point *restrict ip, double step)
{
    for (int i = 0; i < NZ; ++i)
        s->z[i] += step * ip->dz[i];
    for (int i = 0; i < (N + 1) * NX; ++i)
        s->pi[i] += step * ip->dpi[i];
    for (int m = 0; m < 2 * NLOWER; ++m) {
        ip->t[m] += step * ip->dt[m];
        ip->lambda[m] += step * ip->dlambda[m];
        ip->v[m] += step * ip->dv[m];
        ip->sigma[m] += step * ip->dsigma[m];
    }
}

/* Do the multipliers' last steps prove that no point exists? Where none does the multipliers grow without end, along a
 * certificate, while the cost stands still: their growth is the purer certificate. */
static int ip_infeasible(const struct qp *s, const struct interior_point *ip)
{
    return farkas_proves(s, ip->dlambda, ip->dlambda + NLOWER);
}

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
static int qp_interior_point(struct qp *s, struct interior_point *ip)
{
    struct ip_answer *best = &ip->best;
    const int stages = ip_stages(s);

    ip_start(s, ip);
    best->kkt = INFINITY;
    if (kkt_check(s, 1, ip->gradient, ip->defect) == NOT_FINITE)
        return NOT_FINITE;
    for (s->iterations = 1; s->iterations <= IP_ITERATIONS; ++s->iterations) {
        const double mu = ip_measure(ip, 0.0);
        ip_look(s, ip);
        if (!ip_step(s, ip, 0.0, 0.0, stages))
            return best->kkt <= CHECK_TOLERANCE ? ip_restore(s, best) : ip_infeasible(s, ip) ? INFEASIBLE : NOT_FINITE;
        const double affine = ip_longest(ip, 1.0), ratio = ip_measure(ip, affine) / mu;
        ip_step(s, ip, ratio * ratio * ratio * mu, affine * affine, 0);
        double step = ip_longest(ip, BOUNDARY);
        if (!(ip_measure(ip, step) < mu)) {   /* the second-order term led astray, and would do so in a cycle */
            ip_step(s, ip, CENTRING * mu, 0.0, 0);
            step = ip_longest(ip, BOUNDARY);
        }
        ip_move(s, ip, step);
        ip_publish(s, ip);
        const int status = kkt_check(s, 1, ip->gradient, ip->defect);
        if (status == NOT_FINITE)
            return best->kkt <= CHECK_TOLERANCE ? ip_restore(s, best) : NOT_FINITE;
        if (s->kkt <= IP_TOLERANCE)
            return SOLVED;
        if (best->kkt <= CHECK_TOLERANCE && s->kkt >= 0.5 * best->kkt)
            return ip_restore(s, best);
        if (status == SOLVED)
            ip_keep(s, best);
        else if (s->iterations % FARKAS_EVERY == 0 && ip_infeasible(s, ip))
            return INFEASIBLE;
    }
    return best->kkt <= CHECK_TOLERANCE ? ip_restore(s, best) : MAXIMUM_ITERATIONS;
}

/* One sweep (factored beforehand if s->factored) when no bound is active, the active set when few are, the interior
 * point otherwise; the answer is judged by kkt_check. */
static int qp_optimise(struct qp *s, union bounds_work *work)
{
    double gradient[NZ], defect[N][NX];
    int invalid = !bounds_exist(s), violated = 0;

    s->iterations = 0;
    s->kkt = INFINITY;
    memset(s->multiplier, 0, sizeof s->multiplier);
    memset(s->violation, 0, sizeof s->violation);
    for (int i = 0; i < NB; ++i)
        invalid |= !(s->lower[i] <= s->upper[i]) | !(s->soft_linear[i] > 0.0) | !(s->soft_quadratic[i] >= 0.0)
            | !(s->soft_quadratic[i] < INFINITY);
    if (invalid)
        return BAD_INPUT;
    if (!s->factored && !qp_factor(s, NULL, N + 1))
        return NOT_FINITE;
    s->factored = 1;
    qp_solve(s, s->g, (const double (*)[NX])s->c, s->initial, s->z, s->pi);
    for (int i = 0; i < NB; ++i) {
        const double value = s->z[s->bound[i]];
        violated |= (value < s->lower[i]) | (value > s->upper[i]);
    }
    if (!violated)
        return kkt_check(s, 0, gradient, defect);
    if (qp_active_set(s, &work->active)) {
        if (kkt_check(s, 1, gradient, defect) == SOLVED)
            return SOLVED;
        memset(s->multiplier, 0, sizeof s->multiplier);
        qp_solve(s, s->g, (const double (*)[NX])s->c, s->initial, s->z, s->pi);
    }
    s->factored = 0;                       /* the barrier changes it */
    return qp_interior_point(s, &work->ip);
}

#endif

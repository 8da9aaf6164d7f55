/* Primal-dual interior point (Mehrotra 1992, predictor and corrector) on the Riccati factorisation.
 *
 * Each side m of a bound has a distance t > 0 to it and a multiplier lambda > 0; a soft side adds a violation
 * v > 0 with multiplier sigma > 0 and cost soft_linear v + 1/2 soft_quadratic v^2. All of them are eliminated, so that
 * a Newton step is one Riccati sweep with a changed diagonal. Infeasible start; infeasibility is only reported with a
 * certificate (farkas.h).
 */
#ifndef DRAWBAR_INTERIOR_POINT_H
#define DRAWBAR_INTERIOR_POINT_H

#include "noinline.h"
#include "farkas.h"
#include "ip_start.h"

#ifndef IP_ITERATIONS
#define IP_ITERATIONS 80                   /* a unit whose time is short says less */
#endif
#define IP_TOLERANCE 1e-12                 /* on the relative KKT residual */
#define BOUNDARY 0.995                     /* share of the way to the nearest boundary that a step may go */
#define CENTRING 0.3                       /* target of a step without the second-order term, of the measure */
#define ASTRAY 4                           /* times that the second-order term may lead away before it is left alone */
#define STALLED 2                          /* long steps one after the other that leave the residual as it was: rounding */
#define STALL_RATIO 0.9                    /* of the residual before */
#define LOOSE 1e-12                        /* how much bounds give way then, relative to the curvature, */
#define LOOSEN_BY 100.0                    /* each time more, */
#define LOOSEST 1e-5                       /* at most */
#define LOOSEN_OUTSIDE 1e-7                /* but only where bounds are violated by less: else there may be no point */
#define LEAST_DAMPING 1e-13                /* share of the curvature, before which damping is let be less */
#define SHORT_STEP 0.2                     /* a step less than this is short; */
#define SHORT_STEPS 3                      /* so many one after the other: distances and multipliers are too small */
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
    memcpy(ip->per_pair, ip->per_t, sizeof ip->per_pair);
    for (int m = 0; ip->loose > 0.0 && m < 2 * NLOWER; ++m)
        ip->per_pair[m] = 1.0 / (ip->t[m] + ip->loose * ip->ease[m] * ip->lambda[m]);
}

/* Mean complementarity after a step of the given length. */
static NOINLINE double ip_measure(const struct interior_point *restrict ip, double step)
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
    return ip->pairs > 0.0 ? total / ip->pairs : 0.0;
}

/* How many stages there are up to the last one with a bound: only there the barrier changes. */
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
        const double exists = ip->exists[m], soft = ip->soft[m], w = ip->lambda[m] * ip->per_pair[m];
        const double dual = soft * (ip->linear[m] + ip->quadratic[m] * ip->v[m] - ip->lambda[m] - ip->sigma[m]);
        const double inverse = soft / (ip->quadratic[m] + w + ip->sigma[m] * ip->per_v[m] + (1.0 - soft));
        gap[m] = exists * (ip->distance[m] + ip->v[m] - ip->t[m]);
        pair[m] = exists * (tau - ip->t[m] * ip->lambda[m] - second * ip->dt[m] * ip->dlambda[m]);
        soft_pair[m] = soft * (tau - ip->v[m] * ip->sigma[m] - second * ip->dv[m] * ip->dsigma[m]);
        elastic[m] = (pair[m] * ip->per_pair[m] - w * gap[m] + soft_pair[m] * ip->per_v[m] - dual) * inverse;
        give[m] = w * inverse;
        push[m] = pair[m] * ip->per_pair[m] - w * (gap[m] + elastic[m]);
        weight[m] = w * (1.0 - give[m]);
    }
    memcpy(gradient, ip->gradient, sizeof gradient);
    for (int i = 0; i < NB; ++i)
        gradient[s->bound[i]] -= push[i] - push[NLOWER + i];
    if (stages > 0) {
        ip_clear_barrier(ip);
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
        ip->dlambda[m] = (pair[m] - ip->lambda[m] * dt) * ip->per_pair[m];
        ip->dt[m] = dt;
        ip->dsigma[m] = (soft_pair[m] - ip->sigma[m] * dv) * ip->per_v[m];
    }
    for (int m = 0; ip->loose > 0.0 && m < 2 * NLOWER; ++m)
        ip->dt[m] += ip->loose * ip->ease[m] * ip->dlambda[m];
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

/* By how much do the multipliers' last steps prove that no point exists? Where none does the multipliers grow without end, along a
 * certificate, while the cost stands still: their growth is the purer certificate. */
static COLD double ip_infeasible(const struct qp *s, const struct interior_point *ip)
{
    return farkas_margin(s, ip->dlambda, ip->dlambda + NLOWER);
}

/* By how much hard bounds are violated, relative to the size of their kind of variable. */
static double ip_outside(const struct qp *s)
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

/* Where rounding in the factorisation stands in the way: let the bounds give way more within one step. */
static int ip_loosen(struct interior_point *ip)
{
    if (!(ip->loose < LOOSEST))
        return 0;
    ip->loose = ip->loose > 0.0 ? LOOSEN_BY * ip->loose : LOOSE;
    return 1;
}

static void ip_keep(const struct qp *s, struct ip_answer *best)
{
    best->kkt = s->kkt;
    memcpy(best->z, s->z, sizeof best->z);
    memcpy(best->pi, s->pi, sizeof best->pi);
    memcpy(best->multiplier, s->multiplier, sizeof best->multiplier);
    memcpy(best->violation, s->violation, sizeof best->violation);
}

static COLD int ip_restore(struct qp *s, const struct ip_answer *best)
{
    s->kkt = best->kkt;
    memcpy(s->z, best->z, sizeof s->z);
    memcpy(s->pi, best->pi, sizeof s->pi);
    memcpy(s->multiplier, best->multiplier, sizeof s->multiplier);
    memcpy(s->violation, best->violation, sizeof s->violation);
    return SOLVED;
}

/* Where it goes no further: the best answer if it is good enough, else the proof that there is none, else the reason. */
static COLD int ip_end(struct qp *s, struct interior_point *ip, int reason)
{
    if (ip->best.kkt <= CHECK_TOLERANCE)
        return ip_restore(s, &ip->best);
    return largest(ip->infeasible, ip_infeasible(s, ip)) > FARKAS_EXACT ? INFEASIBLE : reason;
}

/* A sweep towards the middle, without the second-order term. Returns the length of the step, or 0 where the
 * factorisation fails. */
static double ip_centre(struct qp *restrict s, struct interior_point *restrict ip, double mu, int stages)
{
    return ip_step(s, ip, CENTRING * mu, 0.0, stages) ? ip_longest(ip, BOUNDARY) : 0.0;
}

/* Predictor and corrector, likewise. */
static double ip_correct(struct qp *restrict s, struct interior_point *restrict ip, double mu, int stages)
{
    if (!ip_step(s, ip, 0.0, 0.0, stages))
        return 0.0;
    const double affine = ip_longest(ip, 1.0), ratio = mu > 0.0 ? ip_measure(ip, affine) / mu : 0.0;
    ip_step(s, ip, ratio * ratio * ratio * mu, affine * affine, 0);
    const double step = ip_longest(ip, BOUNDARY);
    if (ip_measure(ip, step) < mu)
        return step;
    ++ip->astray;                          /* the second-order term did it, and would do so in a cycle */
    return ip_centre(s, ip, mu, 0);
}

/* One iteration. Returns the length of its step, or 0 where the factorisation fails. */
static double ip_iterate(struct qp *restrict s, struct interior_point *restrict ip, int stages)
{
    ip_look(s, ip);
    const double mu = ip_measure(ip, 0.0);
    const double step = ip->astray < ASTRAY ? ip_correct(s, ip, mu, stages) : ip_centre(s, ip, mu, stages);
    if (step > 0.0) {
        ip_move(s, ip, step);
        ip_publish(s, ip);
    }
    return step;
}

/* Where short steps follow one another, distances and multipliers are far too small for what lies ahead: the first of them to
 * reach zero ends each step. Take them to be as large as a whole Newton step would make them. Returns 0 where the
 * factorisation fails. */
static COLD double ip_widen(struct qp *restrict s, struct interior_point *restrict ip, int stages)
{
    ip_look(s, ip);
    if (!ip_step(s, ip, 0.0, 0.0, stages))
        return 0.0;
    for (int m = 0; m < 2 * NLOWER; ++m) {
        ip->t[m] = largest(ip->t[m], ip->t[m] + ip->dt[m]);
        ip->lambda[m] = largest(ip->lambda[m], ip->lambda[m] + ip->dlambda[m]);
        ip->v[m] = largest(ip->v[m], ip->v[m] + ip->dv[m]);
        ip->sigma[m] = largest(ip->sigma[m], ip->sigma[m] + ip->dsigma[m]);
    }
    ip_publish(s, ip);
    ip->before = (double)INFINITY;
    return 1.0;
}

/* Where damping holds back what the cost determines, if only just, so that it is most of what is left: let it be less. */
static int ip_undamp(struct interior_point *ip)
{
    double damped = 0.0, left = 0.0;

    if (!(ip->damping.share > LEAST_DAMPING))
        return 0;
    for (int i = 0; i < NZ; ++i) {
        damped += ip->damping.share * ip->damping.weight[kind_of(i)] * ip->dz[i] * ip->dz[i];
        left += fabs(ip->gradient[i] * ip->dz[i]);
    }
    if (!(damped > 0.5 * left))
        return 0;
    ip->damping.share /= LOOSEN_BY;
    return 1;
}

/* Count short steps, and damp less or loosen where long ones no longer get anywhere. Returns whether all stages are to be
 * factorised again. */
static int ip_watch(const struct qp *restrict s, struct interior_point *restrict ip, double step)
{
    ip->short_steps = step < SHORT_STEP ? ip->short_steps + 1 : 0;
    ip->stalled = s->kkt > STALL_RATIO * ip->before && step > 0.5 ? ip->stalled + 1 : 0;
    ip->before = s->kkt < ip->before ? s->kkt : ip->before;
    if (ip->stalled < STALLED)
        return 0;
    const int undamped = ip_undamp(ip);
    if (undamped || (ip_outside(s) < LOOSEN_OUTSIDE && ip_loosen(ip)))
        ip->stalled = 0;
    return undamped;
}

/* Solve with bounds, starting from s->z and s->pi as qp_solve left them without bounds. *left: iterations that it may take. */
static int qp_interior_point(struct qp *s, struct interior_point *ip, int32_t *left)
{
    struct ip_answer *best = &ip->best;
    const int bounded = ip_stages(s);
    int stages = ip->damping.share > 0.0 ? N + 1 : bounded;

    if (*left <= 0)
        return MAXIMUM_ITERATIONS;
    const double near = ip_approach(s, ip, left);
    if (near == 0.0)
        return NOT_FINITE;
    ip_start(s, ip, near);
    best->kkt = ip->before = (double)INFINITY;
    if (kkt_check(s, 1, ip->gradient, ip->defect) == NOT_FINITE)
        return NOT_FINITE;
    for (s->iterations = 1; s->iterations <= IP_ITERATIONS && *left > 0; ++s->iterations) {
        --*left;
        const double step = ip->short_steps < SHORT_STEPS ? ip_iterate(s, ip, stages) : ip_widen(s, ip, stages);
        if (step == 0.0 && best->kkt > CHECK_TOLERANCE && ip_loosen(ip))
            continue;
        stages = bounded;
        const int status = step == 0.0 ? NOT_FINITE : kkt_check(s, 1, ip->gradient, ip->defect);
        if (status == NOT_FINITE)
            return ip_end(s, ip, NOT_FINITE);
        if (s->kkt <= IP_TOLERANCE)
            return SOLVED;
        if (best->kkt <= CHECK_TOLERANCE && s->kkt >= 0.5 * best->kkt)
            return ip_restore(s, best);
        if (ip_watch(s, ip, step)) {
            stages = N + 1;
            --*left;                       /* as it takes longer */
        }
        if (status == SOLVED)
            ip_keep(s, best);
        else if (s->iterations % FARKAS_EVERY == 0)
            ip->infeasible = largest(ip->infeasible, ip_infeasible(s, ip));
        if (ip->infeasible > FARKAS_FORGIVEN)
            return INFEASIBLE;
    }
    return ip_end(s, ip, MAXIMUM_ITERATIONS);
}

#endif

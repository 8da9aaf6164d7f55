/* Interior point: primal-dual, with predictor and corrector (Mehrotra 1992), on the Riccati factorisation.
 *
 * Each side m of a bound has a slack t > 0 and a multiplier lambda > 0; a soft side adds a violation
 * v > 0 with multiplier sigma > 0 and cost soft_linear v + 1/2 soft_quadratic v^2. All of them are eliminated, so that
 * a Newton step is one Riccati sweep with a changed diagonal. Infeasible start; infeasibility is only reported with a
 * certificate (farkas.h).
 */
#ifndef DRAWBAR_INTERIOR_POINT_H
#define DRAWBAR_INTERIOR_POINT_H

#include "farkas.h"
#include "ip_start.h"
#include "ip_step.h"
#include "noinline.h"

#ifndef IP_ITERATIONS
#define IP_ITERATIONS 80                   /* a unit whose time is short says less */
#endif
#define IP_TOLERANCE 1e-12                 /* on the relative KKT residual */
#define STALLED 2                          /* long steps one after the other that leave the residual as it was: rounding */
#define STALL_RATIO 0.9                    /* of the least residual so far */
#define REGULARISED_VIOLATION 1e-7         /* of bounds, above which dual regularisation is not raised: there may be no point */
#define SHORT_STEP 0.2                     /* a step less than this is short; */
#define SHORT_STEPS 3                      /* so many one after the other: slacks and multipliers are too small */
#define FARKAS_EVERY 2                     /* iterations between two looks for a certificate */

/* How many stages there are up to the last one with a bound: only there the barrier changes. */
static int ip_bounded_stages(const struct qp *s)
{
    int stages = 0;

    for (int i = 0; i < NB; ++i) {
        const int at = s->bound[i], k = at < (N + 1) * NX ? at / NX : (at - (N + 1) * NX) / NU;
        stages = k < stages ? stages : k + 1;
    }
    return stages;
}

/* Margin of the certificate that the multipliers' last steps are: where no feasible point exists the multipliers diverge along a
 * certificate, and their steps come nearer to it than they do. */
static COLD double ip_farkas_margin(const struct qp *s, const struct interior_point *ip)
{
    return farkas_margin(s, ip->dlambda, ip->dlambda + NLOWER);
}

static void ip_save_iterate(const struct qp *s, struct ip_iterate *best)
{
    best->kkt = s->kkt;
    memcpy(best->z, s->z, sizeof best->z);
    memcpy(best->pi, s->pi, sizeof best->pi);
    memcpy(best->multiplier, s->multiplier, sizeof best->multiplier);
    memcpy(best->violation, s->violation, sizeof best->violation);
}

static COLD int ip_restore_iterate(struct qp *s, const struct ip_iterate *best)
{
    s->kkt = best->kkt;
    memcpy(s->z, best->z, sizeof s->z);
    memcpy(s->pi, best->pi, sizeof s->pi);
    memcpy(s->multiplier, best->multiplier, sizeof s->multiplier);
    memcpy(s->violation, best->violation, sizeof s->violation);
    return SOLVED;
}

/* Status where no further step is taken: SOLVED by the best iterate if that is good enough, else INFEASIBLE with proof, else the
 * reason. */
static COLD int ip_end(struct qp *s, struct interior_point *ip, int reason)
{
    if (ip->best.kkt <= CHECK_TOLERANCE)
        return ip_restore_iterate(s, &ip->best);
    return largest(ip->farkas_margin, ip_farkas_margin(s, ip)) > FARKAS_EXACT ? INFEASIBLE : reason;
}

/* One step, taken. Returns its length, or 0 where the factorisation fails. */
static double ip_advance(struct qp *restrict s, struct interior_point *restrict ip, int stages)
{
    ip_evaluate_bounds(s, ip);
    const double mu = ip_duality_measure(ip, 0.0);
    const double step = ip->rejected_correctors < CORRECTOR_REJECTIONS
        ? ip_predictor_corrector_step(s, ip, mu, stages)
        : ip_centring_step(s, ip, mu, stages);
    if (step > 0.0) {
        ip_take_step(s, ip, step);
        ip_write_multipliers(s, ip);
    }
    return step;
}

/* Where short steps follow one another, slacks and multipliers are far too small: the first of them to reach zero ends each
 * step. Make them as large as a whole Newton step would. Returns 0 where the factorisation fails. */
static COLD double ip_enlarge_iterate(struct qp *restrict s, struct interior_point *restrict ip, int stages)
{
    ip_evaluate_bounds(s, ip);
    if (!ip_newton_step(s, ip, 0.0, 0.0, stages))
        return 0.0;
    for (int m = 0; m < 2 * NLOWER; ++m) {
        ip->t[m] = largest(ip->t[m], ip->t[m] + ip->dt[m]);
        ip->lambda[m] = largest(ip->lambda[m], ip->lambda[m] + ip->dlambda[m]);
        ip->v[m] = largest(ip->v[m], ip->v[m] + ip->dv[m]);
        ip->sigma[m] = largest(ip->sigma[m], ip->sigma[m] + ip->dsigma[m]);
    }
    ip_write_multipliers(s, ip);
    ip->least_kkt = (double)INFINITY;
    return 1.0;
}

/* Count short steps, and change the regularisation where long ones no longer lower the residual. Returns whether all stages are
 * to be factorised again. */
static int ip_check_progress(const struct qp *restrict s, struct interior_point *restrict ip, double step)
{
    ip->short_steps = step < SHORT_STEP ? ip->short_steps + 1 : 0;
    ip->stalled_steps = s->kkt > STALL_RATIO * ip->least_kkt && step > 0.5 ? ip->stalled_steps + 1 : 0;
    ip->least_kkt = s->kkt < ip->least_kkt ? s->kkt : ip->least_kkt;
    if (ip->stalled_steps < STALLED)
        return 0;
    const int lowered = ip_lower_primal_regularisation(ip);
    if (lowered || (ip_bound_violation(s) < REGULARISED_VIOLATION && ip_raise_dual_regularisation(ip)))
        ip->stalled_steps = 0;
    return lowered;
}

/* Solve with bounds, starting from s->z and s->pi as qp_solve left them without bounds. *left: iterations that it may take.
 * Returns a solver status. */
static int qp_interior_point(struct qp *s, struct interior_point *ip, int32_t *left)
{
    struct ip_iterate *best = &ip->best;
    const int bounded = ip_bounded_stages(s);
    int stages = ip->primal_regularisation.share > 0.0 ? N + 1 : bounded;

    if (*left <= 0)
        return MAXIMUM_ITERATIONS;
    const double nearest = ip_starting_point(s, ip, left);
    if (nearest == 0.0)
        return NOT_FINITE;
    ip_start(s, ip, nearest);
    best->kkt = ip->least_kkt = (double)INFINITY;
    if (kkt_check(s, 1, ip->gradient, ip->defect) == NOT_FINITE)
        return NOT_FINITE;
    for (s->iterations = 1; s->iterations <= IP_ITERATIONS && *left > 0; ++s->iterations) {
        --*left;
        const double step = ip->short_steps < SHORT_STEPS ? ip_advance(s, ip, stages) : ip_enlarge_iterate(s, ip, stages);
        if (step == 0.0 && best->kkt > CHECK_TOLERANCE && ip_raise_dual_regularisation(ip))
            continue;
        stages = bounded;
        const int status = step == 0.0 ? NOT_FINITE : kkt_check(s, 1, ip->gradient, ip->defect);
        if (status == NOT_FINITE)
            return ip_end(s, ip, NOT_FINITE);
        if (s->kkt <= IP_TOLERANCE)
            return SOLVED;
        if (best->kkt <= CHECK_TOLERANCE && s->kkt >= 0.5 * best->kkt)
            return ip_restore_iterate(s, best);
        if (ip_check_progress(s, ip, step)) {
            stages = N + 1;
            --*left;                       /* as it takes longer */
        }
        if (status == SOLVED)
            ip_save_iterate(s, best);
        else if (s->iterations % FARKAS_EVERY == 0)
            ip->farkas_margin = largest(ip->farkas_margin, ip_farkas_margin(s, ip));
        if (ip->farkas_margin > FARKAS_FORGIVEN)
            return INFEASIBLE;
    }
    return ip_end(s, ip, MAXIMUM_ITERATIONS);
}

#endif

/* Interior-point step: Newton step with slacks, violations and their multipliers eliminated, and how far to take it. */
#ifndef DRAWBAR_IP_STEP_H
#define DRAWBAR_IP_STEP_H

#include "ip_regularisation.h"
#include "noinline.h"

#define FRACTION_TO_BOUNDARY 0.995         /* of the way to the nearest boundary, that a step may go */
#define CENTRING 0.3                       /* centring parameter of a step without the second-order term */
#define CORRECTOR_REJECTIONS 4             /* of one solution, after which all steps are centring steps */

/* Largest of a number for each slot, none negative; 0 at least. */
static double largest_entry(const double *restrict values)
{
    double top[BLOCK] = {0.0}, result = 0.0;

    for (int base = 0; base < 2 * NLOWER; base += BLOCK)
        for (int j = 0; j < BLOCK; ++j)
            top[j] = values[base + j] > top[j] ? values[base + j] : top[j];
    for (int j = 0; j < BLOCK; ++j)
        result = top[j] > result ? top[j] : result;
    return result;
}

/* Distances of the bounded variables from their bounds, and the reciprocals that the Newton steps of an iteration share. */
static void ip_evaluate_bounds(const struct qp *restrict s, struct interior_point *restrict ip)
{
    for (int i = 0; i < NB; ++i) {
        ip->distance[i] = ip->offset[i] + s->z[s->bound[i]];
        ip->distance[NLOWER + i] = ip->offset[NLOWER + i] - s->z[s->bound[i]];
    }
    for (int m = 0; m < 2 * NLOWER; ++m) {
        ip->t_inverse[m] = 1.0 / ip->t[m];
        ip->v_inverse[m] = 1.0 / (ip->v[m] + (1.0 - ip->soft[m]));
    }
    memcpy(ip->pair_inverse, ip->t_inverse, sizeof ip->pair_inverse);
    for (int m = 0; ip->dual_regularisation > 0.0 && m < 2 * NLOWER; ++m)
        ip->pair_inverse[m] = 1.0 / (ip->t[m] + ip->dual_regularisation * ip->reciprocal_curvature[m] * ip->lambda[m]);
}

/* Duality measure mu (mean complementarity) after a step of the given length. */
static NOINLINE double ip_duality_measure(const struct interior_point *restrict ip, double step)
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

/* Newton step for the complementarity target tau, with `second` times Mehrotra's second-order term of the step before. The
 * first `stages` are factorised; 0: the barrier has not changed. Returns 0 where the factorisation fails. */
static int ip_newton_step(struct qp *restrict s, struct interior_point *restrict ip, double tau, double second, int stages)
{
    double gradient[NZ], initial[NX];
    double primal[NSLOTS], complementarity[NSLOTS], soft_complementarity[NSLOTS];   /* residuals */
    double dv_offset[NSLOTS], dv_gain[NSLOTS];       /* dv = offset - gain inward */
    double reduced[NSLOTS], weight[NSLOTS];          /* what a side adds to the right-hand side, and to the diagonal */
    double inward[NSLOTS] = {0.0};                   /* step of the variable, away from the bound */

    for (int m = 0; m < 2 * NLOWER; ++m) {
        const double exists = ip->exists[m], soft = ip->soft[m], w = ip->lambda[m] * ip->pair_inverse[m];
        const double dual = soft * (ip->linear[m] + ip->quadratic[m] * ip->v[m] - ip->lambda[m] - ip->sigma[m]);
        const double inverse = soft / (ip->quadratic[m] + w + ip->sigma[m] * ip->v_inverse[m] + (1.0 - soft));
        primal[m] = exists * (ip->distance[m] + ip->v[m] - ip->t[m]);
        complementarity[m] = exists * (tau - ip->t[m] * ip->lambda[m] - second * ip->dt[m] * ip->dlambda[m]);
        soft_complementarity[m] = soft * (tau - ip->v[m] * ip->sigma[m] - second * ip->dv[m] * ip->dsigma[m]);
        dv_offset[m] = (complementarity[m] * ip->pair_inverse[m] - w * primal[m]
            + soft_complementarity[m] * ip->v_inverse[m] - dual) * inverse;
        dv_gain[m] = w * inverse;
        reduced[m] = complementarity[m] * ip->pair_inverse[m] - w * (primal[m] + dv_offset[m]);
        weight[m] = w * (1.0 - dv_gain[m]);
    }
    memcpy(gradient, ip->gradient, sizeof gradient);
    for (int i = 0; i < NB; ++i)
        gradient[s->bound[i]] -= reduced[i] - reduced[NLOWER + i];
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
        inward[i] = ip->dz[s->bound[i]];
        inward[NLOWER + i] = -inward[i];
    }
    for (int m = 0; m < 2 * NLOWER; ++m) {
        const double exists = ip->exists[m], soft = ip->soft[m];
        const double dv = soft * (dv_offset[m] - dv_gain[m] * inward[m]), dt = exists * (inward[m] + dv + primal[m]);
        ip->dv[m] = dv;
        ip->dlambda[m] = (complementarity[m] - ip->lambda[m] * dt) * ip->pair_inverse[m];
        ip->dt[m] = dt;
        ip->dsigma[m] = (soft_complementarity[m] - ip->sigma[m] * dv) * ip->v_inverse[m];
    }
    for (int m = 0; ip->dual_regularisation > 0.0 && m < 2 * NLOWER; ++m)
        ip->dt[m] += ip->dual_regularisation * ip->reciprocal_curvature[m] * ip->dlambda[m];
    return 1;
}

/* Step length, at most 1, that goes no more than `fraction` of the way to where a slack or multiplier is zero. */
static double ip_step_length(const struct interior_point *restrict ip, double fraction)
{
    double share[NSLOTS];                  /* of its way to zero that a full step goes */

    for (int m = 0; m < 2 * NLOWER; ++m) {
        const double t = -ip->dt[m] * ip->t_inverse[m], v = -ip->dv[m] * ip->v_inverse[m];
        const double lambda = -ip->dlambda[m] / (ip->lambda[m] + (1.0 - ip->exists[m]));
        const double sigma = -ip->dsigma[m] / (ip->sigma[m] + (1.0 - ip->soft[m]));
        const double hard = t > lambda ? t : lambda, soft = v > sigma ? v : sigma;
        share[m] = hard > soft ? hard : soft;
    }
    const double largest_share = largest_entry(share);
    return largest_share > fraction ? fraction / largest_share : 1.0;
}

static void ip_take_step(struct qp *restrict s, struct interior_point *restrict ip, double step)
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

/* Centring step, without the second-order term. Returns its length, or 0 where the factorisation fails. */
static double ip_centring_step(struct qp *restrict s, struct interior_point *restrict ip, double mu, int stages)
{
    return ip_newton_step(s, ip, CENTRING * mu, 0.0, stages) ? ip_step_length(ip, FRACTION_TO_BOUNDARY) : 0.0;
}

/* Mehrotra's predictor and corrector, or a centring step where these would not lower mu. Returns likewise. */
static double ip_predictor_corrector_step(struct qp *restrict s, struct interior_point *restrict ip, double mu, int stages)
{
    if (!ip_newton_step(s, ip, 0.0, 0.0, stages))
        return 0.0;
    const double affine = ip_step_length(ip, 1.0), ratio = mu > 0.0 ? ip_duality_measure(ip, affine) / mu : 0.0;
    ip_newton_step(s, ip, ratio * ratio * ratio * mu, affine * affine, 0);
    const double step = ip_step_length(ip, FRACTION_TO_BOUNDARY);
    if (ip_duality_measure(ip, step) < mu)
        return step;
    ++ip->rejected_correctors;             /* its second-order term is to blame, and can lead to an endless cycle */
    return ip_centring_step(s, ip, mu, 0);
}

#endif

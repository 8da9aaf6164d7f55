/* Real-time iteration (Diehl, Bock, Schloeder 2005): one Gauss-Newton step per sample on the multiple-shooting
 * problem, split in what can be done before the newest state is known (prepare) and after (feedback).
 *
 *     min  sum_k || h(x_k, u_k, p_k) - y_k ||^2_{W_k}   (+ || R (x_0 - prior) ||^2 when the first state is free)
 *     s.t. x_{k+1} = F(x_k, u_k, p_k), bounds
 *
 * The generated part of the unit defines NP, NY and the functions dynamics, hessian, gradient and
 * rti_constants, which evaluate all stages in SIMD lanes. Half of the sum of squares is what the QP sees.
 */
#ifndef DRAWBAR_RTI_H
#define DRAWBAR_RTI_H

#include "interior_point.h"
#include "lanes.h"

struct rti {
    double z[NZ];                          /* the trajectory: linearisation point before, solution after a step */
    double p[N + 1][AT_LEAST_ONE(NP)];     /* known parameters of each stage */
    double y[N + 1][NY], w[N + 1][NY];     /* references or measurements (NaN: missing), and their weights */
    double initial[NX];                    /* current state (control) */
    double lower[AT_LEAST_ONE(NB)], upper[AT_LEAST_ONE(NB)];
    double root[NX][NX], prior[NX];        /* arrival cost (estimation): R, and what the first state should be */
    double process[NX];                    /* process noise per sample (standard deviation), for the arrival cost */
    int32_t status, open_end;              /* open_end: x_N is still to be predicted */
    double ym[N + 1][NY], wm[N + 1][NY];   /* with missing measurements masked: y = 0, w = 0 */
    double F[N][NX], h[1][NY], J[1][NY][NX + NU];
    struct qp qp;
};

static void rti_constants(struct rti *work);
static void dynamics(struct rti *work, int first, int count);
static void hessian(struct rti *work, int first, int count);
static void gradient(struct rti *work, int first, int count);

/* Apply y's gaps to y and w. Returns 1 when the weights differ from those of the last call. */
static int rti_mask(struct rti *s)
{
    const double *y = &s->y[0][0], *w = &s->w[0][0];
    double *ym = &s->ym[0][0], *wm = &s->wm[0][0];
    int changed = 0;

    for (int i = 0; i < (N + 1) * NY; ++i) {
        const int missing = isnan(y[i]) != 0;
        const double weight = missing ? 0.0 : w[i];
        changed |= weight != wm[i];
        ym[i] = missing ? 0.0 : y[i];
        wm[i] = weight;
    }
    return changed;
}

static void rti_hessian(struct rti *s)
{
#if FREE_INITIAL
    memset(s->qp.Q[0], 0, sizeof s->qp.Q[0]);
    hessian(s, 0, N + 1);
    for (int i = 0; i < NX; ++i)
        for (int m = 0; m <= i; ++m)
            for (int j = 0; j < NX; ++j)
                s->qp.Q[0][i][j] += s->root[m][i] * s->root[m][j];
#else
    hessian(s, 0, N + 1);
#endif
    s->qp.factored = 0;
}

/* The preparation phase: linearise along the trajectory, factorise for complete measurements as far as known. */
static int rti_prepare(struct rti *s)
{
    dynamics(s, 0, N);
    if (s->open_end)
        memcpy(STATE(s->z, N), s->F[N - 1], sizeof s->F[N - 1]);
    s->open_end = 0;
    for (int k = 0; k < N; ++k)
        for (int i = 0; i < NX; ++i)
            s->qp.c[k][i] = s->F[k][i] - STATE(s->z, k + 1)[i];
    rti_mask(s);
    rti_hessian(s);
    s->qp.factored = qp_factor(&s->qp, NULL);
    return s->status = s->qp.factored ? SOLVED : NOT_FINITE;
}

static int rti_inputs_valid(const struct rti *s)
{
    return bounds_exist(&s->qp) && all_finite(&s->p[0][0], (N + 1) * NP) && all_finite(&s->ym[0][0], (N + 1) * NY)
        && (FREE_INITIAL ? all_finite(s->prior, NX) : all_finite(s->initial, NX) && all_finite(&s->y[0][0], (N + 1) * NY));
}

/* The feedback phase: the newest state, references and measurements enter; the trajectory moves by a full step, or
 * stays as it is when the step does not pass the check. */
static int rti_feedback(struct rti *s)
{
    const int changed = rti_mask(s);

    if (!rti_inputs_valid(s))
        return s->status = BAD_INPUT;
    if (changed)
        rti_hessian(s);
#if FREE_INITIAL                           /* entries that no output sees are not written by gradient */
    memset(STATE(s->qp.g, 0), 0, NX * sizeof(double));
#endif
    gradient(s, 0, N + 1);
#if FREE_INITIAL
    for (int m = 0; m < NX; ++m) {
        double residual = 0.0;
        for (int j = m; j < NX; ++j)
            residual += s->root[m][j] * (s->z[j] - s->prior[j]);
        for (int i = m; i < NX; ++i)
            s->qp.g[i] += s->root[m][i] * residual;
    }
#else
    for (int i = 0; i < NX; ++i)
        s->qp.initial[i] = s->initial[i] - s->z[i];
#endif
    for (int i = 0; i < NB; ++i) {
        s->qp.lower[i] = s->lower[i] - s->z[s->qp.bound[i]];
        s->qp.upper[i] = s->upper[i] - s->z[s->qp.bound[i]];
    }
    s->qp.status = qp_optimise(&s->qp);
    for (int i = 0; i < NZ && s->qp.status == SOLVED; ++i)
        s->z[i] += s->qp.z[i];
    return s->status = s->qp.status;
}

/* Move the trajectory and the data on by one sample; the last stage is repeated and x_N predicted by prepare. The
 * weights belong to the place in the window, not to the sample, and stay. */
static void rti_shift(struct rti *s)
{
    memmove(STATE(s->z, 0), STATE(s->z, 1), N * NX * sizeof(double));
    memmove(INPUT(s->z, 0), INPUT(s->z, 1), (N - 1) * NU * sizeof(double));
    memmove(s->p[0], s->p[1], N * sizeof s->p[0]);
    memmove(s->y[0], s->y[1], N * sizeof s->y[0]);
    s->open_end = 1;
}

#endif

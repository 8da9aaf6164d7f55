/* Real-time iteration (Diehl, Bock, Schloeder 2005): one Gauss-Newton step per sample on the multiple-shooting
 * problem, split in what can be done before the newest state is known (prepare) and after (feedback).
 *
 *     min  sum_k || h(x_k, u_k, p_k) - y_k ||^2_{W_k}   (+ || R (x_0 - prior) ||^2 when the first state is free)
 *     s.t. x_{k+1} = F(x_k, u_k, p_k), bounds
 *
 * The generated part of the unit defines NP, NY, CONSTANTS and the functions dynamics, hessian and gradient, which
 * evaluate all stages in SIMD lanes, and rti_constants, which lays down what no stage changes, once the constants are
 * set. Half of the sum of squares is what the QP sees.
 */
#ifndef DRAWBAR_RTI_H
#define DRAWBAR_RTI_H

#include "noinline.h"
#include "lanes.h"
#include "optimise.h"

struct rti {
    double z[NZ];                          /* the trajectory: linearisation point before, solution after a step */
    double p[N + 1][AT_LEAST_ONE(NP)];     /* known parameters of each stage */
    double y[N + 1][NY], w[N + 1][NY];     /* references or measurements (NaN: missing), and their weights */
    double initial[NX];                    /* current state (control) */
    double lower[AT_LEAST_ONE(NB)], upper[AT_LEAST_ONE(NB)];
    double root[NX][NX], prior[NX];        /* arrival cost (estimation): R, and what the first state should be */
    double process[NX], common[NX];        /* process noise per sample (standard deviations), for the arrival cost: of
                                            * each state alone, and of one noise that moves all of them at once */
    int32_t status, open_end;              /* open_end: x_N is still to be predicted */
    int32_t linearised;                    /* as it will be after the next shift, and the stage that leaves behind it */
    int32_t valid_weights;                 /* whether the weights that the Hessian is made of are zero or more */
    uint8_t missing[(N + 1) * NY];         /* measurements, as rti_note_missing last saw them */
    struct qp qp;
    double constants[CONSTANTS];           /* of the model, and the sample time, s */
};

#ifndef INTERVALS
#define INTERVALS 1                        /* shooting intervals in a sample; the inputs of its first are applied */
#endif
#define SMALL_STEP 1e-3                    /* of the largest in the trajectory */
#define WORK union bounds_work             /* scratch memory of a feedback, see workspace.h */

#if LEAVING                                /* where the linearisation of stage k has its place */
#define PLACE(work, k) ((k) < (work)->linearised ? N : (k) - (work)->linearised)
#else
#define PLACE(work, k) (k)
#endif

static void rti_constants(struct rti *work);
static void dynamics(struct rti *work, int first, int count);   /* qp.A, qp.B, and F in the place of qp.c */
static void hessian(struct rti *work, int first, int count);
static void gradient(struct rti *work, int first, int count);

/* Whether a measurement is missing; a reference never is. */
static inline int rti_is_missing(const struct rti *s, int k, int i)
{
    return FREE_INITIAL && isnan(s->y[k][i]);
}

/* A missing measurement counts as zero, with a weight of zero. */
static inline double rti_target(const struct rti *s, int k, int i)
{
    return rti_is_missing(s, k, i) ? 0.0 : s->y[k][i];
}

static inline double rti_weight(const struct rti *s, int k, int i)
{
    return rti_is_missing(s, k, i) ? 0.0 : s->w[k][i];
}

/* Note what is missing. Returns 1 when it was something else at the last call. */
static int rti_note_missing(struct rti *s)
{
    const double *y = &s->y[0][0];
    int changed = 0;

    /* a controller has no measurements, but its first mark notes changed weights */
    for (int i = 0; i < (FREE_INITIAL ? (N + 1) * NY : 1); ++i) {
        const uint8_t now = (uint8_t)(FREE_INITIAL && isnan(y[i]));
        changed |= now != s->missing[i];
        s->missing[i] = now;
    }
    return changed;
}

/* Weights have changed: let the next feedback make the Hessian anew. */
static inline void rti_reweighted(struct rti *s)
{
    s->missing[0] = 2;                     /* neither missing nor there, so that something has changed */
}

/* Whether every weight is zero or more: a problem with others may have no optimum. */
static int rti_weights_valid(const struct rti *s)
{
    const double *w = &s->w[0][0];
    int negative = 0;

    for (int i = 0; i < (N + 1) * NY; ++i)
        negative |= !(w[i] >= 0.0);
    return !negative;
}

static void rti_hessian(struct rti *s)
{
    s->valid_weights = rti_weights_valid(s);
#if FREE_INITIAL
    memset(s->qp.Q[0], 0, sizeof s->qp.Q[0]);
    hessian(s, 0, N + 1);
    for (int i = 0; i < NX; ++i) {
        pack sum[PACKS], root[PACKS];
        read_row(sum, s->qp.Q[0][i]);
        for (int m = 0; m <= i; ++m) {
            read_vector(root, s->root[m]);
            EACH_PACK(b)
                sum[b] += s->root[m][i] * root[b];
        }
        write_row(s->qp.Q[0][i], sum);
    }
#else
    hessian(s, 0, N + 1);
#endif
    s->qp.factored = 0;
}

/* Linearise along the trajectory. */
static void rti_linearise(struct rti *s)
{
    const double *reached = STATE(s->z, 1);
    double *c = &s->qp.c[0][0];

    if (!s->linearised)
        dynamics(s, 0, N);
    s->linearised = 0;
    if (s->open_end)
        memcpy(STATE(s->z, N), s->qp.c[N - 1], sizeof s->qp.c[N - 1]);
    s->open_end = 0;
    for (int i = 0; i < N * NX; ++i)
        c[i] -= reached[i];
}

/* The preparation phase: linearise, factorise for complete measurements as far as known, and for the bounds that are kept. */
static int rti_prepare(struct rti *s)
{
    rti_linearise(s);
    rti_note_missing(s);
    rti_hessian(s);
    if (!s->valid_weights)
        return s->status = BAD_INPUT;
    if (!FREE_INITIAL && pn_factor(&s->qp))
        s->qp.factored = FACTORED_KEPT;
    else
        s->qp.factored = qp_factor(&s->qp, NULL, N + 1);
    return s->status = s->qp.factored ? SOLVED : NOT_FINITE;
}

/* Whether no number is beyond what can be computed with. A NaN passes where it is a missing value. */
static int rti_within(const double *values, size_t count, int may_be_missing)
{
    int beyond = 0;

    for (size_t i = 0; i < count; ++i)
        beyond |= fabs(values[i]) > LARGEST_INPUT || (!may_be_missing && isnan(values[i]));
    return !beyond;
}

static int rti_inputs_valid(const struct rti *s)
{
    return rti_within(&s->y[0][0], (N + 1) * NY, FREE_INITIAL) && bounds_exist(&s->qp)
        && rti_within(&s->p[0][0], (N + 1) * NP, 0) && (FREE_INITIAL ? all_finite(s->prior, NX) : rti_within(s->initial, NX, 0));
}

/* The gradient of half the sum of squares along the trajectory, and the way that is left to the given first state. */
static void rti_gradient(struct rti *s)
{
#if FREE_INITIAL                           /* entries that no output sees are not written by gradient */
    for (int i = 0; i < NX; ++i)
        s->qp.g[i] = 0.0;
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
}

/* Steps that are small beside the trajectory are judged by its size: near its optimum bounds on outputs hold a
 * vanishing step with multipliers that do not vanish, and a barrier that resolved it would drown the cost. */
static void rti_least_step(struct rti *s)
{
#if LEAST_STEP
    memset(s->qp.least, 0, sizeof s->qp.least);
    for (int i = 0; i < NZ; ++i)
        s->qp.least[kind_of(i)] = largest(s->qp.least[kind_of(i)], SMALL_STEP * s->z[i]);
#else
    (void)s;
#endif
}

/* The feedback phase: the newest state, references and measurements enter; the trajectory moves by a full step, or
 * stays as it is when the step does not pass the check. */
static int rti_feedback(struct rti *s, struct solver_resources *resources)
{
    const int changed = rti_note_missing(s);

    if (!rti_inputs_valid(s))
        return s->status = BAD_INPUT;
    if (changed)
        rti_hessian(s);
    if (!s->valid_weights)
        return s->status = BAD_INPUT;
    rti_gradient(s);
    rti_least_step(s);
    for (int i = 0; i < NB; ++i) {
        s->qp.lower[i] = s->lower[i] - s->z[s->qp.bound[i]];
        s->qp.upper[i] = s->upper[i] - s->z[s->qp.bound[i]];
    }
    s->qp.status = qp_optimise(&s->qp, resources);
    for (int i = 0; i < NZ && s->qp.status == SOLVED; ++i)
        s->z[i] += s->qp.z[i];
    return s->status = s->qp.status;
}

/* Move the trajectory and the data on by one sample; the last sample's stages are repeated, its states predicted, x_N by
 * prepare or by the next shift. The weights belong to the place in the window, not to the sample, and stay. */
static NOINLINE void rti_shift(struct rti *s)
{
    if (s->open_end) {
        dynamics(s, N - 1, N);
        memcpy(STATE(s->z, N), s->qp.c[N - 1], sizeof s->qp.c[N - 1]);
    }
    memmove(STATE(s->z, 0), STATE(s->z, INTERVALS), (N + 1 - INTERVALS) * NX * sizeof(double));
    memmove(INPUT(s->z, 0), INPUT(s->z, INTERVALS), (N - INTERVALS) * NU * sizeof(double));
    memmove(s->p[0], s->p[INTERVALS], (N + 1 - INTERVALS) * sizeof s->p[0]);
    memmove(s->y[0], s->y[INTERVALS], (N + 1 - INTERVALS) * sizeof s->y[0]);
    memmove(s->qp.kept[0], s->qp.kept[INTERVALS], (N - INTERVALS) * sizeof s->qp.kept[0]);
    for (int k = N - INTERVALS; k < N - 1; ++k) {
        dynamics(s, k, k + 1);
        memcpy(STATE(s->z, k + 1), s->qp.c[k], sizeof s->qp.c[k]);
    }
    s->open_end = 1;
}

#endif

/* Scales of the residuals of the optimality conditions: the sizes of what they are sums of, and the cost's own size. */
#ifndef DRAWBAR_KKT_SCALE_H
#define DRAWBAR_KKT_SCALE_H

#include "qp.h"
#include "quads.h"

#define ROUNDING 1e-6                      /* a kind this much smaller than the largest is judged by the largest: their
                                            * rounding errors mix in the factorisation */
#define DROWNED 1e-3                       /* of that: a cost smaller than this is nothing but rounding */

static inline int kind_of(int i)
{
    return i < (N + 1) * NX ? i % NX : NX + (i - (N + 1) * NX) % NU;
}

/* The least step of a state or input that is judged by its own size. */
static inline double least_step(const struct qp *s, int j)
{
#if LEAST_STEP
    return s->least[j];
#else
    (void)s, (void)j;
    return 0.0;
#endif
}

/* What steps of the least size would cost, by the data alone. */
static double least_cost(const struct qp *restrict s)
{
    double cost = 0.0;

    for (int i = 0; LEAST_STEP && i < NZ; ++i)
        cost += fabs(s->g[i]) * least_step(s, kind_of(i));
    return cost;
}

/* Sizes against which residuals are judged, one for each state and input, since their units differ. Multipliers are
 * among them, but not in the cost's `slope`, what is left of its linear part and the penalty of violations, and not in their
 * `terms`. */
struct kkt_scale {
    double primal[NX + NU], dual[NX + NU], slope, terms, objective;
};

/* The largest terms of the gradient's rows, for each state and input. */
static inline void kkt_gradient_terms(const struct qp *restrict s, double *restrict dual)
{
    double states[(N + 1) * NX], inputs[N * NU];

    for (int k = 0; k <= N; ++k)
        for (int j = 0; j < NX; ++j)
            STATE(states, k)[j] = s->Q[k][j][j] * STATE(s->z, k)[j];
    for (int k = 0; k < N; ++k)
        for (int a = 0; a < NU; ++a) {
            double costates = 0.0;
            for (int m = 0; m < ND; ++m)
                costates += fabs(s->B[k][m][a] * STATE(s->pi, k + 1)[m]);
            inputs[k * NU + a] = largest(costates, s->R[k][a][a] * INPUT(s->z, k)[a]);
        }
    largest_of_kinds(states, N + 1, NX, dual);
    largest_of_kinds(s->g, N + 1, NX, dual);
    largest_of_kinds(STATE(s->pi, !FREE_INITIAL), N + FREE_INITIAL, NX, dual);
    largest_of_kinds(inputs, N, NU, dual + NX);
    largest_of_kinds(INPUT(s->g, 0), N, NU, dual + NX);
}

/* Includes the bounds' multipliers in the gradient's terms; returns what they cost. */
static inline double kkt_bound_terms(const struct qp *restrict s, double *restrict dual)
{
    double cost = 0.0;

    for (int i = 0; i < NB; ++i) {         /* both sides of a bound at once: only their difference acts */
        const double net = s->multiplier[2 * i] - s->multiplier[2 * i + 1];
        double *own = &dual[kind_of(s->bound[i])];
        if (net == 0.0)
            continue;
        *own = largest(*own, net);
        cost += fabs(net * s->z[s->bound[i]]);
    }
    return cost;
}

static void kkt_scales(const struct qp *restrict s, int bounded, struct kkt_scale *restrict scale)
{
    double primal[NX + NU] = {0.0}, dual[NX + NU] = {0.0}, least_primal = 1e-12, least_dual = 1e-100;

    largest_of_kinds(STATE(s->z, 0), N + 1, NX, primal);
    largest_of_kinds(INPUT(s->z, 0), N, NU, primal + NX);
    kkt_gradient_terms(s, dual);
    scale->objective = 1e-12 + (bounded ? kkt_bound_terms(s, dual) : 0.0);
    scale->slope = scale->terms = 0.0;
    add_products(s->g, s->z, NZ, &scale->slope, &scale->terms);
    for (int j = 0; j < NX + NU; ++j) {
        least_primal = largest(least_primal, ROUNDING * primal[j]);
        least_dual = largest(least_dual, ROUNDING * dual[j]);
    }
    for (int j = 0; j < NX + NU; ++j) {    /* a variable that is zero throughout has no size of its own */
        scale->primal[j] = largest(largest(least_primal, primal[j]), least_step(s, j));
        scale->dual[j] = largest(least_dual, dual[j]);
    }
    scale->objective += scale->terms + least_cost(s);
}

/* What z costs beside the linear part, `square`, the sizes of its terms, and the size of the data. */
static void kkt_quadratic(const struct qp *restrict s, double *restrict square, double *restrict terms, double *restrict data)
{
    for (int i = 0; i < NZ; ++i)
        *data = largest(*data, s->g[i]);
    for (int k = 0; k <= N; ++k) {
        const double *x = STATE(s->z, k), *u = INPUT(s->z, k);
        pack state[PACKS];
        read_vector(state, x);
        for (int j = 0; j < NX; ++j) {
            *square += 0.5 * x[j] * add_dot(0.0, s->Q[k][j], state);
            *terms += 0.5 * s->Q[k][j][j] * x[j] * x[j];
            *data = largest(*data, s->Q[k][j][j]);
        }
        for (int a = 0; a < NU && k < N; ++a) {
            double gradient = CROSS ? add_dot(0.0, s->S[k][a], state) : 0.0;
            for (int b = 0; b < NU; ++b)
                gradient += 0.5 * s->R[k][a][b] * u[b];
            *square += u[a] * gradient;
            *terms += 0.5 * s->R[k][a][a] * u[a] * u[a];
            *data = largest(*data, s->R[k][a][a]);
        }
    }
}

/* The cost's own size, of data and variables alone: what is left of its linear part beside the penalty of violations, and its
 * quadratic part. Rounding makes something of terms that cancel; where it drowns what is left of them nothing is known of the
 * cost, and only the data's own size counts: an optimum that is solved again passes by that, and hardly another answer. */
static double kkt_cost(const struct qp *restrict s, const struct kkt_scale *restrict scale)
{
    double square = 0.0, terms = scale->terms, data = 0.0;

    kkt_quadratic(s, &square, &terms, &data);
    const double left = fabs(scale->slope) + fabs(square) + least_cost(s), rounding = ROUNDING * terms;
    const double least = 1e-12 * (data > 0.0 ? data : 1.0);
    return least + (left < DROWNED * rounding ? 0.0 : left + (rounding < left ? rounding : left));
}

#endif

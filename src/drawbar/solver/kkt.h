/* Residuals of the optimality conditions, computed from the problem's data alone: nothing here uses the factorisation.
 *
 * The interior point iterates on these residuals, and every solution, from whatever route, is judged by them.
 */
#ifndef DRAWBAR_KKT_H
#define DRAWBAR_KKT_H

#include <float.h>

#include "qp.h"

#define CHECK_TOLERANCE 1e-8
#define GAP_TOLERANCE 1e-7                 /* of what the answer may cost above the optimum, relative to the cost's terms */
#define ROUNDING 1e-6                      /* a kind this much smaller than the largest is judged by the largest: their
                                            * rounding errors mix in the factorisation */
#define DROWNED 1e-3                       /* of that: a cost smaller than this is nothing but rounding */

static inline double largest(double bound, double value)
{
    const double size = fabs(value);
    return size > bound ? size : bound;    /* a NaN is caught by all_finite */
}

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

static inline int kind_of(int i)
{
    return i < (N + 1) * NX ? i % NX : NX + (i - (N + 1) * NX) % NU;
}

/* Is bounded variable i a hard bound of a given first state? No multiplier can act there. */
static inline int is_given(const struct qp *s, int i)
{
    return !FREE_INITIAL && s->bound[i] < NX && !(s->soft_linear[i] < (double)INFINITY);
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
 * among them, but not in the cost's `slope`, what is left of its linear part and the price of violations, and not in their
 * `terms`. */
struct kkt_scale {
    double primal[NX + NU], dual[NX + NU], slope, terms, objective;
};

/* What the scales are made of, for each state and input: the largest size of it (`primal`) and of what its row of the gradient
 * is the sum of (`dual`), and its part of the cost's linear terms, their sizes (`terms`) and they themselves (`slope`). */
struct kkt_sizes {
    double primal[NX + NU], dual[NX + NU], terms[NX + NU], slope[NX + NU];
};

static inline void sizes_of_states(const struct qp *restrict s, struct kkt_sizes *restrict sizes)
{
    pack most[PACKS], steepest[PACKS], sum[PACKS], slope[PACKS];

    EACH_PACK(b)
        most[b] = steepest[b] = sum[b] = slope[b] = (pack){0};
    for (int k = 0; k <= N; ++k) {
        pack x[PACKS], q[PACKS], pi[PACKS], term[PACKS];
        read_vector(x, STATE(s->z, k));
        read_vector(q, STATE(s->g, k));
        grow(most, x);
        grow(steepest, q);
        if (k > 0 || !FREE_INITIAL) {
            read_vector(pi, STATE(s->pi, k));
            grow(steepest, pi);
        }
        read_diagonal(term, (const double (*)[WIDTH])s->Q[k]);
        EACH_PACK(b)
            term[b] *= x[b];
        grow(steepest, term);
        EACH_PACK(b) {
            sum[b] += pack_size(q[b] * x[b]);
            slope[b] += q[b] * x[b];
        }
    }
    write_vector(sizes->primal, most);
    write_vector(sizes->dual, steepest);
    write_vector(sizes->terms, sum);
    write_vector(sizes->slope, slope);
}

static inline void sizes_of_inputs(const struct qp *restrict s, struct kkt_sizes *restrict sizes)
{
    double *primal = sizes->primal + NX, *dual = sizes->dual + NX;

    for (int k = 0; k < N; ++k)
        for (int a = 0; a < NU; ++a) {
            const double u = INPUT(s->z, k)[a], r = INPUT(s->g, k)[a];
            double pull = 0.0;
            for (int m = 0; m < ND; ++m)
                pull += fabs(s->B[k][m][a] * STATE(s->pi, k + 1)[m]);
            primal[a] = largest(primal[a], u);
            dual[a] = largest(largest(largest(dual[a], r), s->R[k][a][a] * u), pull);
            sizes->terms[NX + a] += fabs(r * u);
            sizes->slope[NX + a] += r * u;
        }
}

/* Lets the bounds' multipliers grow the gradient's sizes; returns `objective` with what they cost added. */
static inline double sizes_of_multipliers(const struct qp *restrict s, struct kkt_sizes *restrict sizes, double objective)
{
    for (int i = 0; i < NB; ++i) {   /* both sides of a bound at once: only their difference acts */
        const double net = s->multiplier[2 * i] - s->multiplier[2 * i + 1];
        double *dual = &sizes->dual[kind_of(s->bound[i])];
        if (net == 0.0)
            continue;
        *dual = largest(*dual, net);
        objective += fabs(net * s->z[s->bound[i]]);
    }
    return objective;
}

static void kkt_scales(const struct qp *restrict s, int bounded, struct kkt_scale *restrict scale)
{
    struct kkt_sizes sizes = {{0.0}, {0.0}, {0.0}, {0.0}};
    double least_primal = 1e-12, least_dual = 1e-100, objective = 1e-12, terms = 0.0, slope = 0.0;

    sizes_of_states(s, &sizes);
    sizes_of_inputs(s, &sizes);
    if (bounded)
        objective = sizes_of_multipliers(s, &sizes, objective);
    for (int j = 0; j < NX + NU; ++j) {
        least_primal = largest(least_primal, ROUNDING * sizes.primal[j]);
        least_dual = largest(least_dual, ROUNDING * sizes.dual[j]);
        terms += sizes.terms[j];
        slope += sizes.slope[j];
    }
    for (int j = 0; j < NX + NU; ++j) {    /* a variable that is zero throughout has no size of its own */
        scale->primal[j] = largest(largest(least_primal, sizes.primal[j]), least_step(s, j));
        scale->dual[j] = largest(least_dual, sizes.dual[j]);
    }
    scale->slope = slope;
    scale->terms = terms;
    scale->objective = objective + terms + least_cost(s);
}

/* What the bounds add: their multipliers to the gradient, the price of violations to the cost; returns their own worst
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
            const double price = fabs((s->soft_linear[i] + 0.5 * s->soft_quadratic[i] * slack) * slack);
            scale->slope += price;
            scale->terms += price;
            negative[kind] = largest(negative[kind], sigma < 0.0 ? sigma : 0.0);
            gap += fabs(sigma) * (fabs(slack) + (distance < 0.0 ? -distance : 0.0));   /* told, and not told of */
        }
    }
    for (int j = 0; j < NX + NU; ++j)
        worst = largest(largest(worst, outside[j] / scale->primal[j]), negative[j] / scale->dual[j]);
    *total = gap;
    return largest(worst, gap / scale->objective);
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
            double pull = CROSS ? add_dot(0.0, s->S[k][a], state) : 0.0;
            for (int b = 0; b < NU; ++b)
                pull += 0.5 * s->R[k][a][b] * u[b];
            *square += u[a] * pull;
            *terms += 0.5 * s->R[k][a][a] * u[a] * u[a];
            *data = largest(*data, s->R[k][a][a]);
        }
    }
}

/* The cost's own size, of data and variables alone: what is left of its linear part beside the price of violations, and its
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
    double stationarity[NX + NU] = {0.0}, feasibility[NX], worst = 0.0, gap = 0.0;
    pack steepest[PACKS], missed[PACKS], row[PACKS];
    struct kkt_scale scale ON_STACK;

    if (!all_finite(s->z, NZ) || !all_finite(s->pi, (N + 1) * NX) || (bounded && !all_finite(s->multiplier, NSIDES)))
        return NOT_FINITE;
    kkt_residual(s, s->z, s->pi, 1.0, gradient, defect);
    kkt_scales(s, bounded, &scale);
    if (bounded)
        worst = kkt_bounds(s, &scale, gradient, &gap);
    EACH_PACK(b)
        steepest[b] = missed[b] = (pack){0};
    for (int k = 0; k <= N; ++k) {
        read_vector(row, STATE(gradient, k));
        grow(steepest, row);
    }
    for (int k = 0; k < N; ++k) {
        read_vector(row, defect[k]);
        grow(missed, row);
        for (int a = 0; a < NU; ++a)
            stationarity[NX + a] = largest(stationarity[NX + a], INPUT(gradient, k)[a]);
    }
    write_vector(stationarity, steepest);
    write_vector(feasibility, missed);
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
    gap *= CHECK_TOLERANCE / GAP_TOLERANCE;    /* told as a residual; one that is no number is none that passes */
    const double left = fabs(scale.slope), known = left > DROWNED * ROUNDING * scale.terms ? left : 0.0;
    if (worst <= CHECK_TOLERANCE && !(gap <= CHECK_TOLERANCE * known)) {
        gap /= kkt_cost(s, &scale);
        worst = gap <= worst ? worst : gap;
    }
    s->kkt = worst;
    return s->kkt <= CHECK_TOLERANCE ? SOLVED : CHECK_FAILED;
}

#endif

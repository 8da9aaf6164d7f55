/* Farkas certificate that no point satisfies the hard bounds and the dynamics.
 *
 * Multipliers >= 0 of the state bounds add up to one inequality, and costates eliminate the states from it, so that it
 * speaks of the inputs (and a free first state) only. If not even the best ones within their bounds satisfy it, nothing
 * does. Nothing is assumed of the multipliers: bad ones only prove nothing. Where an input has no bound its slope must
 * have cancelled, which in floating point is a matter of degree.
 */
#ifndef DRAWBAR_FARKAS_H
#define DRAWBAR_FARKAS_H

#include "kkt.h"

#define FARKAS_DOUBT 1e4                   /* cancelled: what is left, times this, is small against what it was */
#define FARKAS_FAR 1e11                    /* or this, against the largest slope of its kind of variable */
#define FARKAS_ROUNDING 1e-9               /* a sum this much smaller than its terms is nothing but rounding */
#define FARKAS_FORGIVEN (10.0 * CHECK_TOLERANCE)   /* infeasible by less, the check may still forgive */
#define FARKAS_EXACT 1e-11                 /* what rounding may make of the sum, relative to its terms */

/* No point exists if value > 0. Terms: sum of the sizes of what it is the sum of; doubt: what is left of the costates that
 * were set to zero, relative to what they cancelled from. Slopes that should have cancelled are collected with what they
 * cancelled from, and the largest that any of their kind did; sides: how many bounds of states have multipliers. */
struct farkas {
    double value, terms, doubt, slope[NX + N * NU], size[NX + N * NU], largest[NX + NU];
    int sides, open, kind[NX + N * NU];
    double low[NZ], high[NZ], net[NZ];     /* hard bounds of every variable; lower minus upper multiplier of a state */
};

/* Collect the tightest hard bounds; returns by how much two bounds on one variable exclude each other, relative to their
 * sizes. */
static double farkas_bounds(const struct qp *restrict s, struct farkas *restrict f)
{
    double crossed = 0.0;

    for (int i = 0; i < NZ; ++i) {
        f->low[i] = !FREE_INITIAL && i < NX ? s->initial[i] : -(double)INFINITY;
        f->high[i] = !FREE_INITIAL && i < NX ? s->initial[i] : (double)INFINITY;
    }
    for (int i = 0; i < NB; ++i) {
        const int at = s->bound[i];
        if (s->soft_linear[i] < (double)INFINITY)
            continue;
        f->low[at] = s->lower[i] > f->low[at] ? s->lower[i] : f->low[at];
        f->high[at] = s->upper[i] < f->high[at] ? s->upper[i] : f->high[at];
        const double apart = f->low[at] - f->high[at];
        if (apart > crossed * (fabs(f->low[at]) + fabs(f->high[at])))
            crossed = apart / (fabs(f->low[at]) + fabs(f->high[at]));
    }
    return crossed;
}

static inline void farkas_add(struct farkas *f, double part)
{
    f->value += part;
    f->terms += fabs(part);
}

/* Add the least that slope * variable can be; size: of the slope before cancellation. */
static inline void farkas_least(struct farkas *f, double slope, double size, double low, double high, int kind)
{
    const double end = slope > 0.0 ? low : high;

    f->largest[kind] = largest(f->largest[kind], size);
    if (slope == 0.0)
        return;
    if (fabs(end) < (double)INFINITY)
        farkas_add(f, slope * end);
    else {
        f->slope[f->open] = fabs(slope);
        f->size[f->open] = size;
        f->kind[f->open++] = kind;
    }
}

/* Add one side of a hard state bound; inputs and a free first state meet their bounds in farkas_least. */
static inline void farkas_side(const struct qp *restrict s, struct farkas *restrict f, int i, double lambda, double bound)
{
    const int at = s->bound[i], first = FREE_INITIAL ? NX : 0;

    if (lambda == 0.0 || s->soft_linear[i] < (double)INFINITY || at < first || at >= (N + 1) * NX)
        return;
    ++f->sides;
    f->net[at] += lambda;
    farkas_add(f, lambda * bound);
}

/* A costate from the sum of its terms. Costates may be chosen: what is nothing but rounding is better zero, and stays in
 * doubt as a slope of its state. */
static inline double farkas_costate(struct farkas *f, double sum, double size)
{
    if (sum == 0.0 || fabs(sum) > FARKAS_ROUNDING * size)
        return sum;
    f->doubt += FARKAS_DOUBT * fabs(sum) / size;
    return 0.0;
}

/* One stage back, adding its inputs and defects: pi belongs to k + 1 before, to k after. */
static void farkas_stage(const struct qp *restrict s, struct farkas *restrict f, int k, double *restrict pi,
                         double *restrict terms)
{
    double pi_k[NX];

    for (int a = 0; a < NU; ++a) {
        double slope = 0.0, size = 0.0;
        for (int m = 0; m < ND; ++m) {
            slope += s->B[k][m][a] * pi[m];
            size += fabs(s->B[k][m][a] * pi[m]);
        }
        farkas_least(f, slope, size, INPUT(f->low, k)[a], INPUT(f->high, k)[a], NX + a);
    }
    for (int i = 0; i < NX; ++i) {
        const double net = STATE(f->net, k)[i];
        double sum = (i < ND ? 0.0 : pi[i]) - net, size = (i < ND ? 0.0 : fabs(pi[i])) + fabs(net);
        farkas_add(f, pi[i] * s->c[k][i]);
        for (int m = 0; m < ND; ++m) {
            sum += s->A[k][m][i] * pi[m];
            size += fabs(s->A[k][m][i] * pi[m]);
        }
        pi_k[i] = farkas_costate(f, sum, size);
        terms[i] = size;
        f->largest[i] = largest(f->largest[i], size);
    }
    memcpy(pi, pi_k, sizeof pi_k);
}

/* What is left of the slopes that should have cancelled, relative: small against what each cancelled from at its own
 * stage, or nothing but the rounding of others of its kind. */
static double farkas_doubt(const struct farkas *f)
{
    double doubt = f->doubt;

    for (int i = 0; i < f->open; ++i) {
        const double own = FARKAS_DOUBT * f->slope[i] / f->size[i], far = FARKAS_FAR * f->slope[i] / f->largest[f->kind[i]];
        doubt += own < far ? own : far;
    }
    return doubt;
}

/* By how much do these multipliers of the lower and upper sides (NB each; those that are not positive count as zero) prove
 * it? Relative to the terms; nothing is proved by less than FARKAS_EXACT. */
static double farkas_margin(const struct qp *restrict s, const double *restrict lower, const double *restrict upper)
{
    struct farkas f = {.value = 0.0};
    double pi[NX], terms[NX];
    const double crossed = farkas_bounds(s, &f);

    if (crossed > FARKAS_EXACT)
        return crossed;
    for (int i = 0; i < NB; ++i) {
        farkas_side(s, &f, i, lower[i] > 0.0 ? lower[i] : 0.0, s->lower[i]);
        farkas_side(s, &f, i, upper[i] > 0.0 ? -upper[i] : 0.0, s->upper[i]);
    }
    if (f.sides == 0)                      /* no multiplier of a state's hard bound: nothing adds up */
        return 0.0;
    for (int i = 0; i < NX; ++i)
        pi[i] = -STATE(f.net, N)[i];
    for (int k = N - 1; k >= 0; --k)
        farkas_stage(s, &f, k, pi, terms);
    for (int i = 0; i < NX; ++i)
        farkas_least(&f, pi[i], terms[i], f.low[i], f.high[i], i);
    const double doubt = farkas_doubt(&f);
    return f.value > doubt * f.terms ? f.value / f.terms - doubt : 0.0;
}

#endif

/* A certificate that no point satisfies the hard bounds and the dynamics (Farkas).
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
#define FARKAS_SLACK (10.0 * CHECK_TOLERANCE)   /* what the check would forgive is not infeasible */

/* No point exists if value > 0. Terms: sum of the sizes of what it is the sum of; by kind of variable, what is left of
 * the slopes that should have cancelled, and the largest that anything cancelled from. */
struct farkas {
    double value, terms, left[NX + NU], largest[NX + NU];
    double low[NZ], high[NZ], net[NZ];     /* hard bounds of every variable; lower minus upper multiplier of a state */
};

/* Collect the tightest hard bounds; returns 0 when two bounds on one variable exclude each other. */
static int farkas_bounds(const struct qp *restrict s, struct farkas *restrict f)
{
    for (int i = 0; i < NZ; ++i) {
        f->low[i] = -INFINITY;
        f->high[i] = INFINITY;
    }
    for (int i = 0; i < NB; ++i) {
        const int at = s->bound[i];
        if (s->soft_linear[i] < INFINITY)
            continue;
        f->low[at] = s->lower[i] > f->low[at] ? s->lower[i] : f->low[at];
        f->high[at] = s->upper[i] < f->high[at] ? s->upper[i] : f->high[at];
        if (f->low[at] - f->high[at] > FARKAS_SLACK * (fabs(f->low[at]) + fabs(f->high[at])))
            return 0;
    }
    return 1;
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
    if (fabs(end) < INFINITY)
        farkas_add(f, slope * end);
    else
        f->left[kind] += fabs(slope);
}

/* Add one side of a hard state bound; inputs and a free first state meet their bounds in farkas_least. */
static inline void farkas_side(const struct qp *restrict s, struct farkas *restrict f, int i, double lambda, double bound)
{
    const int at = s->bound[i], first = FREE_INITIAL ? NX : 0;

    if (lambda == 0.0 || s->soft_linear[i] < INFINITY || at < first || at >= (N + 1) * NX)
        return;
    f->net[at] += lambda;
    farkas_add(f, lambda * bound);
}

/* One stage back, adding its inputs and defects: pi and size belong to k + 1 before, to k after. */
static void farkas_stage(const struct qp *restrict s, struct farkas *restrict f, int k, double *restrict pi,
                         double *restrict size)
{
    double pi_k[NX], size_k[NX];

    for (int a = 0; a < NU; ++a) {
        double slope = 0.0, terms = 0.0;
        for (int m = 0; m < ND; ++m) {
            slope += s->B[k][m][a] * pi[m];
            terms += fabs(s->B[k][m][a]) * size[m];
        }
        farkas_least(f, slope, terms, INPUT(f->low, k)[a], INPUT(f->high, k)[a], NX + a);
    }
    for (int i = 0; i < NX; ++i) {
        farkas_add(f, pi[i] * s->c[k][i]);
        pi_k[i] = (i < ND ? 0.0 : pi[i]) - STATE(f->net, k)[i];
        size_k[i] = (i < ND ? 0.0 : size[i]) + fabs(STATE(f->net, k)[i]);
        for (int m = 0; m < ND; ++m) {
            pi_k[i] += s->A[k][m][i] * pi[m];
            size_k[i] += fabs(s->A[k][m][i]) * size[m];
        }
    }
    memcpy(pi, pi_k, sizeof pi_k);
    memcpy(size, size_k, sizeof size_k);
}

/* Do these multipliers of the lower and upper sides (NB each; those that are not positive count as zero) prove it? */
static int farkas_proves(const struct qp *restrict s, const double *restrict lower, const double *restrict upper)
{
    struct farkas f = {.value = 0.0};
    double pi[NX], size[NX], doubt = FARKAS_SLACK;

    if (!farkas_bounds(s, &f))
        return 1;
    for (int i = 0; i < NB; ++i) {
        farkas_side(s, &f, i, lower[i] > 0.0 ? lower[i] : 0.0, s->lower[i]);
        farkas_side(s, &f, i, upper[i] > 0.0 ? -upper[i] : 0.0, s->upper[i]);
    }
    for (int i = 0; i < NX; ++i) {
        pi[i] = -STATE(f.net, N)[i];
        size[i] = fabs(pi[i]);
    }
    for (int k = N - 1; k >= 0; --k)
        farkas_stage(s, &f, k, pi, size);
    for (int i = 0; i < NX; ++i)
        farkas_least(&f, pi[i], size[i], FREE_INITIAL ? f.low[i] : s->initial[i], FREE_INITIAL ? f.high[i] : s->initial[i], i);
    for (int j = 0; j < NX + NU; ++j)
        doubt += f.left[j] > 0.0 ? FARKAS_DOUBT * f.left[j] / f.largest[j] : 0.0;
    return f.value > doubt * f.terms;
}

#endif

/* Projected Newton (Bertsekas 1982) along the stages (Tassa, Mansard and Todorov 2014), on factorisations in which an input
 * with an active bound follows that bound's feedback law (pn_stage.h).
 *
 * A pass goes backward, where bounds with a multiplier of the wrong sign are released, and forward, where each input is
 * clipped to its own bounds and to those of the states that it alone moves: later stages start from the clipped state, so
 * that many bounds change at once and most problems need one pass or two. A pass costs one factorisation and one sweep of the
 * stages up to the last active bound, however many bounds are active. A soft bound is violated where its multiplier would
 * exceed its linear penalty, or where the bounds before it leave no other choice. Coupled bounds, which no single input
 * moves, are left to active_set.h, and problems that do not converge to interior_point.h.
 */
#ifndef DRAWBAR_PROJECTED_NEWTON_H
#define DRAWBAR_PROJECTED_NEWTON_H

#include "pn_backward.h"

#define PN_PASSES 8
#define PN_WARM_PASSES 5                   /* with bounds that are kept (pn_warm_start.h): the first is two sweeps alone */

/* Interval in which an input respects its bounds, and the bounds at its ends, -1 for none. */
struct pn_interval {
    double low, high;
    int low_bound, high_bound;
};

/* Chain the bounds of each input, its own before those of states, and the coupled bounds. */
static void pn_chain(const struct qp *restrict s, struct projected_newton *restrict pn)
{
    memset(pn->first, -1, sizeof pn->first);
    pn->coupled = -1;
    for (int i = 0; i < NB; ++i) {
        const int a = pn_input_of(s, i), k = pn_stage_of(s, i), own = s->bound[i] >= (N + 1) * NX;
        int32_t *place = a < 0 ? &pn->coupled : &pn->first[k][a];
        if (!own && *place >= 0 && s->bound[*place] >= (N + 1) * NX)
            place = &pn->next[*place];
        pn->next[i] = *place;
        *place = i;
    }
}

/* Intersect an input's interval with what bound i allows: the bounded variable is base + sensitivity u. Returns the side of the
 * bound if the input does not end at it: 0, or PN_VIOLATED with its sign; PN_ACTIVE where it is hard and nothing is left. */
static inline int pn_narrow(const struct qp *s, int i, int side, double base, double sensitivity, struct pn_interval *interval)
{
    const double inverse = 1.0 / sensitivity, lower = inverse * (s->lower[i] - base), upper = inverse * (s->upper[i] - base);
    const int outward = sensitivity > 0.0 ? 1 : -1;
    const int violated = side == PN_VIOLATED ? outward : side == -PN_VIOLATED ? -outward : 0;
    double low = outward > 0 ? lower : upper, high = outward > 0 ? upper : lower;

    if (violated > 0) {                    /* it may come back as far as to its limit */
        low = high;
        high = (double)INFINITY;
    } else if (violated < 0) {
        high = low;
        low = -(double)INFINITY;
    }
    if (low > interval->high || high < interval->low) {
        const int past = low > interval->high ? -outward : outward;
        return violated != 0 ? 0 : s->soft_linear[i] < (double)INFINITY ? past * PN_VIOLATED : PN_ACTIVE;
    }
    if (low > interval->low) {
        interval->low = low;
        interval->low_bound = i;
    }
    if (high < interval->high) {
        interval->high = high;
        interval->high_bound = i;
    }
    return violated * outward * PN_VIOLATED;
}

/* Value of a bounded variable at u = 0: 0 for the input itself. */
static inline double pn_base(const struct qp *s, int i, int k, const pack *x)
{
    const int j = s->bound[i] % NX;

    if (s->bound[i] >= (N + 1) * NX)
        return 0.0;
    return j < NA ? add_dot(s->c[k][j], s->A[k][j], x) : s->c[k][j] + STATE(s->z, k)[j];
}

/* Does an input that follows its law respect all its other bounds, and is none of them active or violated? */
static inline int pn_respects(const struct qp *s, const struct projected_newton *pn, int k, int a, const pack *x, double u)
{
    for (int i = pn->first[k][a]; i >= 0; i = pn->next[i]) {
        if (i == pn->active[k][a])
            continue;
        const double value = pn_base(s, i, k, x) + pn_sensitivity(s, i, k, a) * u;
        if (pn->side[i] != 0 || value < s->lower[i] || value > s->upper[i])
            return 0;
    }
    return 1;
}

/* Release an input whose active bound has a multiplier of the wrong sign at this state, and move the input to its optimum: of
 * active bounds at stages in a row, all that have to be released after the first are so in one pass. */
static inline void pn_drop(const struct qp *s, struct projected_newton *pn, int k, int a, const pack *x, double *u)
{
    const int i = pn->active[k][a];

    if (i < 0)
        return;
    const double gradient = add_dot(pn->gradient_offset[k][a], pn->gradient_gain[k][a], x);
    if (gradient * pn->side[i] * pn_sensitivity(s, i, k, a) > 0.0 && s->lower[i] < s->upper[i]) {
        pn->active[k][a] = -1;
        *u -= gradient / pn->curvature[k][a];
    }
}

/* Clip an input to its interval. Returns how many of its bounds have changed, or -1 where a hard one leaves no interval. */
static int pn_clip(const struct qp *restrict s, struct projected_newton *restrict pn, int k, int a, const pack *x,
                   double *restrict u)
{
    struct pn_interval interval = {-(double)INFINITY, (double)INFINITY, -1, -1};
    int changes = 0, end = 0, bound = pn->active[k][a];

    for (int i = pn->first[k][a]; i >= 0; i = pn->next[i]) {
        pn->new_side[i] = pn_narrow(s, i, pn->side[i], pn_base(s, i, k, x), pn_sensitivity(s, i, k, a), &interval);
        if (pn->new_side[i] == PN_ACTIVE)
            return -1;
    }
    if (bound >= 0)                        /* its law brings the input to the bound, but for rounding */
        end = (pn->side[bound] > 0) == (pn_sensitivity(s, bound, k, a) > 0.0) ? 1 : -1;
    if (bound < 0 || bound != (end > 0 ? interval.high_bound : interval.low_bound))
        end = *u > interval.high ? 1 : *u < interval.low ? -1 : 0;
    pn->active[k][a] = bound = end > 0 ? interval.high_bound : end < 0 ? interval.low_bound : -1;
    *u = end > 0 ? interval.high : end < 0 ? interval.low : *u;
    if (bound >= 0) {                      /* one that is no longer violated keeps its side */
        const int upper = pn->new_side[bound] != 0 ? pn->new_side[bound] > 0
            : (end > 0) == (pn_sensitivity(s, bound, k, a) > 0.0);
        pn->new_side[bound] = upper ? PN_ACTIVE : -PN_ACTIVE;
    }
    for (int i = pn->first[k][a]; i >= 0; i = pn->next[i]) {
        changes += pn->new_side[i] != pn->side[i];
        pn->side[i] = pn->new_side[i];
        pn->last = pn->side[i] != 0 && k > pn->last ? k : pn->last;
    }
    return changes;
}

/* Forward sweep: every input by its law, clipped to its interval, and the costates; may_release: after a backward sweep, which
 * has computed the gradients of inputs with an active bound. Returns how many bounds have changed, or -1 where a hard bound
 * leaves no interval or a coupled one is violated. */
static int pn_forward(struct qp *restrict s, struct projected_newton *restrict pn, int may_release)
{
    double now[NX];
    int changes = 0;

    memcpy(now, s->initial, sizeof now);
    for (int k = 0; k <= N; ++k) {
        double *u = INPUT(s->z, k);
        pack x[PACKS];
        state_and_multiplier(s, k, now, pn->p[k], x, s->z, s->pi);
        for (int a = 0; a < NU && k < N; ++a) {
            u[a] = add_dot(pn->feedforward[k][a], s->K[k][a], x);
            if (may_release)
                pn_drop(s, pn, k, a, x, &u[a]);
            const int changed = pn_respects(s, pn, k, a, x, u[a]) ? 0 : pn_clip(s, pn, k, a, x, &u[a]);
            if (changed < 0)
                return -1;
            changes += changed;
        }
        if (k < N)
            state_after(s, k, s->c[k], x, u, now);
    }
    for (int i = pn->coupled; i >= 0; i = pn->next[i])
        if (s->z[s->bound[i]] < s->lower[i] || s->z[s->bound[i]] > s->upper[i])
            return -1;
    return changes;
}

/* Is the multiplier of every active bound of the right sign, and below its linear penalty? The stages before it have moved
 * since the backward sweep looked. */
static int pn_multipliers_valid(struct qp *restrict s, struct projected_newton *restrict pn)
{
    int valid = 1;

    pn_multipliers(s, pn);
    for (int i = 0; i < NB; ++i) {
        const double multiplier = -pn->side[i] * pn->nu[i];
        valid &= (multiplier >= 0.0 || !(s->lower[i] < s->upper[i])) && multiplier <= s->soft_linear[i];
    }
    return valid;
}

static void pn_write_multipliers(struct qp *restrict s, const struct projected_newton *restrict pn)
{
    for (int i = 0; i < NB; ++i) {
        if (pn->side[i] == 0)
            continue;
        const int violated = pn->side[i] == PN_VIOLATED || pn->side[i] == -PN_VIOLATED, lower = 2 * i, upper = 2 * i + 1;
        const double violation = fabs(s->z[s->bound[i]] - pn_limit(s, pn, i));
        s->multiplier[lower] = pn->nu[i] > 0.0 ? pn->nu[i] : 0.0;
        s->multiplier[upper] = pn->nu[i] < 0.0 ? -pn->nu[i] : 0.0;
        if (violated) {
            const int m = pn->side[i] < 0 ? lower : upper;
            s->multiplier[m] = s->soft_linear[i] + s->soft_quadratic[i] * violation;
            s->violation[m] = violation;
        }
    }
}

enum pn_outcome { PN_CONVERGED, PN_NOT_CONVERGED, PN_COUPLED };

/* Publish the multipliers, if this is the solution. */
static int pn_accept(struct qp *restrict s, struct projected_newton *restrict pn)
{
    if (!pn_multipliers_valid(s, pn))
        return 0;
    pn_write_multipliers(s, pn);
    return 1;
}

/* Pass after pass until nothing changes, from a forward sweep that has changed so many bounds (-1: it has failed); s->iterations
 * counts them. Begun with kept bounds, forward sweeps release inputs too. Begun with none, few active bounds have to be released,
 * and without that more problems converge. */
static enum pn_outcome pn_iterate(struct qp *s, struct projected_newton *pn, int changes, int kept)
{
    while (changes >= 0 && s->iterations++ < (kept ? PN_WARM_PASSES : PN_PASSES)) {
        changes = pn_backward(s, pn) ? pn_forward(s, pn, kept) : -1;
        if (changes == 0 && pn_accept(s, pn))
            return PN_CONVERGED;
    }
    return PN_NOT_CONVERGED;
}

#endif

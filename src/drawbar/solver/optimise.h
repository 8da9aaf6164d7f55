/* Optimise: which method solves a quadratic program, and which one where that does not; the solution is judged.
 *
 * One sweep where no bound is active; projected Newton (projected_newton.h) or an active set (active_set.h) for a few bounds;
 * the interior point for many, or wherever those do not converge.
 */
#ifndef DRAWBAR_OPTIMISE_H
#define DRAWBAR_OPTIMISE_H

#include "active_set.h"
#include "noinline.h"
#include "pn_warm_start.h"
#include "interior_point.h"
#include "solver_resources.h"

/* Does s->z respect every bound, soft ones too? */
static int bounds_respected(const struct qp *s)
{
    int violated = 0;

    for (int i = 0; i < NB; ++i) {
        const double value = s->z[s->bound[i]];
        violated |= (value < s->lower[i]) | (value > s->upper[i]);
    }
    return !violated;
}

/* Where the sweep without bounds fails or its answer does not pass: the interior point with primal regularisation, unless its
 * starting point already passes. Returns `reason` where that does not help. */
static COLD int qp_regularised(struct qp *s, struct interior_point *ip, int32_t *left, int reason)
{
    double gradient[NZ], defect[N][NX];

    s->factored = 0;
    if (!ip_regularise_primal(s, ip))
        return reason;
    if (bounds_respected(s) && kkt_check(s, 0, gradient, defect) == SOLVED)
        return SOLVED;
    const int status = qp_interior_point(s, ip, left);
    return status == SOLVED || status == INFEASIBLE ? status : reason;
}

/* Discard what was found with bounds: back to the solution without them. */
static void qp_discard_bounds(struct qp *s)
{
    memset(s->multiplier, 0, sizeof s->multiplier);
    memset(s->violation, 0, sizeof s->violation);
    if (!s->factored)
        s->factored = qp_factor(s, NULL, N + 1);
    qp_solve(s, s->g, (const double (*)[NX])s->c, s->initial, s->z, s->pi);
}

/* Projected Newton, from the kept bounds or from none, and the check. Only bounds of a solution are kept. */
static enum pn_outcome qp_checked(struct qp *s, struct projected_newton *newton)
{
    double gradient[NZ], defect[N][NX];
    enum pn_outcome outcome = qp_projected_newton(s, newton);

    memset(s->kept, 0, sizeof s->kept);
    if (outcome != PN_CONVERGED)
        return outcome;
    if (kkt_check(s, 1, gradient, defect) == SOLVED) {
        pn_keep(s, newton);
        return PN_CONVERGED;
    }
    memset(s->multiplier, 0, sizeof s->multiplier);
    memset(s->violation, 0, sizeof s->violation);
    return PN_NOT_CONVERGED;
}

/* Projected Newton, then the active set; returns whether one of them has the solution. Else s has the one without bounds. */
static int qp_active(struct qp *s, union bounds_work *work)
{
    double gradient[NZ], defect[N][NX];
    enum pn_outcome outcome = PN_COUPLED;

    if (!FREE_INITIAL) {
        outcome = qp_checked(s, &work->newton);
        if (outcome == PN_CONVERGED)
            return 1;
        qp_discard_bounds(s);
    }
    if (COLUMNS && outcome == PN_COUPLED && qp_active_set(s, &work->active)) {
        if (kkt_check(s, 1, gradient, defect) == SOLVED)
            return 1;
        qp_discard_bounds(s);
    }
    return 0;
}

/* Solve without bounds or, where all of them are those of a free first state, with them. Returns whether the solution
 * respects all bounds; where not, s holds the one without bounds. */
static int qp_solve_free(struct qp *s, struct active_set *active)
{
    if (bounds_at_first(s))
        return qp_first_set(s, active);
    qp_solve(s, s->g, (const double (*)[NX])s->c, s->initial, s->z, s->pi);
    return bounds_respected(s);
}

/* One sweep (factored beforehand if s->factored) when no bound is active, an active set where that converges, the interior
 * point otherwise; the answer is judged by kkt_check. */
static int qp_optimise(struct qp *s, struct solver_resources *resources)
{
    union bounds_work *work = resources->work;
    double gradient[NZ], defect[N][NX];
    int invalid = !bounds_exist(s);

    s->iterations = 0;
    s->kkt = (double)INFINITY;
    memset(s->multiplier, 0, sizeof s->multiplier);
    memset(s->violation, 0, sizeof s->violation);
    for (int i = 0; i < NB; ++i)
        invalid |= !(s->lower[i] <= s->upper[i]) | !(s->soft_linear[i] >= 0.0) | !(s->soft_quadratic[i] >= 0.0)
            | !(s->soft_quadratic[i] < (double)INFINITY) | !(s->soft_linear[i] + s->soft_quadratic[i] > 0.0);
    if (invalid)
        return BAD_INPUT;
    if (!FREE_INITIAL && s->factored == FACTORED_KEPT && qp_checked(s, &work->newton) == PN_CONVERGED)
        return SOLVED;
    memset(s->kept, 0, sizeof s->kept);
    s->iterations = 0;
    if (!s->factored && !qp_factor(s, NULL, N + 1))
        return qp_regularised(s, &work->ip, &resources->iterations, NOT_FINITE);
    s->factored = FACTORED;
    if (qp_solve_free(s, &work->active)) {
        const int status = kkt_check(s, s->iterations > 0, gradient, defect);
        if (status == SOLVED || s->iterations == 0)
            return status == SOLVED ? SOLVED : qp_regularised(s, &work->ip, &resources->iterations, status);
        qp_discard_bounds(s);
    } else if (!bounds_at_first(s) && qp_active(s, work))
        return SOLVED;
    s->factored = 0;                       /* the barrier changes it */
    work->ip.primal_regularisation.share = 0.0;
    return qp_interior_point(s, &work->ip, &resources->iterations);
}

#endif

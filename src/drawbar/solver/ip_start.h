/* Interior-point start: the solution without bounds, or a nearer one where that lies far out or where the cost leaves
 * something undetermined.
 */
#ifndef DRAWBAR_IP_START_H
#define DRAWBAR_IP_START_H

#include "ip_regularisation.h"
#include "noinline.h"

#define FARTHEST_START 1e3                 /* times the largest bound: no start lies further out than that */
#define START_MARGIN 1e-3                  /* of its kind's size: no start lies nearer to a bound than that; */
#define PENALISED_START_MARGIN 0.1         /* or than that, where penalties had to bring it in */
#define PENALTY_FACTOR 1e4                 /* by which these penalties grow while variables lie further out, */
#define LARGEST_PENALTY 1e8                /* up to here, and then once more to as much as variables were too far out */
#define SOFT_MULTIPLIER_START 10.0         /* times what the curvature alone makes them: multipliers of soft sides, which do not
                                            * exceed their penalty; where many are active, less leads to short steps */
#define LEAST_CURVATURE 1e-12              /* of the largest curvature, of the room around a variable: as much as none */

/* Curvature of the cost to go along bounded variable i, as factorised. A state without any, such as a bounded output, has that
 * of the state and inputs before it, of which it is made. */
static double ip_curvature(const struct qp *s, int i)
{
    const int at = s->bound[i], u = at - (N + 1) * NX, k = at / NX, j = at % NX;
    double give = 0.0;

    if (u >= 0)
        return 1.0 / s->D[u / NU][u % NU];
    if (s->P[k][j][j] > 0.0 || k == 0 || j >= ND)
        return s->P[k][j][j];
    for (int m = 0; m < NX; ++m)
        give += s->P[k - 1][m][m] > 0.0 ? s->A[k - 1][j][m] * s->A[k - 1][j][m] / s->P[k - 1][m][m] : 0.0;
    for (int a = 0; a < NU; ++a)
        give += s->B[k - 1][j][a] * s->B[k - 1][j][a] * s->D[k - 1][a];
    return give > 0.0 ? 1.0 / give : 0.0;
}

/* Bound m of variable m / 2: lower sides are even, upper ones odd. */
static inline double ip_bound(const struct qp *s, int m)
{
    return m % 2 == 0 ? s->lower[m / 2] : s->upper[m / 2];
}

/* Of two hard sides only the multipliers' difference acts: subtract what they have in common. */
static void ip_subtract_common(struct qp *restrict s, const struct interior_point *restrict ip)
{
    for (int i = 0; i < NB; ++i) {
        const double lower = ip->lambda[i], upper = ip->lambda[NLOWER + i], both = lower < upper ? lower : upper;
        if (ip->soft[i] > 0.0)
            continue;
        s->multiplier[2 * i] = lower - both;
        s->multiplier[2 * i + 1] = upper - both;
    }
}

static NOINLINE void ip_write_multipliers(struct qp *restrict s, const struct interior_point *restrict ip)
{
    for (int i = 0; i < NB; ++i) {
        s->multiplier[2 * i] = ip->lambda[i];
        s->multiplier[2 * i + 1] = ip->lambda[NLOWER + i];
        s->violation[2 * i] = ip->v[i];
        s->violation[2 * i + 1] = ip->v[NLOWER + i];
    }
    if (ip->dual_regularisation > 0.0)
        ip_subtract_common(s, ip);
}

/* How far the variables of each kind lie outside their bounds, relative to the largest of these bounds. Returns the largest. */
static double ip_relative_excess(const struct qp *restrict s, double *restrict excess)
{
    double span[NX + NU] = {0.0}, farthest = 0.0;

    memset(excess, 0, (NX + NU) * sizeof *excess);
    for (int m = 0; m < NSIDES; ++m) {
        const int kind = kind_of(s->bound[m / 2]);
        const double distance = bound_distance(s, s->z, m);
        if (!(fabs(ip_bound(s, m)) < (double)INFINITY))
            continue;
        excess[kind] = largest(excess[kind], distance < 0.0 ? distance : 0.0);
        span[kind] = largest(span[kind], ip_bound(s, m));
    }
    for (int j = 0; j < NX + NU; ++j) {    /* bounds at zero have no size of their own */
        excess[j] = span[j] > 0.0 ? excess[j] / span[j] : 0.0;
        farthest = largest(farthest, excess[j]);
    }
    return farthest;
}

/* Minimum of the cost with quadratic penalties, of this curvature for each kind, on the distances of all bounded variables from
 * their bounds. Returns 0 where the factorisation fails. */
static int ip_penalised_minimum(struct qp *restrict s, struct interior_point *restrict ip, const double *restrict curvature)
{
    double gradient[NZ];

    ip_clear_barrier(ip);
    memcpy(gradient, s->g, sizeof gradient);
    for (int m = 0; m < NSIDES; ++m) {
        const int i = s->bound[m / 2];
        if (!(fabs(ip_bound(s, m)) < (double)INFINITY))
            continue;
        ip->barrier[i] += curvature[kind_of(i)];
        gradient[i] -= curvature[kind_of(i)] * ip_bound(s, m);
    }
    if (!qp_factor(s, ip->barrier, N + 1))
        return 0;
    qp_solve(s, gradient, (const double (*)[NX])s->c, s->initial, s->z, s->pi);
    return 1;
}

/* Starting point: the minimum without bounds or, where the cost is so flat that this lies far out, the minimum with penalties that
 * begin as large as the cost's own curvature and grow until it does not. Each further one counts as an iteration of *left,
 * which takes longer. Returns how near to a bound the start may lie, in sizes of its kind; 0 on failure. */
static COLD double ip_starting_point(struct qp *restrict s, struct interior_point *restrict ip, int32_t *left)
{
    double excess[NX + NU], now[NX + NU], curve[NX + NU] = {0.0}, curvature[NX + NU];
    const double farthest = ip_relative_excess(s, excess);

    if (!(farthest > FARTHEST_START))
        return START_MARGIN;
    for (int i = 0; i < NB; ++i)
        curve[kind_of(s->bound[i])] = largest(curve[kind_of(s->bound[i])], ip_curvature(s, i));
    for (double penalty = 1.0;; penalty = penalty < LARGEST_PENALTY ? PENALTY_FACTOR * penalty : farthest, --*left) {
        for (int j = 0; j < NX + NU; ++j)
            curvature[j] = curve[j] * (excess[j] < penalty ? excess[j] : penalty);
        if (!ip_penalised_minimum(s, ip, curvature))
            return 0.0;
        if (!(penalty < farthest) || !(ip_relative_excess(s, now) > FARTHEST_START))
            return PENALISED_START_MARGIN;
    }
}

/* Violation v of a soft side whose complementarity equals that of its slack: v sigma = complementarity, with
 * sigma = spare + growth v. */
static inline double ip_start_violation(double spare, double growth, double complementarity)
{
    return 2.0 * complementarity / (spare + sqrt(spare * spare + 4.0 * growth * complementarity));
}

/* What a start goes by, for each kind of variable. */
struct start_scales {
    double violation[NX + NU], room[NX + NU];        /* largest violation of a bound, and least distance from one */
    double size[NX + NU], curvature[NX + NU];        /* largest value, and largest curvature of a bounded variable */
    double least_curvature;                /* what counts as none */
};

/* Note which sides there are: those of finite bounds on what can move. */
static COLD void ip_note_sides(const struct qp *restrict s, struct interior_point *restrict ip)
{
    for (int m = 0; m < NSIDES; ++m) {
        const int slot = m % 2 * NLOWER + m / 2;
        const double bound = ip_bound(s, m);
        if (!(fabs(bound) < (double)INFINITY) || is_given(s, m / 2))
            continue;
        ip->exists[slot] = 1.0;
        ip->offset[slot] = m % 2 == 0 ? -bound : bound;
        ip->pairs += 1.0;
    }
}

static COLD void ip_start_scales(const struct qp *restrict s, const struct interior_point *restrict ip,
                                 struct start_scales *restrict scales)
{
    double largest_curvature = 0.0;

    memset(scales, 0, sizeof *scales);
    for (int j = 0; j < NX + NU; ++j)
        scales->room[j] = (double)INFINITY;
    for (int i = 0; i < NZ; ++i)
        scales->size[kind_of(i)] = largest(scales->size[kind_of(i)], s->z[i]);
    for (int m = 0; m < NSIDES; ++m) {
        const int kind = kind_of(s->bound[m / 2]);
        const double distance = bound_distance(s, s->z, m);
        if (ip->exists[m % 2 * NLOWER + m / 2] == 0.0)
            continue;
        scales->violation[kind] = largest(scales->violation[kind], distance < 0.0 ? distance : 0.0);
        scales->room[kind] = fabs(distance) < scales->room[kind] ? fabs(distance) : scales->room[kind];
        scales->curvature[kind] = largest(scales->curvature[kind], ip_curvature(s, m / 2));
        largest_curvature = largest(largest_curvature, scales->curvature[kind]);
    }
    for (int j = 0; j < NX + NU; ++j)      /* a kind that stays at zero has no size of its own */
        scales->size[j] = scales->size[j] > LEAST_CURVATURE * scales->room[j] ? scales->size[j] : scales->room[j];
    scales->least_curvature =
        LEAST_CURVATURE * (largest_curvature > 0.0 && largest_curvature < 1.0 ? largest_curvature : 1.0);
}

/* Slack and multipliers of side m, no nearer to its bound than `nearest` sizes of its kind. */
static COLD void ip_start_side(const struct qp *restrict s, struct interior_point *restrict ip,
                               const struct start_scales *restrict scales, double nearest, int m)
{
    const int slot = m % 2 * NLOWER + m / 2, kind = kind_of(s->bound[m / 2]);
    const double distance = bound_distance(s, s->z, m), least = nearest * scales->size[kind] + 1e-12;
    const double margin = scales->violation[kind] > least ? scales->violation[kind] : least;
    const double curvature = ip_curvature(s, m / 2), flat = scales->least_curvature, penalty = s->soft_linear[m / 2];
    double lambda;

    ip->t[slot] = distance > margin ? distance : margin;
    ip->reciprocal_curvature[slot] = 1.0 / (scales->curvature[kind] > flat ? scales->curvature[kind] : flat);
    lambda = margin * margin * (curvature > flat ? curvature : flat) / ip->t[slot];
    if (penalty < (double)INFINITY) {      /* starts where its own multipliers add up to its penalty */
        const double growth = s->soft_quadratic[m / 2], most = 0.5 * (penalty + growth * ip->t[slot]);
        lambda = SOFT_MULTIPLIER_START * lambda < most ? SOFT_MULTIPLIER_START * lambda : most;
        ip->soft[slot] = 1.0;
        ip->linear[slot] = penalty;
        ip->quadratic[slot] = growth;
        ip->v[slot] = ip_start_violation(penalty - lambda, growth, lambda * ip->t[slot]);
        ip->sigma[slot] = penalty + growth * ip->v[slot] - lambda;
        ip->pairs += 1.0;
    }
    ip->lambda[slot] = lambda;
}

/* Slacks and multipliers at the starting point, every slack well inside. */
static COLD void ip_start(struct qp *restrict s, struct interior_point *restrict ip, double nearest)
{
    const struct primal_regularisation kept = ip->primal_regularisation;
    struct start_scales scales;

    memset(ip, 0, sizeof *ip);
    ip->primal_regularisation = kept;
    for (int m = 0; m < 2 * NLOWER; ++m)
        ip->t[m] = ip->distance[m] = 1.0;
    ip_note_sides(s, ip);
    ip_start_scales(s, ip, &scales);
    for (int m = 0; m < NSIDES; ++m)
        if (ip->exists[m % 2 * NLOWER + m / 2] > 0.0)
            ip_start_side(s, ip, &scales, nearest, m);
    ip_write_multipliers(s, ip);
}

#endif

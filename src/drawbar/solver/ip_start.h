/* Interior-point start: the solution without bounds, or a nearer one where that lies far out or where the cost leaves
 * something undetermined.
 */
#ifndef DRAWBAR_IP_START_H
#define DRAWBAR_IP_START_H

#include "noinline.h"
#include "kkt.h"

#define FAR_OUT 1e3                        /* times the largest bound: no start lies further out than that */
#define NEAR 1e-3                          /* of its kind's size: no start lies nearer to a bound than that; */
#define DRAWN 0.1                          /* or than that, where it was drawn in from far out */
#define PULL_MORE 1e4                      /* times harder that variables are drawn in from there, while they are far out, */
#define LAST_PULL 1e8                      /* up to here, and then as much harder as they were far out */
#define SOFT_START 10.0                    /* times what the curvature alone makes them: multipliers of soft sides, which do not exceed
                                            * their penalty; where many are active, less leads to short steps */
#define FLAT 1e-12                         /* of the largest curvature, of the room around a variable: as much as none */
#define DAMPING 1e-8                       /* of the curvature, where the cost leaves something undetermined */

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

/* Of two hard sides only the multipliers' difference acts: leave out what they have in common. */
static void ip_leave_out(struct qp *restrict s, const struct interior_point *restrict ip)
{
    for (int i = 0; i < NB; ++i) {
        const double lower = ip->lambda[i], upper = ip->lambda[NLOWER + i], both = lower < upper ? lower : upper;
        if (ip->soft[i] > 0.0)
            continue;
        s->multiplier[2 * i] = lower - both;
        s->multiplier[2 * i + 1] = upper - both;
    }
}

static NOINLINE void ip_publish(struct qp *restrict s, const struct interior_point *restrict ip)
{
    for (int i = 0; i < NB; ++i) {
        s->multiplier[2 * i] = ip->lambda[i];
        s->multiplier[2 * i + 1] = ip->lambda[NLOWER + i];
        s->violation[2 * i] = ip->v[i];
        s->violation[2 * i + 1] = ip->v[NLOWER + i];
    }
    if (ip->loose > 0.0)
        ip_leave_out(s, ip);
}

/* The barrier before any bound: what damps steps where the cost alone does not. */
static void ip_clear_barrier(struct interior_point *ip)
{
    memset(ip->barrier, 0, sizeof ip->barrier);
    for (int i = 0; ip->damping.share > 0.0 && i < NZ; ++i)
        ip->barrier[i] = ip->damping.share * ip->damping.weight[kind_of(i)];
}

static inline double positive(double value)
{
    return value > 0.0 ? value : 0.0;
}

/* Where the cost leaves something undetermined: damp every step a little, which changes no solution, since steps vanish
 * there. Returns 0 when the cost has no minimum all the same, else the start is that of the strongly damped problem. */
static int ip_damp(struct qp *restrict s, struct interior_point *restrict ip)
{
    double *weight = ip->damping.weight, heaviest = 0.0;

    memset(&ip->damping, 0, sizeof ip->damping);
    for (int k = 0; k <= N; ++k)
        for (int j = 0; j < NX; ++j)
            weight[j] = largest(weight[j], positive(s->Q[k][j][j]));
    for (int k = 0; k < N; ++k)
        for (int a = 0; a < NU; ++a) {
            double own = positive(s->R[k][a][a]);
            for (int m = 0; m < ND; ++m)
                own += s->B[k][m][a] * s->B[k][m][a] * positive(s->Q[k + 1][m][m]);
            weight[NX + a] = largest(weight[NX + a], own);
        }
    for (int j = 0; j < NX + NU; ++j)
        heaviest = largest(heaviest, weight[j]);
    for (int i = 0; i < NZ && heaviest == 0.0; ++i)   /* no curvature at all: as much as there is slope */
        heaviest = largest(heaviest, s->g[i]);
    for (int j = 0; j < NX + NU; ++j)
        weight[j] = largest(largest(ROUNDING * heaviest, weight[j]), 1e-100);
    for (int strong = 0; strong <= 1; ++strong) {
        ip->damping.share = strong ? 1.0 : DAMPING;
        ip_clear_barrier(ip);
        if (!qp_factor(s, ip->barrier, N + 1))
            return 0;
    }
    ip->damping.share = DAMPING;
    qp_solve(s, s->g, (const double (*)[NX])s->c, s->initial, s->z, s->pi);
    return 1;
}

/* How far the variables of each kind lie outside, `away`, in times of how far from zero their bounds are. Returns the largest. */
static double ip_far_out(const struct qp *restrict s, double *restrict away)
{
    double span[NX + NU] = {0.0}, farthest = 0.0;

    memset(away, 0, (NX + NU) * sizeof *away);
    for (int m = 0; m < NSIDES; ++m) {
        const int kind = kind_of(s->bound[m / 2]);
        const double distance = bound_distance(s, s->z, m);
        if (!(fabs(ip_bound(s, m)) < (double)INFINITY))
            continue;
        away[kind] = largest(away[kind], distance < 0.0 ? distance : 0.0);
        span[kind] = largest(span[kind], ip_bound(s, m));
    }
    for (int j = 0; j < NX + NU; ++j) {    /* bounds at zero have no size of their own */
        away[j] = span[j] > 0.0 ? away[j] / span[j] : 0.0;
        farthest = largest(farthest, away[j]);
    }
    return farthest;
}

/* Draw all bounded variables towards their bounds, with as much curvature for each kind. Returns 0 where the factorisation
 * fails. */
static int ip_draw(struct qp *restrict s, struct interior_point *restrict ip, const double *restrict curvature)
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

/* Where the cost is nearly flat its minimum without bounds lies so far out that nothing about it is a start. Draw all
 * bounded variables towards their bounds, no harder than it takes: first as hard as the cost itself curves. To draw again counts
 * as an iteration of *left, which takes longer. Returns how near to a bound a start may lie then, 0 on failure. */
static COLD double ip_approach(struct qp *restrict s, struct interior_point *restrict ip, int32_t *left)
{
    double away[NX + NU], now[NX + NU], curve[NX + NU] = {0.0}, curvature[NX + NU];
    const double farthest = ip_far_out(s, away);

    if (!(farthest > FAR_OUT))
        return NEAR;
    for (int i = 0; i < NB; ++i)
        curve[kind_of(s->bound[i])] = largest(curve[kind_of(s->bound[i])], ip_curvature(s, i));
    for (double pull = 1.0;; pull = pull < LAST_PULL ? PULL_MORE * pull : farthest, --*left) {
        for (int j = 0; j < NX + NU; ++j)
            curvature[j] = curve[j] * (away[j] < pull ? away[j] : pull);
        if (!ip_draw(s, ip, curvature))
            return 0.0;
        if (!(pull < farthest) || !(ip_far_out(s, now) > FAR_OUT))
            return DRAWN;
    }
}

/* The violation v of a soft side whose complementarity equals that of its distance: v sigma = pair, with
 * sigma = spare + growth v. */
static inline double ip_start_violation(double spare, double growth, double pair)
{
    return 2.0 * pair / (spare + sqrt(spare * spare + 4.0 * growth * pair));
}

/* Start from the solution without bounds, with every distance pushed well inside. */
static COLD void ip_start(struct qp *restrict s, struct interior_point *restrict ip, double near)
{
    double worst[NX + NU] = {0.0}, size[NX + NU] = {0.0}, curve[NX + NU] = {0.0}, flat = 0.0, room[NX + NU];
    const struct ip_damping damping = ip->damping;

    memset(ip, 0, sizeof *ip);
    ip->damping = damping;
    for (int m = 0; m < 2 * NLOWER; ++m)
        ip->t[m] = ip->distance[m] = 1.0;
    for (int j = 0; j < NX + NU; ++j)
        room[j] = (double)INFINITY;
    for (int i = 0; i < NZ; ++i)
        size[kind_of(i)] = largest(size[kind_of(i)], s->z[i]);
    for (int m = 0; m < NSIDES; ++m) {
        const int slot = m % 2 * NLOWER + m / 2, kind = kind_of(s->bound[m / 2]);
        const double bound = ip_bound(s, m);
        if (!(fabs(bound) < (double)INFINITY) || is_given(s, m / 2))
            continue;
        const double distance = bound_distance(s, s->z, m);
        ip->exists[slot] = 1.0;
        ip->offset[slot] = m % 2 == 0 ? -bound : bound;
        ip->pairs += 1.0;
        worst[kind] = largest(worst[kind], distance < 0.0 ? distance : 0.0);
        room[kind] = fabs(distance) < room[kind] ? fabs(distance) : room[kind];
        curve[kind] = largest(curve[kind], ip_curvature(s, m / 2));
        flat = largest(flat, curve[kind]);
    }
    for (int j = 0; j < NX + NU; ++j)      /* a kind that stays at zero has no size of its own */
        size[j] = size[j] > FLAT * room[j] ? size[j] : room[j];
    flat = FLAT * (flat > 0.0 && flat < 1.0 ? flat : 1.0);
    for (int m = 0; m < NSIDES; ++m) {
        const int slot = m % 2 * NLOWER + m / 2, kind = kind_of(s->bound[m / 2]);
        if (ip->exists[slot] == 0.0)
            continue;
        const double distance = bound_distance(s, s->z, m), least = near * size[kind] + 1e-12;
        const double margin = worst[kind] > least ? worst[kind] : least, penalty = s->soft_linear[m / 2];
        const double curvature = ip_curvature(s, m / 2);
        double lambda;
        ip->t[slot] = distance > margin ? distance : margin;
        ip->ease[slot] = 1.0 / (curve[kind] > flat ? curve[kind] : flat);
        lambda = margin * margin * (curvature > flat ? curvature : flat) / ip->t[slot];
        if (penalty < (double)INFINITY) {            /* starts where its own multipliers add up to its penalty */
            const double growth = s->soft_quadratic[m / 2], most = 0.5 * (penalty + growth * ip->t[slot]);
            lambda = SOFT_START * lambda < most ? SOFT_START * lambda : most;
            ip->soft[slot] = 1.0;
            ip->linear[slot] = penalty;
            ip->quadratic[slot] = growth;
            ip->v[slot] = ip_start_violation(penalty - lambda, growth, lambda * ip->t[slot]);
            ip->sigma[slot] = penalty + growth * ip->v[slot] - lambda;
            ip->pairs += 1.0;
        }
        ip->lambda[slot] = lambda;
    }
    ip_publish(s, ip);
}

#endif

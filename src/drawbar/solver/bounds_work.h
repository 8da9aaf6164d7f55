/* Bounds work: memory of the three methods for bounds, which never work at the same time. They have it for the length
 * of one feedback: it is too large for a microcontroller's stack, and all solvers of an autopilot share it. */
#ifndef DRAWBAR_BOUNDS_WORK_H
#define DRAWBAR_BOUNDS_WORK_H

#define ACTIVE_COLUMNS 24
#define ACTIVE_MOST (NB < ACTIVE_COLUMNS ? NB : ACTIVE_COLUMNS)    /* sweeps that cost less than the interior point */
#define BLOCK 8                            /* sides are worked on in blocks, for SIMD code */
#define NLOWER ((NB + BLOCK - 1) / BLOCK * BLOCK)
#define NSLOTS AT_LEAST_ONE(2 * NLOWER)    /* slot i: lower side of bounded variable i, slot NLOWER + i: its upper side */

/* Work of active_set.h: the active bounds, and one column for each that was ever active in this problem. */
struct active_set {
    double column[AT_LEAST_ONE(ACTIVE_MOST)][AT_LEAST_ONE(NB)];   /* how a unit multiplier moves the bounded variables */
    double L[AT_LEAST_ONE(ACTIVE_MOST)][AT_LEAST_ONE(ACTIVE_MOST)], D[AT_LEAST_ONE(ACTIVE_MOST)];
    double nu[AT_LEAST_ONE(ACTIVE_MOST)];
    double gradient[NZ], dz[NZ], dpi[(N + 1) * NX];   /* one sweep: its gradient, and how that moves everything */
    int32_t count, member[AT_LEAST_ONE(ACTIVE_MOST)], slot[AT_LEAST_ONE(NB)];   /* slot: place among the columns, or -1 */
    int32_t side[AT_LEAST_ONE(NB)];        /* -1: at the lower bound, 1: at the upper, 0: free */
    int32_t first;                         /* all bounds are those of a free first state */
};

/* Work of projected_newton.h: the state of each bound, and the recursion's vectors. */
struct projected_newton {
    double p[N + 1][WIDTH], feedforward[N][NU];
    double gradient_offset[N][NU], gradient_gain[N][NU][WIDTH];   /* an input's gradient under the laws: offset + gain x, */
    double curvature[N][NU];               /* and its derivative by the input */
    double g[NZ], penalty_curvature[NZ];   /* the cost's gradient, and what penalties add to its curvature */
    double nu[AT_LEAST_ONE(NB)];           /* multipliers: positive at lower bounds */
    int32_t side[AT_LEAST_ONE(NB)], active[N][NU];   /* active: the bound that determines an input, or -1 */
    int32_t first[N][NU], next[AT_LEAST_ONE(NB)], coupled;   /* chains of each input's bounds, and of coupled ones; -1: end */
    int32_t new_side[AT_LEAST_ONE(NB)];    /* side after the input's next move */
    int32_t last;                          /* stage with the last bound that was ever active */
};

/* An iterate to return to: near the limit of the arithmetic the next one may be worse. */
struct ip_iterate {
    double kkt, z[NZ], pi[(N + 1) * NX], multiplier[AT_LEAST_ONE(NSIDES)], violation[AT_LEAST_ONE(NSIDES)];
};

/* What is added to the diagonal of the Hessian for each kind of variable, where the cost leaves something undetermined. */
struct primal_regularisation {
    double weight[NX + NU], share;         /* curvature, and how much of it is added; 0: nothing */
};

/* Work of interior_point.h. Slots without a bound keep t = 1, lambda = 0, those without softness v = 0, sigma = 0: flags
 * of 0 and 1 instead of branches let every loop over slots run in SIMD registers. */
struct interior_point {
    struct primal_regularisation primal_regularisation;
    double dual_regularisation;            /* delta of each bound, relative to its reciprocal curvature; 0: none */
    double farkas_margin;                  /* largest so far: above 0 it proves that no feasible point exists */
    double least_kkt;                      /* residual of the best iterate so far */
    int32_t stalled_steps;                 /* long steps since it last fell */
    int32_t short_steps;                   /* one after the other */
    int32_t rejected_correctors;           /* whose step would not have lowered the duality measure */
    double exists[NSLOTS], soft[NSLOTS], offset[NSLOTS], linear[NSLOTS], quadratic[NSLOTS];
    double t[NSLOTS], lambda[NSLOTS], v[NSLOTS], sigma[NSLOTS];
    double dt[NSLOTS], dlambda[NSLOTS], dv[NSLOTS], dsigma[NSLOTS];
    double distance[NSLOTS], reciprocal_curvature[NSLOTS];
    double t_inverse[NSLOTS], v_inverse[NSLOTS], pair_inverse[NSLOTS];   /* 1 / t, 1 / v, 1 / (t + delta lambda) */
    double pairs;                          /* complementary pairs in all */
    double gradient[NZ], defect[N][NX];    /* of the Lagrangian, and of the dynamics */
    double barrier[NZ], dz[NZ], dpi[(N + 1) * NX];
    struct ip_iterate best;
};

union bounds_work {
    struct projected_newton newton;
    struct active_set active;
    struct interior_point ip;
};

#endif

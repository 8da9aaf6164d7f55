/* Quadratic program: structured, of control and estimation, with its factorisation.
 *
 *     min   sum_k 1/2 [x_k; u_k]' [Q_k S_k'; S_k R_k] [x_k; u_k] + q_k' x_k + r_k' u_k        (stage N: x only)
 *     s.t.  x_{k+1} = A_k x_k + B_k u_k + c_k,   x_0 given (or free: FREE_INITIAL, arrival cost in Q_0, q_0)
 *           lower <= z_i <= upper for the bounded variables i, hard or soft
 *
 * Riccati recursion as in Rao, Wright and Rawlings (1998), section 4; cost linear in N. The including unit defines N
 * (stages), NX, NU, NB (bounded variables), NS (trailing states that only inputs move: rows [0 I] of A), NC (those of them that
 * nothing moves), CROSS (0 where S is zero), FREE_INITIAL, and LEAST_STEP 1 where steps are not judged by themselves alone
 * (kkt.h). No heap, no recursion, every loop bounded.
 */
#ifndef DRAWBAR_QP_H
#define DRAWBAR_QP_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define NA (NX - NS)                      /* states with rows of A that are not [0 I] */
#define ND (NX - NC)                      /* states with rows of B that are not zero */
#define NZ ((N + 1) * NX + N * NU)        /* all variables: every x, then every u */
#define NSIDES (2 * NB)                   /* each bounded variable has a lower and an upper side */
#define AT_LEAST_ONE(n) ((n) > 0 ? (n) : 1)

#include "packs.h"
#include "bounds_work.h"
#include "status.h"

#define STATE(z, k) ((z) + (k) * NX)
#define INPUT(z, k) ((z) + (N + 1) * NX + (k) * NU)

#ifndef LEAVING
#define LEAVING 0                          /* 1 where a stage that leaves the window is linearised with it, see rti.h */
#endif
#ifndef LEAST_STEP
#define LEAST_STEP 0
#endif

enum factorisation { NOT_FACTORED, FACTORED, FACTORED_KEPT };   /* kept: with the laws of the kept bounds */

struct qp {
    /* problem */
    double Q[N + 1][NX][WIDTH], S[CROSS ? N : 1][NU][WIDTH], R[N][NU][NU];
    double A[N + LEAVING][ND][WIDTH], B[N + LEAVING][ND][NU], c[N + LEAVING][NX];   /* the rows below of A are [0 I], those
                                            * of B zero */
    double g[NZ];                          /* q_0 .. q_N, r_0 .. r_{N-1} */
    double initial[NX];                    /* x_0 where it is given */
    double lower[AT_LEAST_ONE(NB)], upper[AT_LEAST_ONE(NB)];   /* infinite: none */
    double soft_linear[AT_LEAST_ONE(NB)], soft_quadratic[AT_LEAST_ONE(NB)];  /* cost of a violation; infinite: hard */
    int32_t bound[AT_LEAST_ONE(NB)];       /* index into z of each bounded variable */
#if LEAST_STEP
    double least[NX + NU];                 /* a step of a state or input that is smaller is judged as one of this size */
#endif
    /* solution */
    double z[NZ], pi[(N + 1) * NX];        /* pi_k multiplies x_k's equation */
    double multiplier[AT_LEAST_ONE(NSIDES)], violation[AT_LEAST_ONE(NSIDES)];
    double kkt;                            /* relative KKT residual, from kkt.h */
    int32_t status, iterations;
    int32_t factored;                      /* P, K, L, D belong to Q, R, S, A, B without a barrier: enum factorisation */
    int32_t kept[N][NU];                   /* bound of each input that was active in the problem before, see pn_warm_start.h:
                                            * 1 + j, of state j after the stage; 1 + NX, its own; negative: lower; 0: none */
    /* factorisation */
    double P[N + 1][NX][WIDTH], K[N][NU][WIDTH], L[N][NU][NU], D[N][NU], P0_L[NX][NX], P0_D[NX];
};

/* Is every bounded variable one that there is? */
static int bounds_exist(const struct qp *s)
{
    int missing = 0;
    for (int i = 0; i < NB; ++i)
        missing |= (s->bound[i] < 0) | (s->bound[i] >= NZ);
    return !missing;
}

#define LDL_ROUNDING 1e-13                 /* a pivot this much smaller than what it was taken from is rounding */
#define LDL_RAISED 1e-8                    /* and becomes this much of it: the direction is undetermined, and held back */
#define PIVOT_AS_IT_IS(pivot, from) (pivot)

static inline double ldl_raised(double pivot, double from)
{
    return fabs(pivot) <= LDL_ROUNDING * from ? LDL_RAISED * from : pivot;
}

/* L D L' of a symmetric matrix (lower triangle read; D holds reciprocals); returns 0 when it is not positive definite. */
#define DEFINE_LDL(name, n, columns, pivot)                                                   \
    static inline int name(const double (*restrict M)[columns], double (*restrict L)[n], double *restrict D) \
    {                                                                                         \
        double W[n][n];                                                                       \
        for (int j = 0; j < (n); ++j) {                                                       \
            double d = M[j][j];                                                               \
            for (int k = 0; k < j; ++k)                                                       \
                d -= L[j][k] * W[j][k];                                                       \
            d = pivot(d, M[j][j]);                                                            \
            if (!(d > 0.0) || !(d < 1e300))                                                   \
                return 0;                                                                     \
            D[j] = 1.0 / d;                                                                   \
            for (int i = j + 1; i < (n); ++i) {                                               \
                double v = M[i][j];                                                           \
                for (int k = 0; k < j; ++k)                                                   \
                    v -= W[i][k] * L[j][k];                                                   \
                W[i][j] = v;                                                                  \
                L[i][j] = v * D[j];                                                           \
            }                                                                                 \
        }                                                                                     \
        return 1;                                                                             \
    }                                                                                         \
    static inline void name##_solve(const double (*restrict L)[n], const double *restrict D, double *restrict v) \
    {                                                                                         \
        for (int i = 1; i < (n); ++i)                                                         \
            for (int k = 0; k < i; ++k)                                                       \
                v[i] -= L[i][k] * v[k];                                                       \
        for (int i = 0; i < (n); ++i)                                                         \
            v[i] *= D[i];                                                                     \
        for (int i = (n) - 2; i >= 0; --i)                                                    \
            for (int k = (n) - 1; k > i; --k)      /* what has only just been found comes last */ \
                v[i] -= L[k][i] * v[k];                                                       \
    }

DEFINE_LDL(ldl_input, NU, NU, PIVOT_AS_IT_IS)
DEFINE_LDL(ldl_input_raised, NU, NU, ldl_raised)
DEFINE_LDL(ldl_state, NX, WIDTH, PIVOT_AS_IT_IS)

/* K = -Huu^-1 Hux, all columns side by side. */
static inline void feedback_rows(const double (*restrict L)[NU], const double *restrict D,
                                 const double (*restrict Hux)[WIDTH], double (*restrict K)[WIDTH])
{
    EACH_PACK(b) {
        pack v[NU];
        UNROLLED for (int i = 0; i < NU; ++i) {
            v[i] = -read_pack(Hux[i], b);
            for (int k = 0; k < i; ++k)
                v[i] -= L[i][k] * v[k];
        }
        UNROLLED for (int i = NU - 1; i >= 0; --i) {
            v[i] *= D[i];
            for (int k = i + 1; k < NU; ++k)
                v[i] -= L[k][i] * v[k];
            write_pack(K[i], b, v[i]);
        }
    }
}

/* Huu = R + B' P B, factorised; P is that of stage k+1. */
static inline int riccati_input(struct qp *restrict s, int k, const double *restrict barrier,
                                const double (*restrict P)[WIDTH])
{
    const double (*restrict B)[NU] = (const double (*)[NU])s->B[k];
    double Huu[NU][NU];

    UNROLLED for (int a = 0; a < NU; ++a) {
        double BP[WIDTH];
        pack row[PACKS];

        EACH_PACK(b)
            row[b] = B[0][a] * read_pack(P[0], b);
        UNROLLED for (int m = 1; m < ND; ++m)
            add_row(row, B[m][a], P[m]);
        write_row(BP, row);
        UNROLLED for (int b = 0; b < NU; ++b) {
            double sum = s->R[k][a][b];
            UNROLLED for (int m = 0; m < ND; ++m)
                sum += BP[m] * B[m][b];
            Huu[a][b] = sum;
        }
        if (barrier)
            Huu[a][a] += INPUT(barrier, k)[a];
    }
    return NU > 1 && barrier ? ldl_input_raised((const double (*)[NU])Huu, s->L[k], s->D[k])
                   : ldl_input((const double (*)[NU])Huu, s->L[k], s->D[k]);
}

/* One backward step: P_{k+1} gives P_k, with the feedback K, L, D of stage k. */
static inline int riccati_stage(struct qp *restrict s, int k, const double *restrict barrier)
{
    const double (*restrict A)[WIDTH] = (const double (*)[WIDTH])s->A[k];
    const double (*restrict B)[NU] = (const double (*)[NU])s->B[k];
    const double (*restrict after)[WIDTH] = (const double (*)[WIDTH])s->P[k + 1];
    double (*restrict P)[WIDTH] = s->P[k], (*restrict K)[WIDTH] = s->K[k];
    double PA[NX][WIDTH], Hux[NU][WIDTH];

    if (!riccati_input(s, k, barrier, after))
        return 0;
    UNROLLED for (int i = 0; i < ND; ++i) {
        pack row[PACKS];
        EACH_PACK(b)
            row[b] = mask_from(NA, b) * read_pack(after[i], b);
        UNROLLED for (int m = 0; m < NA; ++m)
            add_row(row, after[i][m], A[m]);
        write_row(PA[i], row);
    }
    EACH_UPPER_ROW(c, i) {                 /* no row of B asks for the rest of these */
        pack row[PACKS];
        if (i < ND)
            continue;
        for (int b = c; b < PACKS; ++b)
            row[b] = mask_from(NA, b) * read_pack(after[i], b);
        UNROLLED for (int m = 0; m < NA; ++m)
            add_row_from(c, row, after[i][m], A[m]);
        write_row_from(c, PA[i], row);
    }
    UNROLLED for (int a = 0; a < NU; ++a) {
        pack row[PACKS];
        EACH_PACK(b)
            row[b] = B[0][a] * read_pack(PA[0], b);
        UNROLLED for (int m = 1; m < ND; ++m)
            add_row(row, B[m][a], PA[m]);
        if (CROSS)
            add_row(row, 1.0, s->S[k][a]);
        write_row(Hux[a], row);
    }
    feedback_rows((const double (*)[NU])s->L[k], s->D[k], (const double (*)[WIDTH])Hux, K);
    EACH_UPPER_ROW(c, i) {
        pack row[PACKS];
        read_row_from(c, row, s->Q[k][i]);
        if (i >= NA)
            add_row_from(c, row, 1.0, PA[i]);
        UNROLLED for (int m = 0; m < NA; ++m)
            add_row_from(c, row, A[m][i], PA[m]);
        UNROLLED for (int a = 0; a < NU; ++a)
            add_row_from(c, row, Hux[a][i], K[a]);
        write_row_from(c, P[i], row);
        if (barrier)
            P[i][i] += STATE(barrier, k)[i];
    }
    mirror(P);
    return 1;
}

/* Factorise the KKT matrix; barrier (or NULL) is added to the diagonal of the Hessian. Only the first `stages` of all
 * N + 1 are: those after them must be factorised already. Returns 0 on failure. */
static int qp_factor(struct qp *restrict s, const double *restrict barrier, int stages)
{
    if (stages > N) {
        memcpy(s->P[N], s->Q[N], sizeof s->P[N]);
        for (int i = 0; barrier && i < NX; ++i)
            s->P[N][i][i] += STATE(barrier, N)[i];
    }
    for (int k = (stages < N ? stages : N) - 1; k >= 0; --k)
        if (!riccati_stage(s, k, barrier))
            return 0;
    return FREE_INITIAL ? ldl_state((const double (*)[WIDTH])s->P[0], s->P0_L, s->P0_D) : 1;
}

/* Backward: gradients p of the cost to go (written to pi) and feedforward inputs. */
static inline void solve_backward(const struct qp *restrict s, const double *restrict g, const double (*restrict c)[NX],
                                  double *restrict p, double (*restrict feedforward)[NU])
{
    pack after[PACKS];

    read_vector(after, STATE(g, N));
    write_vector(STATE(p, N), after);
    for (int k = N - 1; k >= 0; --k) {
        const double *r = INPUT(g, k);
        double h[WIDTH], u[NU];
        pack sum[PACKS];

        EACH_PACK(b)
            sum[b] = c[k][0] * read_pack(s->P[k + 1][0], b);
        for (int j = 1; j < NX; ++j)
            add_row(sum, c[k][j], s->P[k + 1][j]);
        EACH_PACK(b)
            sum[b] += after[b];
        write_row(h, sum);
        for (int a = 0; a < NU; ++a) {
            u[a] = -r[a];
            for (int m = 0; m < ND; ++m)
                u[a] -= s->B[k][m][a] * h[m];
        }
        read_vector(after, STATE(g, k));
        EACH_PACK(b)
            after[b] += mask_from(NA, b) * sum[b];
        for (int m = 0; m < NA; ++m)
            add_row(after, h[m], s->A[k][m]);
        for (int a = 0; a < NU; ++a)
            add_row(after, -u[a], s->K[k][a]);
        write_vector(STATE(p, k), after);
        ldl_input_solve((const double (*)[NU])s->L[k], s->D[k], u);
        memcpy(feedforward[k], u, sizeof u);
    }
}

/* Write the state `now` of a stage and its multiplier P x + p; x becomes the state as packs. */
static inline void state_and_multiplier(const struct qp *restrict s, int k, const double *now, const double *p, pack *restrict x,
                                        double *restrict z, double *pi)
{
    pack multiplier[PACKS];

    read_vector(x, now);
    write_vector(STATE(z, k), x);
    read_vector(multiplier, p);
    for (int j = 0; j < NX; ++j)
        add_row(multiplier, now[j], s->P[k][j]);
    write_vector(STATE(pi, k), multiplier);
}

/* Move a state, `now`, on by one stage; x holds it as well. */
static inline void state_after(const struct qp *restrict s, int k, const double *restrict c, const pack *restrict x,
                               const double *restrict u, double *restrict now)
{
    double next[NX];

    for (int i = 0; i < ND; ++i) {
        next[i] = i < NA ? add_dot(c[i], s->A[k][i], x) : c[i] + now[i];
        for (int a = 0; a < NU; ++a)
            next[i] += s->B[k][i][a] * u[a];
    }
    for (int i = ND; i < NX; ++i)
        next[i] = c[i] + now[i];
    memcpy(now, next, sizeof next);
}

/* Forward: states, inputs, and multipliers P x + p in the place of p. */
static inline void solve_forward(const struct qp *restrict s, const double (*restrict feedforward)[NU],
                                 const double (*restrict c)[NX], double *restrict now, double *restrict z,
                                 double *restrict pi)
{
    for (int k = 0; k <= N; ++k) {
        double u[NU];
        pack x[PACKS];

        state_and_multiplier(s, k, now, STATE(pi, k), x, z, pi);
        if (k == N)
            break;
        for (int a = 0; a < NU; ++a)
            INPUT(z, k)[a] = u[a] = add_dot(feedforward[k][a], s->K[k][a], x);
        state_after(s, k, c[k], x, u, now);
    }
}

/* Solve the factorised problem for gradient g, defects c and initial state; writes z and the multipliers pi. */
static void qp_solve(const struct qp *restrict s, const double *restrict g, const double (*restrict c)[NX],
                     const double *restrict initial, double *restrict z, double *restrict pi)
{
    double feedforward[N][NU], first[NX];

    solve_backward(s, g, c, pi, feedforward);
    for (int i = 0; i < NX; ++i)
        first[i] = FREE_INITIAL ? -pi[i] : initial[i];
    if (FREE_INITIAL)
        ldl_state_solve((const double (*)[NX])s->P0_L, s->P0_D, first);
    solve_forward(s, (const double (*)[NU])feedforward, c, first, z, pi);
}

#endif

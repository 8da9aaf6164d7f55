/* Structured quadratic program of control and estimation, and its factorisation.
 *
 *     min   sum_k 1/2 [x_k; u_k]' [Q_k S_k'; S_k R_k] [x_k; u_k] + q_k' x_k + r_k' u_k        (stage N: x only)
 *     s.t.  x_{k+1} = A_k x_k + B_k u_k + c_k,   x_0 given (or free: FREE_INITIAL, arrival cost in Q_0, q_0)
 *           lower <= z_i <= upper for the bounded variables i, hard or soft
 *
 * Riccati recursion as in Rao, Wright and Rawlings (1998), section 4; cost linear in N. The including unit defines
 * N (stages), NX, NU, NB (bounded variables), NC (trailing states that are constant: rows [0 I] of A) and
 * FREE_INITIAL. No heap, no recursion, every loop bounded.
 */
#ifndef DRAWBAR_QP_H
#define DRAWBAR_QP_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define ND (NX - NC)                      /* states with dynamics */
#define NZ ((N + 1) * NX + N * NU)        /* all variables: every x, then every u */
#define NSIDES (2 * NB)                   /* each bounded variable has a lower and an upper side */
#define AT_LEAST_ONE(n) ((n) > 0 ? (n) : 1)
#define WIDTH (NX > 4 ? (NX + 3) / 4 * 4 : NX)   /* row length padded to whole SIMD registers */

#define STATE(z, k) ((z) + (k) * NX)
#define INPUT(z, k) ((z) + (N + 1) * NX + (k) * NU)

enum qp_status { SOLVED, MAXIMUM_ITERATIONS, INFEASIBLE, NOT_FINITE, CHECK_FAILED, BAD_INPUT };

struct qp {
    /* problem */
    double Q[N + 1][NX][NX], S[N][NU][NX], R[N][NU][NU];
    double A[N][NX][NX], B[N][NX][NU], c[N][NX];
    double g[NZ];                          /* q_0 .. q_N, r_0 .. r_{N-1} */
    double initial[NX];                    /* x_0 where it is given */
    double lower[AT_LEAST_ONE(NB)], upper[AT_LEAST_ONE(NB)];   /* infinite: none */
    double soft_linear[AT_LEAST_ONE(NB)], soft_quadratic[AT_LEAST_ONE(NB)];  /* cost of a violation; infinite: hard */
    int32_t bound[AT_LEAST_ONE(NB)];       /* index into z of each bounded variable */
    /* solution */
    double z[NZ], pi[(N + 1) * NX];        /* pi_k multiplies x_k's equation */
    double multiplier[AT_LEAST_ONE(NSIDES)], violation[AT_LEAST_ONE(NSIDES)];
    double kkt;                            /* relative KKT residual, from kkt.h */
    int32_t status, iterations, factored;  /* factored: P, K, L, D belong to Q, R, S, A, B without a barrier */
    /* factorisation */
    double P[N + 1][NX][NX], K[N][NU][NX], L[N][NU][NU], D[N][NU];
    double P0_L[NX][NX], P0_D[NX];
};

/* L D L' of a symmetric matrix (lower triangle read; D holds reciprocals); returns 0 when it is not positive definite.
 * The solution routine works on rows of length `columns`, so that many right-hand sides are solved side by side. */
#define DEFINE_LDL(name, n)                                                                   \
    static inline int name(const double (*restrict M)[n], double (*restrict L)[n], double *restrict D) \
    {                                                                                         \
        double W[n][n];                                                                       \
        for (int j = 0; j < (n); ++j) {                                                       \
            double d = M[j][j];                                                               \
            for (int k = 0; k < j; ++k)                                                       \
                d -= L[j][k] * W[j][k];                                                       \
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
    static inline void name##_solve(const double (*restrict L)[n], const double *restrict D,  \
                                    double *restrict v, int columns)                          \
    {                                                                                         \
        for (int i = 1; i < (n); ++i)                                                         \
            for (int k = 0; k < i; ++k)                                                       \
                for (int j = 0; j < columns; ++j)                                             \
                    v[i * columns + j] -= L[i][k] * v[k * columns + j];                       \
        for (int i = 0; i < (n); ++i)                                                         \
            for (int j = 0; j < columns; ++j)                                                 \
                v[i * columns + j] *= D[i];                                                   \
        for (int i = (n) - 2; i >= 0; --i)                                                    \
            for (int k = i + 1; k < (n); ++k)                                                 \
                for (int j = 0; j < columns; ++j)                                             \
                    v[i * columns + j] -= L[k][i] * v[k * columns + j];                       \
    }

DEFINE_LDL(ldl_input, NU)
DEFINE_LDL(ldl_state, NX)

/* Copy rows of length NX into rows padded with zeros to whole SIMD registers. */
static inline void pad_rows(double (*restrict to)[WIDTH], const double (*restrict from)[NX], int rows)
{
    for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < NX; ++j)
            to[i][j] = from[i][j];
        for (int j = NX; j < WIDTH; ++j)
            to[i][j] = 0.0;
    }
}

/* One backward step: P comes in as that of stage k+1 and leaves as that of stage k, with K, L, D of stage k. */
static inline int riccati_stage(struct qp *restrict s, int k, const double *restrict barrier, double (*restrict P)[WIDTH])
{
    const double (*B)[NU] = (const double (*)[NU])s->B[k];
    double A[ND][WIDTH], PA[NX][WIDTH], PB[NX][NU], Huu[NU][NU], Hux[NU][WIDTH], V[NU][WIDTH];

    pad_rows(A, (const double (*)[NX])s->A[k], ND);
    pad_rows(Hux, (const double (*)[NX])s->S[k], NU);
    for (int i = 0; i < NX; ++i) {
        double row[WIDTH];
        for (int j = 0; j < WIDTH; ++j)
            row[j] = j < ND ? 0.0 : P[i][j];
        for (int m = 0; m < ND; ++m)
            for (int j = 0; j < WIDTH; ++j)
                row[j] += P[i][m] * A[m][j];
        memcpy(PA[i], row, sizeof row);
        for (int a = 0; a < NU; ++a) {
            double sum = 0.0;
            for (int m = 0; m < ND; ++m)
                sum += P[i][m] * B[m][a];
            PB[i][a] = sum;
        }
    }
    for (int a = 0; a < NU; ++a) {
        for (int b = 0; b < NU; ++b) {
            double sum = s->R[k][a][b];
            for (int m = 0; m < ND; ++m)
                sum += B[m][a] * PB[m][b];
            Huu[a][b] = sum;
        }
        for (int m = 0; m < ND; ++m)
            for (int j = 0; j < WIDTH; ++j)
                Hux[a][j] += B[m][a] * PA[m][j];
        if (barrier)
            Huu[a][a] += INPUT(barrier, k)[a];
    }
    if (!ldl_input((const double (*)[NU])Huu, s->L[k], s->D[k]))
        return 0;
    for (int a = 0; a < NU; ++a)
        for (int j = 0; j < WIDTH; ++j)
            V[a][j] = -Hux[a][j];
    ldl_input_solve((const double (*)[NU])s->L[k], s->D[k], V[0], WIDTH);
    pad_rows(P, (const double (*)[NX])s->Q[k], NX);
    for (int i = 0; i < NX; ++i) {
        double row[WIDTH];
        for (int j = 0; j < WIDTH; ++j)
            row[j] = P[i][j] + (i < ND ? 0.0 : PA[i][j]);
        for (int m = 0; m < ND; ++m)
            for (int j = 0; j < WIDTH; ++j)
                row[j] += A[m][i] * PA[m][j];
        for (int a = 0; a < NU; ++a)
            for (int j = 0; j < WIDTH; ++j)
                row[j] += Hux[a][i] * V[a][j];
        memcpy(P[i], row, sizeof row);
        if (barrier)
            P[i][i] += STATE(barrier, k)[i];
    }
    for (int i = 1; i < NX; ++i)           /* rounding must not make P asymmetric */
        for (int j = 0; j < i; ++j)
            P[i][j] = P[j][i];
    for (int i = 0; i < NX; ++i)
        memcpy(s->P[k][i], P[i], sizeof s->P[k][i]);
    for (int a = 0; a < NU; ++a)
        memcpy(s->K[k][a], V[a], sizeof s->K[k][a]);
    return 1;
}

/* Factorise the KKT matrix; barrier (or NULL) is added to the diagonal of the Hessian. Returns 0 on failure. */
static int qp_factor(struct qp *restrict s, const double *restrict barrier)
{
    double P[NX][WIDTH];

    memcpy(s->P[N], s->Q[N], sizeof s->P[N]);
    if (barrier)
        for (int i = 0; i < NX; ++i)
            s->P[N][i][i] += STATE(barrier, N)[i];
    pad_rows(P, (const double (*)[NX])s->P[N], NX);
    for (int k = N - 1; k >= 0; --k)
        if (!riccati_stage(s, k, barrier, P))
            return 0;
    return FREE_INITIAL ? ldl_state((const double (*)[NX])s->P[0], s->P0_L, s->P0_D) : 1;
}

/* following = A_k x + B_k u + c */
static inline void transition(const struct qp *restrict s, int k, const double *restrict c, const double *restrict x,
                              const double *restrict u, double *restrict following)
{
    for (int i = 0; i < ND; ++i) {
        double sum = c[i];
        for (int j = 0; j < NX; ++j)
            sum += s->A[k][i][j] * x[j];
        for (int a = 0; a < NU; ++a)
            sum += s->B[k][i][a] * u[a];
        following[i] = sum;
    }
    for (int i = ND; i < NX; ++i)
        following[i] = c[i] + x[i];
}

/* Solve the factorised problem for gradient g, defects c and initial state; writes z and the multipliers pi. */
static void qp_solve(const struct qp *restrict s, const double *restrict g, const double (*restrict c)[NX],
                     const double *restrict initial, double *restrict z, double *restrict pi)
{
    double p[N + 1][NX], k_ff[N][NU], x[NX];

    memcpy(p[N], STATE(g, N), sizeof p[N]);
    for (int k = N - 1; k >= 0; --k) {
        double h[NX], next[NX], r[NU];
        memcpy(h, p[k + 1], sizeof h);
        for (int j = 0; j < NX; ++j)
            for (int i = 0; i < NX; ++i)
                h[i] += s->P[k + 1][j][i] * c[k][j];
        for (int a = 0; a < NU; ++a)
            r[a] = INPUT(g, k)[a];
        for (int m = 0; m < ND; ++m)
            for (int a = 0; a < NU; ++a)
                r[a] += s->B[k][m][a] * h[m];
        for (int i = 0; i < NX; ++i)
            next[i] = STATE(g, k)[i] + (i < ND ? 0.0 : h[i]);
        for (int m = 0; m < ND; ++m)
            for (int i = 0; i < NX; ++i)
                next[i] += s->A[k][m][i] * h[m];
        for (int a = 0; a < NU; ++a)
            for (int i = 0; i < NX; ++i)
                next[i] += s->K[k][a][i] * r[a];
        memcpy(p[k], next, sizeof next);
        for (int a = 0; a < NU; ++a)
            r[a] = -r[a];
        ldl_input_solve((const double (*)[NU])s->L[k], s->D[k], r, 1);
        memcpy(k_ff[k], r, sizeof r);
    }
    for (int i = 0; i < NX; ++i)
        x[i] = FREE_INITIAL ? -p[0][i] : initial[i];
    if (FREE_INITIAL)
        ldl_state_solve((const double (*)[NX])s->P0_L, s->P0_D, x, 1);
    for (int k = 0; k <= N; ++k) {
        double multiplier[NX], following[NX], u[NU];
        memcpy(STATE(z, k), x, sizeof x);
        memcpy(multiplier, p[k], sizeof multiplier);
        for (int j = 0; j < NX; ++j)
            for (int i = 0; i < NX; ++i)
                multiplier[i] += s->P[k][j][i] * x[j];
        memcpy(STATE(pi, k), multiplier, sizeof multiplier);
        if (k == N)
            break;
        for (int a = 0; a < NU; ++a) {
            u[a] = k_ff[k][a];
            for (int j = 0; j < NX; ++j)
                u[a] += s->K[k][a][j] * x[j];
        }
        transition(s, k, c[k], x, u, following);
        memcpy(INPUT(z, k), u, sizeof u);
        memcpy(x, following, sizeof x);
    }
}

#endif

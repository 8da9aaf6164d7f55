/* Arrival cost by the smoothed extended Kalman filter update in square-root information form.
 *
 * Kuehl, Diehl, Kraus, Schloeder, Bock (2011): linearise dynamics and outputs at the oldest stage's smoothed estimate,
 * triangularise, and what remains on the next state is the new prior. The noise enters as G n with unit n (Bierman
 * 1977, square-root information filter), so that zero process noise is exact rather than an infinite weight:
 *
 *     || R (x_0 - prior) ||^2 + || sqrt(W) (y - h) ||^2 + || n ||^2,   x_1 = F + A dx + B du + G n
 */
#ifndef DRAWBAR_ARRIVAL_H
#define DRAWBAR_ARRIVAL_H

#include "rti.h"

#define OLD (NX + NU + 1)                  /* columns: dx, du, right-hand side */
#define OLD_WIDTH ((OLD + 3) / 4 * 4)
#define NEW (2 * NX + NU + 1)              /* columns: n, du, d = x_1 - F, right-hand side */
#define NEW_WIDTH ((NEW + 3) / 4 * 4)

/* Householder reflection of rows pivot and first .. last - 1 of M that clears `column` below the pivot. All columns
 * are swept, since those already cleared stay zero and a constant length runs in SIMD registers. */
#define DEFINE_REFLECTION(name, width)                                                          \
    static inline void name(double (*restrict M)[width], int pivot, int first, int last, int column) \
    {                                                                                           \
        double norm = M[pivot][column] * M[pivot][column], product[width];                      \
        for (int i = first; i < last; ++i)                                                      \
            norm += M[i][column] * M[i][column];                                                \
        if (!(norm > 0.0))                                                                      \
            return;                                                                             \
        const double alpha = M[pivot][column] > 0.0 ? -sqrt(norm) : sqrt(norm);                 \
        const double v = M[pivot][column] - alpha, beta = -1.0 / (alpha * v);                   \
        for (int j = 0; j < (width); ++j)                                                       \
            product[j] = v * M[pivot][j];                                                       \
        for (int i = first; i < last; ++i)                                                      \
            for (int j = 0; j < (width); ++j)                                                   \
                product[j] += M[i][column] * M[i][j];                                           \
        for (int j = 0; j < (width); ++j) {                                                     \
            product[j] *= beta;                                                                 \
            M[pivot][j] -= v * product[j];                                                      \
        }                                                                                       \
        for (int i = first; i < last; ++i) {                                                    \
            const double own = M[i][column];                                                    \
            for (int j = 0; j < (width); ++j)                                                   \
                M[i][j] -= own * product[j];                                                    \
            M[i][column] = 0.0;                                                                 \
        }                                                                                       \
        M[pivot][column] = alpha;                                                               \
    }

DEFINE_REFLECTION(reflect_old, OLD_WIDTH)
DEFINE_REFLECTION(reflect_new, NEW_WIDTH)

/* Triangularise prior and oldest measurements over (dx, du): NX rows on dx, then NU rows on du alone. */
static inline void arrival_measure(const struct rti *restrict s, double (*restrict T)[OLD_WIDTH])
{
    for (int i = 0; i < NX; ++i)
        for (int j = i; j < NX; ++j) {
            T[i][j] = s->root[i][j];
            T[i][OLD - 1] += s->root[i][j] * (s->prior[j] - s->z[j]);
        }
    for (int i = 0; i < NY; ++i) {
        const double scale = sqrt(s->wm[0][i]);
        for (int j = 0; j < NX + NU; ++j)
            T[NX + i][j] = scale * s->J[0][i][j];
        T[NX + i][OLD - 1] = scale * (s->ym[0][i] - s->h[0][i]);
    }
    for (int j = 0; j < NX; ++j)
        reflect_old(T, j, NX, NX + NY, j);
    for (int a = 0; a < NU; ++a)
        reflect_old(T, NX + a, NX + a + 1, NX + NY, NX + a);
}

/* Z = T A^-1 for A = [A1 A2; 0 I], by LU with partial pivoting of A1', all rows of T side by side. */
static inline int arrival_transition(const double (*restrict A)[NX], const double (*restrict T)[OLD_WIDTH],
                                     double (*restrict Z)[WIDTH])
{
    double M[ND][ND], X[ND][WIDTH];        /* A1' X = T1', columns of X are rows of Z1 */

    for (int i = 0; i < ND; ++i) {
        for (int j = 0; j < ND; ++j)
            M[i][j] = A[j][i];
        for (int r = 0; r < WIDTH; ++r)
            X[i][r] = r < NX ? T[r][i] : 0.0;
    }
    for (int j = 0; j < ND; ++j) {
        int pivot = j;
        for (int i = j + 1; i < ND; ++i)
            pivot = fabs(M[i][j]) > fabs(M[pivot][j]) ? i : pivot;
        if (!(fabs(M[pivot][j]) > 1e-12))
            return 0;
        if (pivot != j) {
            double row[ND], side[WIDTH];
            memcpy(row, M[j], sizeof row);
            memcpy(M[j], M[pivot], sizeof row);
            memcpy(M[pivot], row, sizeof row);
            memcpy(side, X[j], sizeof side);
            memcpy(X[j], X[pivot], sizeof side);
            memcpy(X[pivot], side, sizeof side);
        }
        const double inverse = 1.0 / M[j][j];
        for (int i = j + 1; i < ND; ++i) {
            const double factor = M[i][j] * inverse;
            if (factor == 0.0)
                continue;
            for (int k = j; k < ND; ++k)
                M[i][k] -= factor * M[j][k];
            for (int r = 0; r < WIDTH; ++r)
                X[i][r] -= factor * X[j][r];
        }
        M[j][j] = inverse;
    }
    for (int j = ND - 1; j >= 0; --j) {
        for (int k = j + 1; k < ND; ++k)
            for (int r = 0; r < WIDTH; ++r)
                X[j][r] -= M[j][k] * X[k][r];
        for (int r = 0; r < WIDTH; ++r)
            X[j][r] *= M[j][j];
    }
    for (int i = 0; i < NX; ++i) {
        for (int j = 0; j < WIDTH; ++j)
            Z[i][j] = j < ND ? X[j < ND ? j : 0][i] : j < NX ? T[i][j] : 0.0;
        for (int m = 0; m < ND; ++m)
            for (int j = ND; j < NX; ++j)
                Z[i][j] -= X[m][i] * A[m][j];
    }
    return 1;
}

/* Absorb the oldest stage into the arrival cost; call after feedback, before rti_shift. */
static int arrival_update(struct rti *s)
{
    double T[NX + NY][OLD_WIDTH] = {{0.0}}, M[2 * NX + NU][NEW_WIDTH] = {{0.0}}, Z[NX][WIDTH], d[NX];

    dynamics(s, 0, 1);
    outputs(s, 0, 1);
    arrival_measure(s, T);
    if (!arrival_transition((const double (*)[NX])s->qp.A[0], (const double (*)[OLD_WIDTH])T, Z))
        return NOT_FINITE;
    for (int i = 0; i < NX; ++i) {         /* R dx with dx = A^-1 (d - B du - G n), below the unit rows of n */
        double *row = M[NX + i];
        M[i][i] = 1.0;
        for (int j = 0; j < NX; ++j) {
            row[j] = -Z[i][j] * s->process[j];
            row[NX + NU + j] = Z[i][j];
        }
        for (int a = 0; a < NU; ++a) {
            row[NX + a] = T[i][NX + a];
            for (int m = 0; m < ND; ++m)
                row[NX + a] -= Z[i][m] * s->qp.B[0][m][a];
        }
        row[NEW - 1] = T[i][OLD - 1];
    }
    for (int a = 0; a < NU; ++a) {
        for (int b = a; b < NU; ++b)
            M[2 * NX + a][NX + b] = T[NX + a][NX + b];
        M[2 * NX + a][NEW - 1] = T[NX + a][OLD - 1];
    }
    for (int j = 0; j < NX; ++j)
        if (s->process[j] > 0.0)
            reflect_new(M, j, NX, 2 * NX, j);
    for (int a = 0; a < NU; ++a)           /* the rows that du claims are the last ones */
        reflect_new(M, 2 * NX + NU - 1 - a, NX, 2 * NX + NU - 1 - a, NX + a);
    for (int j = 0; j < NX; ++j)
        reflect_new(M, NX + j, NX + j + 1, 2 * NX, NX + NU + j);
    for (int i = NX - 1; i >= 0; --i) {
        const double *row = M[NX + i] + NX + NU;
        double sum = M[NX + i][NEW - 1];
        for (int j = i + 1; j < NX; ++j)
            sum -= row[j] * d[j];
        d[i] = sum / row[i];
    }
    if (!all_finite(d, NX))
        return NOT_FINITE;
    for (int i = 0; i < NX; ++i) {
        s->prior[i] = s->F[0][i] + d[i];
        memset(s->root[i], 0, i * sizeof(double));
        memcpy(s->root[i] + i, M[NX + i] + NX + NU + i, (NX - i) * sizeof(double));
    }
    return SOLVED;
}

#endif

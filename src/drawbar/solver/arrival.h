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

#define OLD (NX + NU + 1)                  /* columns: dx, du, right-hand side; or du, d = x_1 - F, right-hand side */
#define OLD_PACKS ((OLD + PACK - 1) / PACK)
#define OLD_WIDTH (OLD_PACKS * PACK)
#if defined(__GNUC__)
#define APART __attribute__((noinline))    /* its matrices shall not lie on the stack beside those of the caller */
#else
#define APART
#endif

/* Generated: the Jacobian of the first stage's outputs, and h in the last column; what never changes by itself. */
static void output_constants(const struct rti *work, double (*rows)[OLD_WIDTH]);
static void outputs(const struct rti *work, double (*rows)[OLD_WIDTH], int first, int count);

/* Householder reflection of rows pivot and first .. last - 1 of M that clears `column`, of pack `from`, below the pivot.
 * Columns before it are cleared already: what is left of them below the pivots is never read. */
static inline void reflect(double (*restrict M)[OLD_WIDTH], int pivot, int first, int last, int column, int from)
{
    const double own = M[pivot][column];
    double norm = own * own, more = 0.0;
    pack product[OLD_PACKS], second[OLD_PACKS];
    int i = first;

    for (int b = from; b < OLD_PACKS; ++b) {
        product[b] = own * read_pack(M[pivot], b);
        second[b] = 0.0 * product[b];
    }
    for (; i + 1 < last; i += 2) {         /* two sums side by side: each waits for itself alone */
        const double one = M[i][column], two = M[i + 1][column];
        norm += one * one;
        more += two * two;
        for (int b = from; b < OLD_PACKS; ++b) {
            product[b] += one * read_pack(M[i], b);
            second[b] += two * read_pack(M[i + 1], b);
        }
    }
    if (i < last) {
        norm += M[i][column] * M[i][column];
        for (int b = from; b < OLD_PACKS; ++b)
            product[b] += M[i][column] * read_pack(M[i], b);
    }
    norm += more;
    if (!(norm > 0.0))
        return;
    const double alpha = own > 0.0 ? -sqrt(norm) : sqrt(norm);
    const double v = own - alpha, beta = -1.0 / (alpha * v);
    for (int b = from; b < OLD_PACKS; ++b) {
        const pack row = read_pack(M[pivot], b);
        product[b] = beta * (product[b] + second[b] - alpha * row);
        write_pack(M[pivot], b, row - v * product[b]);
    }
    for (i = first; i < last; ++i) {
        const double factor = M[i][column];
        for (int b = from; b < OLD_PACKS; ++b)
            write_pack(M[i], b, read_pack(M[i], b) - factor * product[b]);
    }
    M[pivot][column] = alpha;
}

/* Let row i be the only one but earlier rows that has column first + i, for all columns before `end`: rows `others` .. last
 * - 1 are cleared, and those between pivot and `others` have nothing there. The last rows of all may have nothing in the
 * first columns, as most of the measurements, and are left alone until they have. */
static inline void triangularise(double (*restrict M)[OLD_WIDTH], int first, int end, int others, int last)
{
    int reached = others;

    EACH_KNOWN for (int b = 0; b < OLD_PACKS; ++b)
        for (int j = b * PACK > first ? b * PACK : first; j < end && j < (b + 1) * PACK; ++j) {
            int row = last;
            while (row > reached && M[row - 1][j] == 0.0)
                --row;
            reached = row;
            reflect(M, j - first, j - first < others ? others : j - first + 1, reached, j, b);
        }
}

/* Let a unit noise n act through a vector g on the states of the NX rows M, given `along` = M g: || M d ||^2 becomes
 * its minimum over n of || M (d - g n) ||^2 + n^2, that is M' (I + along along')^-1 M (Potter 1963). */
static inline void widen(double (*restrict M)[OLD_WIDTH], const double *restrict along)
{
    double norm = 0.0;
    pack product[OLD_PACKS];

    for (int b = 0; b < OLD_PACKS; ++b)
        product[b] = 0.0 * read_pack(M[0], b);
    for (int i = 0; i < NX; ++i) {
        norm += along[i] * along[i];
        for (int b = 0; b < OLD_PACKS; ++b)
            product[b] += along[i] * read_pack(M[i], b);
    }
    if (norm == 0.0)
        return;
    const double root = sqrt(1.0 + norm);
    const double factor = 1.0 / (root * (1.0 + root)) + 0.0 * norm;   /* NaN where the norm overflows */
    for (int i = 0; i < NX; ++i)
        for (int b = 0; b < OLD_PACKS; ++b)
            write_pack(M[i], b, read_pack(M[i], b) - factor * along[i] * product[b]);
}

/* Let the process noise act on the states of the rows M over (du, d). */
static inline void arrival_widen(const struct rti *restrict s, double (*restrict M)[OLD_WIDTH])
{
    double along[NX];

    for (int j = 0; j < NX; ++j) {
        for (int i = 0; i < NX; ++i)
            along[i] = s->process[j] * M[i][NU + j];
        widen(M, along);
    }
    for (int i = 0; i < NX; ++i) {
        along[i] = 0.0;
        for (int j = 0; j < NX; ++j)
            along[i] += s->common[j] * M[i][NU + j];
    }
    widen(M, along);
}

/* Triangularise prior and oldest measurements over (dx, du): NX rows on dx, then NU rows on du alone. */
static inline void arrival_measure(const struct rti *restrict s, double (*restrict T)[OLD_WIDTH])
{
    output_constants(s, T + NX);
    outputs(s, T + NX, 0, 1);
    for (int i = 0; i < NX; ++i)
        for (int j = i; j < NX; ++j) {
            T[i][j] = s->root[i][j];
            T[i][OLD - 1] += s->root[i][j] * (s->prior[j] - s->z[j]);
        }
    for (int i = 0; i < NY; ++i) {
        const double scale = sqrt(rti_weight(s, 0, i));
        for (int j = 0; j < NX + NU; ++j)
            T[NX + i][j] *= scale;
        T[NX + i][OLD - 1] = scale * (rti_target(s, 0, i) - T[NX + i][OLD - 1]);
    }
    triangularise(T, 0, NX + NU, NX, NX + NY);
}

/* Z = T A^-1 for A = [A1 A2; 0 I], by LU with partial pivoting of A1', all rows of T side by side. */
static inline int arrival_transition(const double (*restrict A)[WIDTH], const double (*restrict T)[OLD_WIDTH],
                                     double (*restrict Z)[WIDTH])
{
    double M[ND][ND], X[ND][WIDTH];        /* A1' X = T1', columns of X are rows of Z1 */

    for (int i = 0; i < ND; ++i) {
        for (int j = 0; j < ND; ++j)
            M[i][j] = A[j][i];
        for (int r = 0; r < WIDTH; ++r)
            X[i][r] = r <= i ? T[r][i] : 0.0;
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
            Z[i][j] = j < ND ? X[j < ND ? j : 0][i] : i <= j && j < NX ? T[i][j] : 0.0;
        for (int m = 0; m < ND; ++m)
            for (int j = ND; j < NX; ++j)
                Z[i][j] -= X[m][i] * A[m][j];
    }
    return 1;
}

/* Write R dx with dx = A^-1 (d - B du), the rows of T and Z, over (du, d). */
static inline void arrival_substitute(const double (*restrict B)[NU], const double (*restrict T)[OLD_WIDTH],
                                      const double (*restrict Z)[WIDTH], double (*restrict M)[OLD_WIDTH])
{
    for (int i = 0; i < NX; ++i) {
        for (int a = 0; a < NU; ++a) {
            double sum = T[i][NX + a];
            for (int m = 0; m < ND; ++m)
                sum -= Z[i][m] * B[m][a];
            M[i][a] = sum;
        }
        for (int j = 0; j < NX; ++j)
            M[i][NU + j] = Z[i][j];
        M[i][OLD - 1] = T[i][OLD - 1];
    }
    for (int a = 0; a < NU; ++a) {
        for (int b = a; b < NU; ++b)
            M[NX + a][b] = T[NX + a][NX + b];
        M[NX + a][OLD - 1] = T[NX + a][OLD - 1];
    }
}

/* Absorb the oldest stage, linearised behind the last one, into the arrival cost, which stays as it is on failure. */
static APART int arrival_absorb(struct rti *s)
{
    double T[NX + NY][OLD_WIDTH] = {{0.0}}, M[NX + NU][OLD_WIDTH] = {{0.0}}, Z[NX][WIDTH], d[NX];

    arrival_measure(s, T);
    if (!arrival_transition((const double (*)[WIDTH])s->qp.A[N], (const double (*)[OLD_WIDTH])T, Z))
        return NOT_FINITE;
    arrival_substitute((const double (*)[NU])s->qp.B[N], (const double (*)[OLD_WIDTH])T, (const double (*)[WIDTH])Z, M);
    arrival_widen(s, M);
    for (int a = 0; a < NU; ++a)           /* the rows that du claims are the last ones */
        reflect(M, NX + NU - 1 - a, 0, NX + NU - 1 - a, a, a / PACK);
    triangularise(M, NU, NU + NX, 0, NX);
    for (int i = NX - 1; i >= 0; --i) {
        double sum = M[i][OLD - 1];
        for (int j = i + 1; j < NX; ++j)
            sum -= M[i][NU + j] * d[j];
        d[i] = sum / M[i][NU + i];
    }
    if (!all_finite(&M[0][0], sizeof M / sizeof(double)) || !all_finite(d, NX))
        return NOT_FINITE;
    for (int i = 0; i < NX; ++i) {
        s->prior[i] = s->qp.c[N][i] + d[i];
        memset(s->root[i], 0, (size_t)i * sizeof(double));
        memcpy(s->root[i] + i, M[i] + NU + i, (size_t)(NX - i) * sizeof(double));
    }
    return SOLVED;
}

/* Absorb the oldest stage; call after feedback, before rti_shift and the next rti_prepare, for which this linearises: the
 * lanes of its last stages have room for one more. */
static inline int arrival_update(struct rti *s)
{
    s->linearised = 1;
    dynamics(s, 0, N + 1);
    return arrival_absorb(s);
}

#endif

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

#include "noinline.h"
#include "rti.h"

#define OLD (NX + NU + 1)                  /* columns: dx, du, right-hand side; or du, d = x_1 - F, right-hand side */
#define OLD_PACKS ((OLD + PACK - 1) / PACK)
#define OLD_WIDTH (OLD_PACKS * PACK)

/* Generated: the Jacobian of the first stage's outputs, and h in the last column; what never changes by itself. */
static void output_constants(const struct rti *work, double (*rows)[OLD_WIDTH]);
static void outputs(const struct rti *work, double (*rows)[OLD_WIDTH], int first, int count);

/* Householder reflection of rows pivot and first .. last - 1 of M that clears column `pivot`, of pack `from`, in the
 * latter. Columns before it are cleared already: what is left of them below the pivots is never read. */
static inline void reflect(double (*restrict M)[OLD_WIDTH], int first, int last, int pivot, int from)
{
    const double own = M[pivot][pivot];
    double norm = own * own, more = 0.0;
    pack product[OLD_PACKS], second[OLD_PACKS];
    int i = first;

    if (first >= last)
        return;
    for (int b = from; b < OLD_PACKS; ++b) {
        product[b] = own * read_pack(M[pivot], b);
        second[b] = 0.0 * product[b];
    }
    for (; i + 1 < last; i += 2) {         /* two sums side by side: each waits for itself alone */
        const double one = M[i][pivot], two = M[i + 1][pivot];
        norm += one * one;
        more += two * two;
        for (int b = from; b < OLD_PACKS; ++b) {
            product[b] += one * read_pack(M[i], b);
            second[b] += two * read_pack(M[i + 1], b);
        }
    }
    if (i < last) {
        norm += M[i][pivot] * M[i][pivot];
        for (int b = from; b < OLD_PACKS; ++b)
            product[b] += M[i][pivot] * read_pack(M[i], b);
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
        const double factor = M[i][pivot];
        for (int b = from; b < OLD_PACKS; ++b)
            write_pack(M[i], b, read_pack(M[i], b) - factor * product[b]);
    }
    M[pivot][pivot] = alpha;
}

/* Let row i be the only one but earlier rows that has column i, for all columns before `end`: rows `others` .. last - 1
 * are cleared, and those between pivot and `others` have nothing there. The last rows of all may have nothing in the
 * first columns, as most of the measurements, and are left alone until they have. */
static inline void triangularise(double (*restrict M)[OLD_WIDTH], int end, int others, int last)
{
    int reached = others;

    EACH_KNOWN for (int b = 0; b < OLD_PACKS; ++b)
        for (int j = b * PACK; j < end && j < (b + 1) * PACK; ++j) {
            int row = last;
            while (row > reached && M[row - 1][j] == 0.0)
                --row;
            reached = row;
            reflect(M, j < others ? others : j + 1, reached, j, b);
        }
}

/* Minimise over one more variable n, whose coefficients in the upper triangular rows sqrt(weight[i]) M[i] are
 * sqrt(weight[i]) along[i]. A row of its own knows sqrt(norm) n; `sum` is the rest of that row, times sqrt(norm). From the
 * last row up, rotations without square roots (Gentleman 1973) turn n out of each into that row: all stay triangular. */
static inline void eliminate(double (*restrict M)[OLD_WIDTH], double *restrict weight, const double *restrict along,
                             int rows, double norm, pack *restrict sum)
{
    double inverse = norm > 0.0 ? 1.0 / norm : 0.0;

    EACH_KNOWN for (int c = PACKS - 1; c >= 0; --c)
        for (int i = (rows < PACK_END(c) ? rows : PACK_END(c)) - 1; i >= c * PACK; --i) {
            const double own = weight[i] * along[i], gain = along[i] * inverse, before = norm;
            norm += own * along[i];
            if (norm == 0.0)
                continue;
            inverse = 1.0 / norm + 0.0 * norm;                 /* NaN where the norm overflows */
            weight[i] *= before * inverse;
            for (int b = c; b < OLD_PACKS; ++b) {
                const pack row = read_pack(M[i], b);
                write_pack(M[i], b, row - gain * sum[b]);
                sum[b] += own * row;
            }
        }
}

/* Minimise over the inputs, of which the rows behind those of the states know. */
static inline void arrival_inputs(double (*restrict T)[OLD_WIDTH], double *restrict weight)
{
    for (int a = 0; a < NU; ++a) {
        const double own = T[NX + a][NX + a];
        double along[NX];
        pack sum[OLD_PACKS];

        for (int b = 0; b < OLD_PACKS; ++b)
            sum[b] = own * read_pack(T[NX + a], b);
        for (int i = 0; i < NX; ++i)
            along[i] = T[i][NX + a];
        eliminate(T, weight, along, NX, own * own, sum);
    }
}

/* Let the process noise act on the states: for each unit noise n, d becomes d - g n, and n^2 is added. */
static inline void arrival_widen(const struct rti *restrict s, double (*restrict T)[OLD_WIDTH], double *restrict weight)
{
    double along[NX];
    pack sum[OLD_PACKS];

    for (int j = 0; j < NX; ++j) {
        if (s->process[j] == 0.0)
            continue;
        for (int b = 0; b < OLD_PACKS; ++b)
            sum[b] = (pack){0};
        for (int i = 0; i <= j; ++i)
            along[i] = s->process[j] * T[i][j];
        eliminate(T, weight, along, j + 1, 1.0, sum);
    }
    for (int b = 0; b < OLD_PACKS; ++b)
        sum[b] = (pack){0};
    for (int i = 0; i < NX; ++i) {
        along[i] = 0.0;
        for (int j = i; j < NX; ++j)
            along[i] += s->common[j] * T[i][j];
    }
    eliminate(T, weight, along, NX, 1.0, sum);
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
        const double residual = rti_target(s, 0, i) - T[NX + i][OLD - 1];
        for (int b = 0; b < OLD_PACKS; ++b)
            write_pack(T[NX + i], b, scale * read_pack(T[NX + i], b));
        T[NX + i][OLD - 1] = scale * residual;
    }
    triangularise(T, NX + NU, NX, NX + NY);
}

/* Write the upper triangular rows T over (dx, du) as such rows over (d, du), dx = A^-1 (d - B du): by LU with partial
 * pivoting of A1' for A = [A1 A2; 0 I], all rows that A1 changes side by side. */
static inline int arrival_transition(const double (*restrict A)[WIDTH], const double (*restrict B)[NU],
                                     double (*restrict T)[OLD_WIDTH])
{
    double M[AT_LEAST_ONE(NA)][AT_LEAST_ONE(NA)], X[AT_LEAST_ONE(NA)][AT_LEAST_ONE(NA)];   /* A1' X = T1' */

    for (int i = 0; i < NA; ++i)
        for (int j = 0; j < NA; ++j) {
            M[i][j] = A[j][i];
            X[i][j] = j <= i ? T[j][i] : 0.0;
        }
    for (int j = 0; j < NA; ++j) {
        int pivot = j;
        for (int i = j + 1; i < NA; ++i)
            pivot = fabs(M[i][j]) > fabs(M[pivot][j]) ? i : pivot;
        if (!(fabs(M[pivot][j]) > 1e-12))
            return 0;
        for (int k = 0; pivot != j && k < NA; ++k) {
            const double entry = M[j][k], side = X[j][k];
            M[j][k] = M[pivot][k];
            M[pivot][k] = entry;
            X[j][k] = X[pivot][k];
            X[pivot][k] = side;
        }
        const double inverse = 1.0 / M[j][j];
        for (int i = j + 1; i < NA; ++i) {
            const double factor = M[i][j] * inverse;
            if (factor == 0.0)
                continue;
            for (int k = j; k < NA; ++k)
                M[i][k] -= factor * M[j][k];
            for (int r = 0; r < NA; ++r)
                X[i][r] -= factor * X[j][r];
        }
        M[j][j] = inverse;
    }
    for (int j = NA - 1; j >= 0; --j) {
        for (int k = j + 1; k < NA; ++k)
            for (int r = 0; r < NA; ++r)
                X[j][r] -= M[j][k] * X[k][r];
        for (int r = 0; r < NA; ++r)
            X[j][r] *= M[j][j];
    }
    for (int i = 0; i < NA; ++i)
        for (int m = 0; m < NA; ++m) {
            T[i][m] = X[m][i];
            for (int j = NA; j < NX; ++j)
                T[i][j] -= X[m][i] * A[m][j];
        }
    for (int i = 0; i < ND; ++i)
        for (int a = 0; a < NU; ++a)
            for (int m = i < NA ? 0 : i; m < ND; ++m)
                T[i][NX + a] -= T[i][m] * B[m][a];
    triangularise(T, NA - 1, 0, NA);
    return 1;
}

/* Absorb the oldest stage, linearised behind the last one, into the arrival cost, which stays as it is on failure. */
static NOINLINE int arrival_absorb(struct rti *s)
{
    double T[NX + NY][OLD_WIDTH] = {{0.0}}, weight[NX], d[NX];

    for (int i = 0; i < NX; ++i)
        weight[i] = 1.0;
    arrival_measure(s, T);
    if (!arrival_transition((const double (*)[WIDTH])s->qp.A[N], (const double (*)[NU])s->qp.B[N], T))
        return NOT_FINITE;
    arrival_inputs(T, weight);
    arrival_widen(s, T, weight);
    for (int i = NX - 1; i >= 0; --i) {
        double sum = T[i][OLD - 1];
        for (int j = i + 1; j < NX; ++j)
            sum -= T[i][j] * d[j];
        d[i] = T[i][i] == 0.0 ? 0.0 : sum / T[i][i];   /* nothing is known of it: as predicted */
    }
    if (!all_finite(&T[0][0], NX * OLD_WIDTH) || !all_finite(weight, NX) || !all_finite(d, NX))
        return NOT_FINITE;
    for (int i = 0; i < NX; ++i) {
        const double root = sqrt(weight[i]);
        s->prior[i] = s->qp.c[N][i] + d[i];
        for (int j = i; j < NX; ++j)
            s->root[i][j] = root * T[i][j];
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

/* The extended Kalman filter in square-root array form (Kaminski, Bryson, Schmidt 1971; Kailath, Sayed, Hassibi 2000,
 * chapter 12): the covariance is R' R, and one QR factorisation moves R through each of the two phases, so that R' R
 * cannot lose its definiteness.
 *
 * States and parameters are one state x. The inputs are measured too; their errors enter the prediction as noise through
 * dF/du. The including unit defines NX, NU, NY and CONSTANTS, and after this header what evaluates the discretised model
 * at x, u: transition (F, A = dF/dx, B = dF/du), output (h, C = dh/dx) and filter_constants, which lays down the entries
 * of A, B, C that x and u do not change, once the constants are set.
 */
#ifndef DRAWBAR_SQUARE_ROOT_FILTER_H
#define DRAWBAR_SQUARE_ROOT_FILTER_H

#define COLUMNS (NY + NX)

#include <stdint.h>
#include <string.h>

#include "householder.h"
#include "lanes.h"
#include "status.h"

struct filter {
    /* settings */
    double constants[CONSTANTS];           /* of the model, and the sample time, s */
    double prior[NX];                      /* standard deviations of the first state */
    double drift[NX], common[NX];          /* those of the process noise per sample: of each state alone, and of one
                                            * noise that moves all of them at once */
    double noise[NY];                      /* standard deviation of each output */
    double lower[NX], upper[NX];           /* bounds of the state, infinite where there are none */
    int32_t input_row[NU];                 /* the output by which each input is measured */
    /* state */
    double x[1][NX], u[1][NU];
    double R[NX][NX];                      /* upper triangular */
    /* the model */
    double F[1][NX], A[1][NX][NX], B[1][NX][NU], h[1][NY], C[1][NY][NX];
};

#define FILTER_FIELDS(type, prefix)                                                                          \
    SETTING(type, prefix constants, 0, CONSTANTS, 0, 0)                                                      \
    SETTING(type, prefix prior, 0, NX, 0, 0) SETTING(type, prefix drift, 0, NX, 0, 0)                        \
    SETTING(type, prefix common, 0, NX, 0, 0)                                                                \
    SETTING(type, prefix noise, 0, NY, 0, 0) SETTING(type, prefix lower, 0, NX, 0, 0)                        \
    SETTING(type, prefix upper, 0, NX, 0, 0) SETTING(type, prefix input_row, 1, NU, 0, 0)                    \
    FIELD(type, prefix x, 0, NX, 0, 0) FIELD(type, prefix R, 0, NX, NX, 0)

static void filter_constants(struct filter *work);
static void transition(struct filter *work, int first, int count);
static void output(struct filter *work, int first, int count);

/* Reset the covariance to the prior. */
static void filter_forget(struct filter *filter)
{
    memset(filter->R, 0, sizeof filter->R);
    for (int i = 0; i < NX; ++i)
        filter->R[i][i] = filter->prior[i];
}

/* What R makes of noise that goes through the Jacobian's row `slope`, as a column of M from row `first` on: R slope'. */
static inline void filter_project(const struct filter *filter, const double *slope, double (*M)[COLUMNS], int first,
                                  int column)
{
    for (int i = 0; i < NX; ++i)
        for (int j = i; j < NX; ++j)
            M[first + i][column] += filter->R[i][j] * slope[j];
}

/* Take over a state and the triangle of M that begins at row and column `first`, if both are finite. */
static int filter_accept(struct filter *filter, const double *x, double (*M)[COLUMNS], int first)
{
    int finite = 1;

    for (int i = 0; i < NX; ++i) {
        finite &= isfinite(x[i]) != 0;
        for (int j = i; j < NX; ++j)
            finite &= isfinite(M[first + i][first + j]) != 0;
    }
    if (!finite)
        return NOT_FINITE;
    for (int i = 0; i < NX; ++i) {
        filter->x[0][i] = x[i];
        memcpy(filter->R[i] + i, M[first + i] + first + i, (size_t)(NX - i) * sizeof(double));
    }
    return SOLVED;
}

/* Add the gain times the innovations: row i of the triangle is [X', (K X)'], and X X' the innovations' covariance. */
static inline void filter_innovate(double (*M)[COLUMNS], const double *innovation, double *x)
{
    double unit[NY];                       /* X^-1 innovation */

    for (int i = 0; i < NY; ++i) {
        unit[i] = innovation[i];
        for (int j = 0; j < i; ++j)
            unit[i] -= M[j][i] * unit[j];
        unit[i] /= M[i][i];
        for (int j = 0; j < NX; ++j)
            x[j] += M[i][NY + j] * unit[i];
    }
}

/* The triangle of [V, 0; R C', R], V the noise of the outputs, is [X', (K X)'; 0, R+]. Outputs that are not there have
 * a row of zeros for C, as those that measure inputs have by themselves: they change nothing. */
static int filter_correct(struct filter *filter, const double *y)
{
    double M[NY + NX][COLUMNS] = {{0.0}}, innovation[NY], x[NX];

    output(filter, 0, 1);
    memcpy(x, filter->x[0], sizeof x);
    for (int i = 0; i < NY; ++i) {
        M[i][i] = filter->noise[i];
        innovation[i] = isnan(y[i]) ? 0.0 : y[i] - filter->h[0][i];
        if (!isnan(y[i]))
            filter_project(filter, filter->C[0][i], M, NY, i);
    }
    for (int i = 0; i < NX; ++i)
        memcpy(M[NY + i] + NY, filter->R[i], sizeof filter->R[i]);
    for (int i = 0; i < NY; ++i)
        reflect_rows(M, i, NY, NY + NX, COLUMNS);
    for (int i = NY; i < NY + NX; ++i)
        reflect_rows(M, i, i + 1, NY + NX, COLUMNS);
    filter_innovate(M, innovation, x);
    return filter_accept(filter, x, M, NY);
}

/* Clip the state to its bounds (Simon 2010, section 2.4). */
static void filter_clip(struct filter *filter)
{
    for (int i = 0; i < NX; ++i)
        filter->x[0][i] = fmin(fmax(filter->x[0][i], filter->lower[i]), filter->upper[i]);
}

/* Take the inputs from the outputs y, where they are there. */
static void filter_hold(struct filter *filter, const double *y)
{
    for (int a = 0; a < NU; ++a) {
        const double newest = y[filter->input_row[a]];
        filter->u[0][a] = isnan(newest) ? filter->u[0][a] : newest;
    }
}

/* Move state and covariance by the outputs y that are there (NaN: missing); on failure both stay. */
static int filter_update(struct filter *filter, const double *y)
{
    filter_hold(filter, y);
    const int status = filter_correct(filter, y);
    if (status == SOLVED)
        filter_clip(filter);
    return status;
}

/* Move state and covariance by one sample: the triangle of [R A'; N B'; g'; G] is R+, N the noise of the inputs, g the
 * process noise that all states share and G that of each. On failure the state stays, and the covariance is reset
 * to the prior. */
static int filter_predict(struct filter *filter)
{
    double M[2 * NX + NU + 1][COLUMNS] = {{0.0}};

    transition(filter, 0, 1);
    for (int i = 0; i < NX; ++i) {
        filter_project(filter, filter->A[0][i], M, 0, i);
        for (int a = 0; a < NU; ++a)
            M[NX + a][i] = filter->B[0][i][a] * filter->noise[filter->input_row[a]];
        M[NX + NU][i] = filter->common[i];
        M[NX + NU + 1 + i][i] = filter->drift[i];
    }
    for (int i = 0; i < NX; ++i)           /* the later noises have not come into play yet */
        reflect_rows(M, i, i + 1, NX + NU + i + 2, NX);
    const int status = filter_accept(filter, filter->F[0], M, 0);
    if (status != SOLVED)
        filter_forget(filter);
    return status;
}

#endif

/* Householder's reflections for triangular arrays (Golub, Van Loan 2013, section 5.2), row by row.
 *
 * The including unit defines COLUMNS, the length of a row.
 */
#ifndef DRAWBAR_HOUSEHOLDER_H
#define DRAWBAR_HOUSEHOLDER_H

#include <float.h>
#include <math.h>

/* Reflect rows pivot and first .. last - 1 of M so that column `pivot` becomes zero in the latter. Columns from `columns`
 * on do not take part, nor those before the pivot, which are zero in these rows already. */
static inline void reflect_rows(double (*M)[COLUMNS], int pivot, int first, int last, int columns)
{
    const double own = M[pivot][pivot];
    double below = 0.0, product[COLUMNS];

    for (int i = first; i < last; ++i)
        below += M[i][pivot] * M[i][pivot];
    if (!(below >= DBL_MIN))               /* zero already; or NaN, which stays for the caller's check */
        return;
    const double norm = sqrt(own * own + below), alpha = own > 0.0 ? -norm : norm;
    const double v = own - alpha, beta = -1.0 / (alpha * v);
    for (int j = pivot; j < columns; ++j)
        product[j] = v * M[pivot][j];
    for (int i = first; i < last; ++i)
        for (int j = pivot; j < columns; ++j)
            product[j] += M[i][pivot] * M[i][j];
    for (int j = pivot; j < columns; ++j)
        M[pivot][j] -= beta * v * product[j];
    for (int i = first; i < last; ++i) {
        const double factor = beta * M[i][pivot];
        for (int j = pivot; j < columns; ++j)
            M[i][j] -= factor * product[j];
    }
}

#endif

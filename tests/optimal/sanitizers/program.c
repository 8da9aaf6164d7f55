/* Feeds the quadratic program on its own sane, extreme and senseless numbers. */
#include <stdio.h>
#include <stdlib.h>
#include "unit.c"
#include "random.h"

static struct workspace memory;
#define work memory.qp

static void fill(void)
{
    double *input = (double *)&work;
    const size_t count = offsetof(struct qp, bound) / sizeof(double);

    memset(&work, 0, sizeof work);
    numbers(input, (int)count, 1.0);
    for (int k = 0; k <= N; ++k)
        for (int i = 0; i < NX; ++i)
            for (int j = 0; j < NX; ++j)
                work.Q[k][i][j] = i == j ? magnitude(5.0) : 0.0;
    for (int k = 0; k < N; ++k)
        for (int i = 0; i < NU; ++i)
            for (int j = 0; j < NX; ++j) {
                work.S[k][i][j] = 0.0;
                if (j < NU)
                    work.R[k][i][j] = i == j ? magnitude(5.0) : 0.0;
            }
    for (int i = 0; i < NB; ++i) {
        const double width = one_in(5) ? 0.0 : magnitude(1.0), middle = uniform();
        work.bound[i] = one_in(500) ? (int32_t)pick(1 << 30) * (one_in(2) ? 1 : -1) : (int32_t)pick(NZ);
        work.lower[i] = middle - width;
        work.upper[i] = middle + width;
        work.soft_linear[i] = one_in(2) ? magnitude(100.0) : INFINITY;
        work.soft_quadratic[i] = magnitude(1.0);
    }
    if (one_in(2))
        for (size_t i = 0; i < count; ++i)
            disturb(&input[i], (int)count);
}

int main(void)
{
    static int counts[BAD_INPUT + 1];

    for (int call = 0; call < CALLS; ++call) {
        fill();
        const int status = solve(&memory);
        if (status < SOLVED || status > BAD_INPUT)
            fail("a status that is none", status);
        ++counts[status];
        if (status == SOLVED && !(all_finite(work.z, NZ) && work.kkt <= 1e-8))
            fail("numbers that are no solution were called solved", status);
        tell(counts, BAD_INPUT + 1);
    }
    return 0;
}

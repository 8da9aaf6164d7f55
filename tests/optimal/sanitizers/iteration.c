/* Feeds a generated unit (real-time iteration) sane, extreme and senseless numbers, many times over; a finding of the
 * sanitizers ends the program, and so does an answer called SOLVED that is none. */
#include <stdio.h>
#include <stdlib.h>
#include "unit.c"
#include "random.h"

static struct workspace memory;
static union bounds_work *const scratch = &memory.work;
#define work memory.component.rti

static void fill(void)
{
    const double spread = one_in(4) ? 1e3 : 1.0;

    memset(&memory.component, 0, sizeof memory.component);
    for (int i = 0; i < CONSTANTS; ++i)    /* lengths and a sample time */
        work.constants[i] = 0.1 + magnitude(1.0);
    lay_down(&work);
    numbers(work.z, NZ, spread);
    numbers(&work.p[0][0], (N + 1) * NP, 1.0);
    numbers(&work.y[0][0], (N + 1) * NY, spread);
    for (int i = 0; i < (N + 1) * NY; ++i)
        (&work.w[0][0])[i] = i >= N * NY ? 0.0 : magnitude(10.0);
    numbers(work.initial, NX, spread);
    numbers(work.prior, NX, spread);
    for (int i = 0; i < NX; ++i) {
        work.root[i][i] = magnitude(10.0);
        work.process[i] = one_in(3) ? 0.0 : magnitude(0.1);
    }
    for (int i = 0; i < NB; ++i) {
        const double width = one_in(5) ? 1e-3 : magnitude(2.0), middle = uniform() * spread;
        work.qp.bound[i] = one_in(20) ? (int32_t)pick(NZ) : NZ - NB + i;
        work.lower[i] = middle - width;
        work.upper[i] = middle + width;
        work.qp.soft_linear[i] = one_in(3) ? magnitude(100.0) : INFINITY;
    }
}

static void spoil(void)
{
    for (int i = 0; i < NZ; ++i)
        disturb(&work.z[i], NZ);
    for (int i = 0; i < (N + 1) * NP; ++i)
        disturb(&(&work.p[0][0])[i], (N + 1) * NP);
    for (int i = 0; i < (N + 1) * NY; ++i) {
        disturb(&(&work.y[0][0])[i], (N + 1) * NY);
        disturb(&(&work.w[0][0])[i], (N + 1) * NY);
    }
    for (int i = 0; i < NX; ++i) {
        disturb(&work.initial[i], NX);
        disturb(&work.prior[i], NX);
        disturb(&work.process[i], NX);
        disturb(&work.root[i][i], NX);
    }
    for (int i = 0; i < NB; ++i) {
        disturb(&work.lower[i], NB);
        disturb(&work.upper[i], NB);
        disturb(&work.qp.soft_linear[i], NB);
        disturb(&work.qp.soft_quadratic[i], NB);
    }
}

static void judge(int status, const double *before)
{
    static int counts[BAD_INPUT + 1];

    if (status < SOLVED || status > BAD_INPUT)
        fail("a status that is none", status);
    ++counts[status];
    if (status == SOLVED && !(all_finite(work.z, NZ) && work.qp.kkt <= 1e-8))
        fail("a trajectory that is no solution was called solved", status);
    if (status != SOLVED && memcmp(before, work.z, sizeof work.z) != 0)
        fail("a failing step moved the trajectory", status);
    tell(counts, BAD_INPUT + 1);
}

int main(void)
{
    static double before[NZ];

    for (int call = 0; call < CALLS; ++call) {
        if (call % 8 == 0)
            fill();
        if (one_in(3))
            spoil();
        prepare(&work);
        if (one_in(10))
            disturb(&work.y[N][0], 1);
        memcpy(before, work.z, sizeof before);
        memset(scratch, 0xFF, sizeof *scratch);  /* may hold anything */
        judge(feedback(&memory), before);
#if FREE_INITIAL
        if (one_in(2))
            arrival_update(&work);
#endif
        shift(&work);
    }
    return 0;
}

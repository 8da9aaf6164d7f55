/* Integration over shooting intervals in steps whose lengths follow from an estimate of their error, in each interval by
 * itself. A step whose estimate is beyond the tolerance is not taken, and a shorter one tried. There are ATTEMPTS at most,
 * so that the time is bounded: an interval whose end is not reached has no values, and rti_prepare says NOT_FINITE.
 * Derivatives are those of the steps that are taken, their lengths held (Bock 1981, internal numerical differentiation).
 *
 * The generated part of the unit defines ATTEMPTS, MODEL_STATES, COLUMNS (variables of a stage on which the model's state
 * at its end depends, the state itself first) and the functions attempt and arrive.
 */
#ifndef DRAWBAR_ADAPTIVE_H
#define DRAWBAR_ADAPTIVE_H

#include "rti.h"

#define LEFT (MODEL_STATES * (1 + COLUMNS))                 /* behind the state and its derivative by rows: the share of the */
#define CARRIED (LEFT + 2)                                  /* interval that is left, and that which is tried next */

#define FIRST 0.25                         /* a first step over the whole interval may hit where the estimate happens to be nil */

static void attempt(const struct rti *work, double (*carried)[CARRIED], int first, int count);
static void arrive(struct rti *work, const double (*carried)[CARRIED], int first, int count);   /* qp.A, qp.B, qp.c */

static void adaptive_begin(const struct rti *work, double *carried, int k)
{
    for (int i = 0; i < LEFT; ++i)
        carried[i] = 0.0;
    for (int i = 0; i < MODEL_STATES; ++i) {
        carried[i] = STATE(work->z, k)[i];
        carried[MODEL_STATES + i * COLUMNS + i] = 1.0;
    }
    carried[LEFT] = 1.0;
    carried[LEFT + 1] = FIRST;
}

static int adaptive_unfinished(const double (*carried)[CARRIED], int stages)
{
    int unfinished = 0;

    for (int j = 0; j < stages; ++j)
        unfinished |= carried[j][LEFT] > 0.0;
    return unfinished;
}

static void dynamics(struct rti *work, int first, int count)
{
    for (int base = first; base < count; base += LANES) {
        const int stages = count - base < LANES ? count - base : LANES;
        double carried[LANES][CARRIED];
        for (int j = 0; j < stages; ++j)
            adaptive_begin(work, carried[j], base + j);
        for (int i = 0; i < ATTEMPTS && adaptive_unfinished((const double (*)[CARRIED])carried, stages); ++i)
            attempt(work, carried, base, base + stages);
        for (int j = 0; j < stages; ++j)
            for (int i = 0; i < LEFT && carried[j][LEFT] > 0.0; ++i)
                carried[j][i] = NAN;
        arrive(work, (const double (*)[CARRIED])carried, base, base + stages);
    }
}

#endif

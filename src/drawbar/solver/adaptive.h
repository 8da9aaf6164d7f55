/* Adaptive integration over shooting intervals: step lengths follow from an estimate of their error, in each interval
 * by itself. A step whose estimate is beyond the tolerance is not taken, and a shorter one tried. There are ATTEMPTS at
 * most, so that the time is bounded: an interval whose end is not reached has no values, and rti_prepare says
 * NOT_FINITE. Derivatives are those of the steps that are taken, their lengths held (Bock 1981, internal numerical
 * differentiation).
 *
 * The generated part of the unit defines ATTEMPTS, FIRST_SHARE (of the interval, tried first), CARRIED_STATES (the model's),
 * CARRIED_COLUMNS (variables of a stage on which they depend at its end, themselves first), attempt and arrive.
 */
#ifndef DRAWBAR_ADAPTIVE_H
#define DRAWBAR_ADAPTIVE_H

#include "rti.h"

#define SHARE_LEFT (CARRIED_STATES * (1 + CARRIED_COLUMNS))   /* behind the states and their derivative by rows: */
#define SHARE_TRIED (SHARE_LEFT + 1)                          /* how much of the interval is left, and is tried next */
#define CARRIED (SHARE_TRIED + 1)

static void attempt(const struct rti *work, double (*carried)[CARRIED], int first, int count);
static void arrive(struct rti *work, const double (*carried)[CARRIED], int first, int count);   /* qp.A, qp.B, qp.c */

/* At the beginning of interval k. */
static void adaptive_begin(const struct rti *work, double *carried, int k)
{
    for (int i = 0; i < SHARE_LEFT; ++i)
        carried[i] = 0.0;
    for (int i = 0; i < CARRIED_STATES; ++i) {
        carried[i] = STATE(work->z, k)[i];
        carried[CARRIED_STATES + i * CARRIED_COLUMNS + i] = 1.0;
    }
    carried[SHARE_LEFT] = 1.0;
    carried[SHARE_TRIED] = FIRST_SHARE;
}

/* Is the end of any interval still to be reached? */
static int adaptive_unfinished(const double (*carried)[CARRIED], int stages)
{
    int unfinished = 0;

    for (int j = 0; j < stages; ++j)
        unfinished |= carried[j][SHARE_LEFT] > 0.0;
    return unfinished;
}

/* Integrate and differentiate some intervals, LANES of them side by side: as long as the slowest of these takes. */
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
            for (int i = 0; i < SHARE_LEFT && carried[j][SHARE_LEFT] > 0.0; ++i)
                carried[j][i] = (double)NAN;
        arrive(work, (const double (*)[CARRIED])carried, base, base + stages);
    }
}

#endif

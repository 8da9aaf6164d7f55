/* Fix weights in a window: what is told of each fix goes with it through the window.
 *
 * Weights belong to places in the window (rti_shift), which is right for all sensors that are always alike. Fixes are not:
 * while any in the window is unlike the usual ones, the weights of the positions are moved along here.
 */
#ifndef DRAWBAR_FIX_WEIGHTS_H
#define DRAWBAR_FIX_WEIGHTS_H

#include "apart.h"
#include "rti.h"
#include "signals.h"

#define FIX_OUTPUTS 4

struct fix_weights {
    double usual[FIX_OUTPUTS];
    int32_t unlike;                        /* slides until the last fix unlike the usual ones has left the window */
    int32_t begun;
};

static const int fix_output[FIX_OUTPUTS] = {Y_TRACTOR_X, Y_TRACTOR_Y, Y_TRAILER_X, Y_TRAILER_Y};

/* Let all fixes weigh what they usually do. */
static SELDOM void fix_weights_reset(struct fix_weights *weights, struct rti *rti)
{
    for (int i = 0; i < FIX_OUTPUTS; ++i) {
        if (!weights->begun)
            weights->usual[i] = rti->w[0][fix_output[i]];
        for (int k = 0; k <= N; ++k)
            rti->w[k][fix_output[i]] = weights->usual[i];
    }
    weights->begun = 1;
    weights->unlike = 0;
}

/* Let the fixes of a measurement, at row k, weigh by their deviations; `deviation` is the usual one, m. */
static void fix_weights_set(struct fix_weights *weights, struct rti *rti, int k,
                            const struct drawbar_measurement *measurement, double deviation)
{
    const double told[] = {measurement->tractor_fix_deviation, measurement->trailer_fix_deviation};

    for (int i = 0; i < FIX_OUTPUTS; ++i) {
        double *w = &rti->w[k][fix_output[i]];
        const double ratio = told[i / 2] > 0.0 ? deviation / told[i / 2] : 1.0, wanted = weights->usual[i] * ratio * ratio;
        if (*w != wanted)
            rti_reweighted(rti);
        if (wanted != weights->usual[i])
            weights->unlike = N + 1;
        *w = wanted;
    }
}

/* The window has moved on by one sample. */
static void fix_weights_slide(struct fix_weights *weights, struct rti *rti)
{
    if (!weights->unlike)
        return;
    --weights->unlike;
    for (int i = 0; i < FIX_OUTPUTS; ++i) {
        for (int k = 0; k < N; ++k)
            rti->w[k][fix_output[i]] = rti->w[k + 1][fix_output[i]];
        rti->w[N][fix_output[i]] = weights->usual[i];
    }
}

#endif

/* Fix weights in a window: each fix keeps its own weight while it moves through the window.
 *
 * Weights belong to stages of the window and do not move with it (rti_shift), which suits sensors of constant variance. Fixes
 * have a variance each: while any in the window is not nominal, the weights of the positions are moved along here.
 */
#ifndef DRAWBAR_FIX_WEIGHTS_H
#define DRAWBAR_FIX_WEIGHTS_H

#include "noinline.h"
#include "rti.h"
#include "signals.h"

#define COARSE_WEIGHTS 0.1                 /* standard deviation of both fixes beyond which no bias of the yaw rate shows, m */
#define COARSE_YAW_RATE 0.3                /* square root of the factor on the yaw rate's weight then */

#ifdef YAW_RATE_OUTPUT
#define FIX_OUTPUTS 5
#else
#define FIX_OUTPUTS 4
#endif

struct fix_weights {
    double nominal[FIX_OUTPUTS];
    int32_t other_slides;                  /* slides until the last fix of another weight has left the window */
    int32_t initialised;
};

static const int fix_output[FIX_OUTPUTS] = {
    Y_TRACTOR_X, Y_TRACTOR_Y, Y_TRAILER_X, Y_TRAILER_Y,
#ifdef YAW_RATE_OUTPUT
    YAW_RATE_OUTPUT,
#endif
};

/* Give all fixes their nominal weights. */
static COLD void fix_weights_reset(struct fix_weights *weights, struct rti *rti)
{
    for (int i = 0; i < FIX_OUTPUTS; ++i) {
        if (!weights->initialised)
            weights->nominal[i] = rti->w[0][fix_output[i]];
        for (int k = 0; k <= N; ++k)
            rti->w[k][fix_output[i]] = weights->nominal[i];
    }
    weights->initialised = 1;
    weights->other_slides = 0;
}

/* Weight the fixes of a measurement, at row k, by their standard deviations; `deviation` is the nominal one, m. */
static void fix_weights_set(struct fix_weights *weights, struct rti *rti, int k,
                            const struct drawbar_measurement *measurement, double deviation)
{
    const double reported[] = {measurement->tractor_fix_deviation, measurement->trailer_fix_deviation};

    const int coarse = fmin(reported[0], reported[1]) > COARSE_WEIGHTS;

    for (int i = 0; i < FIX_OUTPUTS; ++i) {
        double *w = &rti->w[k][fix_output[i]];
        const double of_fix = i < 4 && reported[i / 2] > 0.0 ? deviation / reported[i / 2] : 1.0;
        const double ratio = i == 4 && coarse ? COARSE_YAW_RATE : of_fix;
        const double wanted = weights->nominal[i] * ratio * ratio;
        if (*w != wanted)
            rti_reweighted(rti);
        if (wanted != weights->nominal[i])
            weights->other_slides = N + 1;
        *w = wanted;
    }
}

/* Move the weights with the window, by one sample. */
static void fix_weights_slide(struct fix_weights *weights, struct rti *rti)
{
    if (!weights->other_slides)
        return;
    --weights->other_slides;
    for (int i = 0; i < FIX_OUTPUTS; ++i) {
        for (int k = 0; k < N; ++k)
            rti->w[k][fix_output[i]] = rti->w[k + 1][fix_output[i]];
        rti->w[N][fix_output[i]] = weights->nominal[i];
    }
}

#endif

/* The sliding window of moving horizon estimation: it fills from its first row on; once full, its oldest stage moves
 * into the arrival cost. */
#ifndef DRAWBAR_WINDOW_H
#define DRAWBAR_WINDOW_H

#include "noinline.h"
#include "arrival.h"

struct window {
    double deviation[NX];                  /* of the first prior, standard deviations */
    int32_t newest;                        /* row of the newest measurement: grows until the window is full */
    int32_t absorbed;                      /* outcome of the last slide, enum qp_status */
};

#define WINDOW_FIELDS(type, prefix)                                                                          \
    SETTING(type, prefix deviation, 0, NX, 0, 0) FIELD(type, prefix newest, 1, 1, 0, 0)

/* Let the arrival cost be the first prior's, around another point. */
static void window_forget(struct window *window, struct rti *rti, const double *prior)
{
    memset(rti->root, 0, sizeof rti->root);
    for (int i = 0; i < NX; ++i)
        rti->root[i][i] = 1.0 / window->deviation[i];
    memcpy(rti->prior, prior, sizeof rti->prior);
}

/* Begin an empty window at a first guess of states and parameters, and prepare the first feedback. */
static COLD int window_restart(struct window *window, struct rti *rti, const double *prior)
{
    double *y = &rti->y[0][0];

    window_forget(window, rti, prior);
    window->newest = 0;
    for (int k = 0; k <= N; ++k)
        memcpy(STATE(rti->z, k), prior, NX * sizeof(double));
    memset(INPUT(rti->z, 0), 0, N * NU * sizeof(double));
    for (int i = 0; i < (N + 1) * NY; ++i)
        y[i] = (double)NAN;
    rti->open_end = rti->linearised = 0;
    return rti_prepare(rti);
}

/* Take measurements that feedback refused out of the newest row: they are missing. */
static void window_drop_refused(struct rti *rti, int row)
{
    for (int i = 0; i < NY; ++i)
        if (!(fabs(rti->y[row][i]) <= LARGEST_INPUT))
            rti->y[row][i] = (double)NAN;
}

/* Make room for the next sample. When the oldest stage cannot be absorbed, the arrival cost starts anew: the first
 * prior's deviations around the present estimate of the window's new first state. With negative weights nothing moves. */
static int window_slide(struct window *window, struct rti *rti)
{
    if (!rti_weights_valid(rti))
        return window->absorbed = BAD_INPUT;
    window->absorbed = SOLVED;
    window_drop_refused(rti, window->newest);
    if (window->newest < N) {
        ++window->newest;
        return SOLVED;
    }
    window->absorbed = arrival_update(rti);
    if (window->absorbed != SOLVED)
        window_forget(window, rti, STATE(rti->z, 1));
    rti_shift(rti);
    return window->absorbed;
}

#endif

/* Rate history: the yaw rate of the last samples, by which an old measured one is brought up to now. Over several samples it
 * does not change evenly. All are what was expected before their sample was taken in: what a sample corrects in the estimate is
 * no change of the rate, and would add up in its integral. */
#ifndef DRAWBAR_RATE_HISTORY_H
#define DRAWBAR_RATE_HISTORY_H

#include <math.h>
#include <string.h>

#define RATES_KEPT 8                       /* samples */

struct rate_history {
    double rates[RATES_KEPT];              /* newest first, rad/s */
};

/* Initialise with a constant rate, rad/s. */
static inline void rate_history_begin(struct rate_history *history, double rate)
{
    for (int i = 0; i < RATES_KEPT; ++i)
        history->rates[i] = rate;
}

/* Record the yaw rate of this sample, rad/s: from now on it is the one before. */
static inline void rate_history_record(struct rate_history *history, double rate)
{
    memmove(history->rates + 1, history->rates, (RATES_KEPT - 1) * sizeof(double));
    history->rates[0] = rate;
}

/* What a sensor would report now that reported `measured` (rad/s) at an age (s), while the yaw rate became `now`; elapsed: of a
 * sample, by the model, s. NaN where the samples do not reach back. */
static inline double rate_history_brought_up(const struct rate_history *history, double measured, double age, double elapsed,
                                             double now)
{
    const double samples = age > 0.0 && elapsed > 0.0 ? age / elapsed : 0.0;

    if (age == 0.0 || isnan(age))
        return measured;
    if (age < 0.0 || !(samples < RATES_KEPT))
        return (double)NAN;
    const int k = (int)samples;
    const double newer = k > 0 ? history->rates[k - 1] : now;
    return measured + now - newer - (samples - k) * (history->rates[k] - newer);
}

#endif

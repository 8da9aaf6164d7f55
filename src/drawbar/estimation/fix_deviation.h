/* Fix deviation: the standard deviation of a fix, as its receiver reports it or by its quality. */
#ifndef DRAWBAR_FIX_DEVIATION_H
#define DRAWBAR_FIX_DEVIATION_H

#include <math.h>
#include <string.h>
#include "geometry.h"
#include "signals.h"

struct fix_deviations {
    double floor;                          /* least standard deviation, m */
    double inflation;                      /* factor on what receivers report */
    double floating, differential, single; /* least ones of fixes of these qualities, m */
    double correlation_inflation;          /* prior factor on these: their errors are correlated over many samples */
};

#define FIX_DEVIATIONS_FIELDS(type, place)                                                                   \
    SETTING(type, place.floor, 0, 1, 0, 0) SETTING(type, place.inflation, 0, 1, 0, 0)                        \
    SETTING(type, place.floating, 0, 1, 0, 0) SETTING(type, place.differential, 0, 1, 0, 0)                  \
    SETTING(type, place.single, 0, 1, 0, 0) SETTING(type, place.correlation_inflation, 0, 1, 0, 0)

/* The noise of one receiver's coarse fixes, by how much they change between samples.
 *
 * White errors average out, correlated ones do not. With the correlation r from sample to sample, n errors of standard
 * deviation s count like n of s sqrt((1 + r) / (1 - r)), and their changes have the variance 2 s^2 (1 - r), which gives the
 * factor. Its prior is the configured one. */
struct coarse_noise {
    double change;                         /* mean square of the changes per 2 s^2: 1 - r */
    double last[2];                        /* innovation of the last fix, m */
    int32_t samples, initialised;
};

#define COARSE_PRIOR 5.0                   /* weight of the prior, in samples */
#define COARSE_MOST 8.0                    /* largest factor */
#define COARSE_MEMORY 50                   /* samples */

static inline double coarse_factor(const struct coarse_noise *noise, double inflation)
{
    const double prior = 2.0 / (1.0 + inflation * inflation);
    const double change = (COARSE_PRIOR * prior + noise->samples * noise->change) / (COARSE_PRIOR + noise->samples);

    return sqrt(clamped(2.0 / change - 1.0, 1.0, COARSE_MOST * COARSE_MOST));
}

/* Update with the innovation (m) of a coarse fix of this standard deviation (m). */
static inline void coarse_update(struct coarse_noise *noise, const double *innovation, double deviation)
{
    const double east = innovation[0] - noise->last[0], north = innovation[1] - noise->last[1];
    const double change = (east * east + north * north) / (4.0 * deviation * deviation);

    if (noise->initialised && isfinite(change)) {
        noise->samples += noise->samples < COARSE_MEMORY;
        noise->change += (change - noise->change) / noise->samples;
    }
    noise->initialised = isfinite(innovation[0] + innovation[1]);
    noise->last[0] = innovation[0];
    noise->last[1] = innovation[1];
}

/* Least standard deviation that a quality allows, m; 0: any. */
static inline double deviation_of_quality(const struct fix_deviations *known, int32_t quality)
{
    switch (quality) {
    case DRAWBAR_QUALITY_FLOAT:
        return known->floating;
    case DRAWBAR_QUALITY_DIFFERENTIAL:
        return known->differential;
    case DRAWBAR_QUALITY_SINGLE:
        return known->single;
    default:
        return 0.0;
    }
}

/* The standard deviation of each coordinate to use, m. NaN: the nominal one. Negative: there is no fix.
 *
 * reported: by the receiver, m; NaN: not reported. */
static inline double fix_deviation(const struct fix_deviations *known, struct coarse_noise *noise, double reported,
                                   int32_t quality, const double *innovation)
{
    const double least = deviation_of_quality(known, quality);

    if (!(least > 0.0))
        memset(noise, 0, sizeof *noise);
    if (quality == DRAWBAR_QUALITY_NONE || (!isnan(reported) && !(reported > 0.0)))
        return -1.0;
    if (!(least > 0.0))
        return isnan(reported) ? (double)NAN : fmax(known->inflation * reported, known->floor);
    const double deviation = isnan(reported) ? least : fmax(reported, known->floor);
    coarse_update(noise, innovation, deviation);
    return coarse_factor(noise, known->correlation_inflation) * fmax(deviation, least);
}

#endif

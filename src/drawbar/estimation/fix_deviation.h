/* Fix deviation: how far off a fix may be, as its receiver tells or as its quality has it. */
#ifndef DRAWBAR_FIX_DEVIATION_H
#define DRAWBAR_FIX_DEVIATION_H

#include <math.h>
#include <string.h>
#include "geometry.h"
#include "signals.h"

struct fix_deviations {
    double floor;                          /* no fix is better than this, m */
    double optimism;                       /* by which what receivers tell is multiplied */
    double floating, differential, single; /* of fixes of these qualities at least, m */
    double lasting;                        /* by which these are multiplied at first: their errors last for many samples */
};

#define FIX_DEVIATIONS_FIELDS(type, place)                                                                   \
    SETTING(type, place.floor, 0, 1, 0, 0) SETTING(type, place.optimism, 0, 1, 0, 0)                         \
    SETTING(type, place.floating, 0, 1, 0, 0) SETTING(type, place.differential, 0, 1, 0, 0)                  \
    SETTING(type, place.single, 0, 1, 0, 0) SETTING(type, place.lasting, 0, 1, 0, 0)

/* The noise of one receiver's coarse fixes, by how much they change between samples.
 *
 * Errors that come anew in each sample average out; those that last do not. With the correlation r from sample to sample,
 * n errors of deviation s count like n of s sqrt((1 + r) / (1 - r)), and their changes have the variance 2 s^2 (1 - r): so
 * these tell the factor. Before they do it is the configured one. */
struct coarse_noise {
    double change;                         /* mean square of the changes per 2 s^2: 1 - r */
    double last[2];                        /* by how much the last fix was off what was expected, m */
    int32_t samples, begun;
};

#define COARSE_BEFORE 5.0                  /* samples that what was configured counts for */
#define COARSE_MOST 8.0                    /* largest factor */
#define COARSE_MEMORY 50                   /* samples */

static inline double coarse_factor(const struct coarse_noise *noise, double lasting)
{
    const double believed = 2.0 / (1.0 + lasting * lasting);
    const double change = (COARSE_BEFORE * believed + noise->samples * noise->change) / (COARSE_BEFORE + noise->samples);

    return sqrt(clamped(2.0 / change - 1.0, 1.0, COARSE_MOST * COARSE_MOST));
}

/* Take in by how much (m) a coarse fix of this deviation (m) is off what was expected. */
static inline void coarse_update(struct coarse_noise *noise, const double *off, double deviation)
{
    const double east = off[0] - noise->last[0], north = off[1] - noise->last[1];
    const double change = (east * east + north * north) / (4.0 * deviation * deviation);

    if (noise->begun && isfinite(change)) {
        noise->samples += noise->samples < COARSE_MEMORY;
        noise->change += (change - noise->change) / noise->samples;
    }
    noise->begun = isfinite(off[0] + off[1]);
    noise->last[0] = off[0];
    noise->last[1] = off[1];
}

/* Least deviation that a quality allows, m; 0: the quality alone says nothing against the fix. */
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

/* The deviation of each coordinate to reckon with, m. NaN: the usual one. Negative: the fix is none.
 *
 * told: by the receiver, m; NaN: it does not. off: by how much the fix is off what was expected, m. */
static inline double fix_deviation(const struct fix_deviations *known, struct coarse_noise *noise, double told,
                                   int32_t quality, const double *off)
{
    const double least = deviation_of_quality(known, quality);

    if (!(least > 0.0))
        memset(noise, 0, sizeof *noise);
    if (quality == DRAWBAR_QUALITY_NONE || (!isnan(told) && !(told > 0.0)))
        return -1.0;
    if (!(least > 0.0))
        return isnan(told) ? (double)NAN : fmax(known->optimism * told, known->floor);
    const double deviation = isnan(told) ? least : fmax(told, known->floor);
    coarse_update(noise, off, deviation);
    return coarse_factor(noise, known->lasting) * fmax(deviation, least);
}

#endif

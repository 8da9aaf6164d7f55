/* How far off a fix may be, as its receiver tells or as its quality has it. */
#ifndef DRAWBAR_FIX_DEVIATION_H
#define DRAWBAR_FIX_DEVIATION_H

#include <math.h>
#include "signals.h"

struct fix_deviations {
    double floor;                          /* no fix is better than this, m */
    double optimism;                       /* by which what receivers tell is multiplied */
    double floating, differential, single; /* of fixes of these qualities at least, m */
    double lasting;                        /* by which these are multiplied: their errors last for many samples */
};

#define FIX_DEVIATIONS_FIELDS(type, place)                                                                   \
    SETTING(type, place.floor, 0, 1, 0, 0) SETTING(type, place.optimism, 0, 1, 0, 0)                         \
    SETTING(type, place.floating, 0, 1, 0, 0) SETTING(type, place.differential, 0, 1, 0, 0)                  \
    SETTING(type, place.single, 0, 1, 0, 0) SETTING(type, place.lasting, 0, 1, 0, 0)

/* Least deviation that a quality allows, m; 0: the quality alone says nothing against the fix. */
static inline double deviation_of_quality(const struct fix_deviations *known, int32_t quality)
{
    switch (quality) {
    case DRAWBAR_QUALITY_FLOAT:
        return known->lasting * known->floating;
    case DRAWBAR_QUALITY_DIFFERENTIAL:
        return known->lasting * known->differential;
    case DRAWBAR_QUALITY_SINGLE:
        return known->lasting * known->single;
    default:
        return 0.0;
    }
}

/* The deviation of each coordinate to reckon with, m. NaN: the usual one. Negative: the fix is none.
 *
 * told: by the receiver, m; NaN: it does not. */
static inline double fix_deviation(const struct fix_deviations *known, double told, int32_t quality)
{
    const double least = deviation_of_quality(known, quality);

    if (quality == DRAWBAR_QUALITY_NONE || (!isnan(told) && !(told > 0.0)))
        return -1.0;
    if (isnan(told))
        return least > 0.0 ? least : NAN;
    const double share = least > 0.0 ? known->lasting : known->optimism;
    return fmax(fmax(share * told, least), known->floor);
}

#endif

/* Suspicion against one of two antennas, when they disagree about where the vehicle is.
 *
 * Averages how far both antennas lie from their expectations, and watches the difference of the two means. What moves
 * the vehicle moves both antennas, so a bump, a slope or a lasting loss leaves the difference alone, and a shift too
 * small for a single sample to show adds up (an exponentially weighted moving average, Roberts 1959). The antenna whose
 * own mean is larger is suspected, until the difference is small again.
 */
#ifndef DRAWBAR_SUSPICION_H
#define DRAWBAR_SUSPICION_H

#include <stdint.h>
#include <string.h>
#include "antennas.h"
#include "geometry.h"

enum antenna { NEITHER, TRACTOR_ANTENNA, TRAILER_ANTENNA };

struct suspicion {
    double means[4];                       /* of the offsets, m */
    int32_t suspect;                       /* enum antenna */
};

/* What one disagreement is measured by. */
struct suspicion_limits {
    double most;                           /* no single coordinate counts more, m: what the gate lets pass */
    double shift, release;                 /* difference of the means that arouses suspicion, and that ends it, m */
    double room;                           /* by how much the gates have widened, m */
    int32_t memory;                        /* samples to average over */
};

static inline void suspicion_average(struct suspicion *suspicion, const double *offsets, double most, int32_t memory)
{
    for (int i = 0; i < 4; ++i)
        suspicion->means[i] += (clamped(offsets[i], -most, most) - suspicion->means[i]) / memory;
}

static inline int32_t further(const double *offsets)
{
    return hypot(offsets[0], offsets[1]) > hypot(offsets[2], offsets[3]) ? TRACTOR_ANTENNA : TRAILER_ANTENNA;
}

/* Take in one sample in which both receivers reported a fix: the offsets (4) of the fixes from their expectations, m,
 * and which (2) of them lie outside their gates. */
static inline void suspicion_update(struct suspicion *suspicion, const struct suspicion_limits *limits,
                                    const double *offsets, const int *outside)
{
    const double *means = suspicion->means;

    suspicion_average(suspicion, offsets, limits->most, limits->memory);
    const int sudden = outside[0] != outside[1]
        || !(distance(offsets, offsets + 2) <= sqrt(2.0) * limits->most + limits->room);
    const double limit = suspicion->suspect == NEITHER ? limits->shift : limits->release;
    if (!sudden && !(distance(means, means + 2) > limit + limits->room)) {
        suspicion->suspect = NEITHER;
    } else if (suspicion->suspect == NEITHER) {
        if (sudden)                        /* so that one sample back inside the gate does not clear it */
            suspicion_average(suspicion, offsets, limits->most, 1);
        suspicion->suspect = outside[0] ? TRACTOR_ANTENNA : outside[1] ? TRAILER_ANTENNA
            : further(sudden ? offsets : means);
    }
}

/* Begin anew: a receiver reports nothing, and without two antennas there is no disagreement. */
static inline void suspicion_forget(struct suspicion *suspicion)
{
    memset(suspicion, 0, sizeof *suspicion);
}

#endif

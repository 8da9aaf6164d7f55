/* Suspicion against one of two antennas, when they disagree about where the vehicle is.
 *
 * Averages how far both antennas lie from their expectations, and watches the difference of the two means. What moves
 * the vehicle moves both antennas, so a bump, a slope or a lasting loss leaves the difference alone, and a shift too
 * small for a single sample to show adds up (an exponentially weighted moving average, Roberts 1959). The antenna whose
 * own mean is larger is suspected, until the difference is small again.
 *
 * Errors that last for seconds do not average out, and no shift is to be suspected that they make. So the limits are at
 * least a multiple of what the differences usually are, ahead and to the left apart: what lasts to the left the estimate's
 * yaw takes up, what lasts ahead nothing. Until that is known, whatever the fixes' known deviation has beyond what changes
 * from sample to sample is taken to last.
 */
#ifndef DRAWBAR_SUSPICION_H
#define DRAWBAR_SUSPICION_H

#include <stdint.h>
#include <string.h>
#include "antennas.h"
#include "geometry.h"

#define USUAL 3.4                          /* usual differences of the means that arouse no suspicion */
#define USUAL_MEMORY 300                   /* samples over which they are learned */
#define USUAL_BEFORE 100.0                 /* samples that what is taken of them before counts for */

enum antenna { NEITHER, TRACTOR_ANTENNA, TRAILER_ANTENNA };

struct suspicion {
    double means[4];                       /* of the offsets, m */
    double usual[2];                       /* mean squares of the means' differences, ahead and to the left, m2 */
    int32_t learned;                       /* samples in these */
    int32_t suspect;                       /* enum antenna */
};

/* What one disagreement is measured by. */
struct suspicion_limits {
    double most;                           /* no single coordinate counts more, m: what the gate lets pass */
    double shift;                          /* difference of the means that arouses suspicion where less is usual, m */
    double release;                        /* share of what arouses it below which it ends */
    double lasting;                        /* variance of one coordinate of a fix that lasts, before it is known, m2 */
    double room;                           /* by how much the gates have widened, m */
    int32_t memory;                        /* samples to average over */
};

static inline void suspicion_average(struct suspicion *suspicion, const double *offsets, double most, int32_t memory)
{
    for (int i = 0; i < 4; ++i)
        suspicion->means[i] += (clamped(offsets[i], -most, most) - suspicion->means[i]) / memory;
}

static inline void suspicion_learn(struct suspicion *suspicion)
{
    suspicion->learned += suspicion->learned < USUAL_MEMORY;
    for (int i = 0; i < 2; ++i) {
        const double apart = suspicion->means[i] - suspicion->means[i + 2];
        suspicion->usual[i] += (apart * apart - suspicion->usual[i]) / suspicion->learned;
    }
}

/* The difference of the means per what arouses suspicion. */
static inline double suspicion_excess(const struct suspicion *suspicion, const struct suspicion_limits *limits)
{
    const double before[] = {2.0 * limits->lasting, 0.0};
    double excess[2];

    for (int i = 0; i < 2; ++i) {
        const double square = (USUAL_BEFORE * before[i] + suspicion->learned * suspicion->usual[i])
            / (USUAL_BEFORE + suspicion->learned);
        const double limit = fmax(limits->shift, USUAL * sqrt(square)) + limits->room;
        excess[i] = (suspicion->means[i] - suspicion->means[i + 2]) / limit;
    }
    return hypot(excess[0], excess[1]);
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
    suspicion_average(suspicion, offsets, limits->most, limits->memory);
    const int sudden = outside[0] != outside[1]
        || !(distance(offsets, offsets + 2) <= sqrt(2.0) * limits->most + limits->room);
    const double limit = suspicion->suspect == NEITHER ? 1.0 : limits->release;
    if (!sudden && suspicion_excess(suspicion, limits) <= limit) {
        suspicion->suspect = NEITHER;
        suspicion_learn(suspicion);
    } else if (suspicion->suspect == NEITHER) {
        if (sudden)                        /* so that one sample back inside the gate does not clear it */
            suspicion_average(suspicion, offsets, limits->most, 1);
        suspicion->suspect = outside[0] ? TRACTOR_ANTENNA : outside[1] ? TRAILER_ANTENNA
            : further(sudden ? offsets : suspicion->means);
    }
}

/* Begin anew, with what is usual: a receiver reports nothing, and without two antennas there is no disagreement. */
static inline void suspicion_forget(struct suspicion *suspicion)
{
    memset(suspicion->means, 0, sizeof suspicion->means);
    suspicion->suspect = NEITHER;
}

#endif

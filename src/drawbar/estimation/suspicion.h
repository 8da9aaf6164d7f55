/* Suspicion against one of two antennas, when they disagree about where the vehicle is.
 *
 * Averages how far both antennas lie from their expectations, and watches the difference of the two means. What moves
 * the vehicle moves both antennas, so a bump, a slope or a lasting loss leaves the difference alone, and a shift too
 * small for a single sample to show adds up (an exponentially weighted moving average, Roberts 1959). The antenna whose
 * own mean is larger is suspected, until the difference is small again.
 *
 * Errors that are correlated over seconds do not average out, and are no fault. So the limits are at least a multiple of the
 * differences' root mean square, longitudinal and lateral separately: a lasting lateral difference is absorbed by the
 * estimated yaw, a longitudinal one by nothing. The prior of that mean square is the part of the fixes' variance that is not
 * white noise.
 */
#ifndef DRAWBAR_SUSPICION_H
#define DRAWBAR_SUSPICION_H

#include <stdint.h>
#include <string.h>
#include "antennas.h"
#include "geometry.h"

#define BASELINE_FACTOR 3.4                /* root mean squares of the difference that a limit is at least */
#define BASELINE_MEMORY 300                /* samples that the mean square covers at most */
#define BASELINE_PRIOR 100.0               /* weight of its prior, in samples */

enum antenna { NEITHER, TRACTOR_ANTENNA, TRAILER_ANTENNA };

struct suspicion {
    double means[4];                       /* of the innovations, m */
    double baseline[2];                    /* mean squares of the means' differences, longitudinal and lateral, m2 */
    int32_t baseline_samples;              /* that they cover */
    int32_t suspect;                       /* enum antenna */
};

/* Limits of one sample's test. */
struct suspicion_limits {
    double gate;                           /* at which a single coordinate is clipped, m */
    double shift;                          /* least limit of the difference of the means, m */
    double release;                        /* share of the limit below which a suspicion ends (hysteresis) */
    double correlated;                     /* prior variance of one coordinate's correlated error, m2 */
    double widening;                       /* of the gates, m */
    int32_t memory;                        /* samples to average over */
};

static inline void suspicion_average(struct suspicion *suspicion, const double *innovations, double gate, int32_t memory)
{
    for (int i = 0; i < 4; ++i)
        suspicion->means[i] += (clamped(innovations[i], -gate, gate) - suspicion->means[i]) / memory;
}

static inline void suspicion_baseline(struct suspicion *suspicion)
{
    suspicion->baseline_samples += suspicion->baseline_samples < BASELINE_MEMORY;
    for (int i = 0; i < 2; ++i) {
        const double difference = suspicion->means[i] - suspicion->means[i + 2];
        suspicion->baseline[i] += (difference * difference - suspicion->baseline[i]) / suspicion->baseline_samples;
    }
}

/* The difference of the means per its limit. */
static inline double suspicion_excess(const struct suspicion *suspicion, const struct suspicion_limits *limits)
{
    const double prior[] = {2.0 * limits->correlated, 0.0};
    double excess[2];

    for (int i = 0; i < 2; ++i) {
        const double square = (BASELINE_PRIOR * prior[i] + suspicion->baseline_samples * suspicion->baseline[i])
            / (BASELINE_PRIOR + suspicion->baseline_samples);
        const double limit = fmax(limits->shift, BASELINE_FACTOR * sqrt(square)) + limits->widening;
        excess[i] = (suspicion->means[i] - suspicion->means[i + 2]) / limit;
    }
    return hypot(excess[0], excess[1]);
}

static inline int32_t further(const double *innovations)
{
    return hypot(innovations[0], innovations[1]) > hypot(innovations[2], innovations[3]) ? TRACTOR_ANTENNA : TRAILER_ANTENNA;
}

/* Update with one sample in which both receivers reported a fix: the innovations (4) of the fixes, m, and which (2) of them
 * lie outside their gates. */
static inline void suspicion_update(struct suspicion *suspicion, const struct suspicion_limits *limits,
                                    const double *innovations, const int *outside)
{
    suspicion_average(suspicion, innovations, limits->gate, limits->memory);
    const int abrupt = outside[0] != outside[1]
        || !(distance(innovations, innovations + 2) <= sqrt(2.0) * limits->gate + limits->widening);
    const double limit = suspicion->suspect == NEITHER ? 1.0 : limits->release;
    if (!abrupt && suspicion_excess(suspicion, limits) <= limit) {
        suspicion->suspect = NEITHER;
        suspicion_baseline(suspicion);
    } else if (suspicion->suspect == NEITHER) {
        if (abrupt)                        /* so that one sample back inside the gate does not clear it */
            suspicion_average(suspicion, innovations, limits->gate, 1);
        suspicion->suspect = outside[0] ? TRACTOR_ANTENNA : outside[1] ? TRAILER_ANTENNA
            : further(abrupt ? innovations : suspicion->means);
    }
}

/* Restart the means, not the mean squares: without both fixes there is no difference. */
static inline void suspicion_forget(struct suspicion *suspicion)
{
    memset(suspicion->means, 0, sizeof suspicion->means);
    suspicion->suspect = NEITHER;
}

#endif

/* Noise level of position fixes: the deviation of one coordinate, from how much the disagreement of two antennas
 * changes between samples.
 *
 * Successive differences (von Neumann 1941) do not see what lasts or grows slowly: neither a shifted antenna nor an
 * estimate that is off makes the fixes look noisier than they are.
 */
#ifndef DRAWBAR_NOISE_LEVEL_H
#define DRAWBAR_NOISE_LEVEL_H

#include <stdint.h>
#include "antennas.h"

struct noise_level {
    double mean_square;                    /* of the changes, m2 */
    double last[2];                        /* the last disagreement, m */
    int32_t samples, begun;                /* changes in the mean; is there a last disagreement? */
};

/* Take in by how much (m) both antennas disagree; no more than the limit (m) of a change counts. The mean is over as
 * many samples as there are, at most `memory`. */
static inline void noise_update(struct noise_level *noise, const double *disagreement, double limit, int32_t memory)
{
    if (noise->begun) {
        const double change = fmin(distance(disagreement, noise->last), limit);
        noise->samples = noise->samples < memory ? noise->samples + 1 : memory;
        noise->mean_square += (change * change - noise->mean_square) / noise->samples;
    }
    noise->last[0] = disagreement[0];
    noise->last[1] = disagreement[1];
    noise->begun = 1;
}

/* Begin a new series: one of the antennas has no fix. */
static inline void noise_interrupt(struct noise_level *noise)
{
    noise->begun = 0;
}

/* Standard deviation of one coordinate of one antenna, m; zero while nothing is known. */
static inline double noise_deviation(const struct noise_level *noise)
{
    return sqrt(noise->mean_square / 8.0); /* two coordinates of two antennas at two samples */
}

#endif

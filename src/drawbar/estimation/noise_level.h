/* Noise level of position fixes: the standard deviation of one coordinate's white noise, from the changes of the difference
 * of both antennas' innovations between samples.
 *
 * Successive differences (von Neumann 1941) remove constant and slowly growing errors: neither a shifted antenna nor a wrong
 * estimate raises the noise level.
 */
#ifndef DRAWBAR_NOISE_LEVEL_H
#define DRAWBAR_NOISE_LEVEL_H

#include <stdint.h>
#include "antennas.h"

struct noise_level {
    double mean_square;                    /* of the changes, m2 */
    double last[2];                        /* the last difference, m */
    int32_t samples, initialised;          /* changes in the mean; is there a last difference? */
};

/* Update with the difference (m) of both antennas' innovations; a change is clipped at the limit (m). The mean covers as many
 * samples as there are, at most `memory`. */
static inline void noise_update(struct noise_level *noise, const double *difference, double limit, int32_t memory)
{
    if (noise->initialised) {
        const double change = fmin(distance(difference, noise->last), limit);
        noise->samples = noise->samples < memory ? noise->samples + 1 : memory;
        noise->mean_square += (change * change - noise->mean_square) / noise->samples;
    }
    noise->last[0] = difference[0];
    noise->last[1] = difference[1];
    noise->initialised = 1;
}

/* Begin a new series: one of the antennas has no fix. */
static inline void noise_interrupt(struct noise_level *noise)
{
    noise->initialised = 0;
}

/* Standard deviation of one coordinate of one antenna, m; zero before the first change. */
static inline double noise_deviation(const struct noise_level *noise)
{
    return sqrt(noise->mean_square / 8.0); /* two coordinates of two antennas at two samples */
}

#endif

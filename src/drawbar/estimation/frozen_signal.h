/* Frozen signal: how long a sensor has repeated one value, and how far its expected value has changed meanwhile.
 *
 * A sensor of fine resolution on a vehicle in motion rarely repeats a value to the last bit; its longest sequence of
 * repetitions is recorded. A clearly longer one, while the expected value changes, means that the sensor is stuck.
 */
#ifndef DRAWBAR_FROZEN_SIGNAL_H
#define DRAWBAR_FROZEN_SIGNAL_H

#include <math.h>
#include <stdint.h>

#define FROZEN_SAMPLES 50                  /* in motion, after which the longest sequence is representative */
#define FROZEN_FINE 4                      /* longest sequence of a sensor of fine resolution */
#define FROZEN_MARGIN 5                    /* repetitions beyond twice the longest sequence that are no chance */
#define FROZEN_SPEED 0.1                   /* below which repetitions do not count, m/s */

struct frozen_signal {
    double value;                          /* as reported */
    double least, most;                    /* range of the expected value meanwhile */
    double error;                          /* of the expected value when this one was first reported */
    double resolution;                     /* smallest change of the reported value so far */
    int32_t repeated, longest, samples;    /* repetitions in motion now; longest sequence; samples in motion */
};

/* Update with a reported value and the expected one. */
static inline void frozen_update(struct frozen_signal *frozen, double reported, double expected, double speed)
{
    const int moves = fabs(speed) >= FROZEN_SPEED;
    const double change = fabs(reported - frozen->value);

    frozen->samples += moves && frozen->samples < FROZEN_SAMPLES;
    if (change > 0.0 && !(frozen->resolution > 0.0 && frozen->resolution <= change))
        frozen->resolution = change;
    if (!(change <= 0.0)) {                /* also when it is missing */
        frozen->longest = frozen->repeated > frozen->longest ? frozen->repeated : frozen->longest;
        frozen->value = reported;
        frozen->least = frozen->most = expected;
        frozen->error = isfinite(change) ? fabs(expected - reported) : 0.0;
        frozen->repeated = 0;
    } else {
        frozen->repeated += moves;
    }
    frozen->least = fmin(frozen->least, expected);
    frozen->most = fmax(frozen->most, expected);
}

/* By how much the range of the expected value exceeds an error of it, and the sensor's resolution, which counts as `most` at
 * most. */
static inline double frozen_excess(const struct frozen_signal *frozen, double most, double error)
{
    const double resolution = frozen->resolution > 0.0 ? fmin(frozen->resolution, most) : most;

    return frozen->most - frozen->least - fmax(resolution, error);
}

/* Length of this sequence per the longest plausible one: from 1 on the sensor is stuck; 0: its resolution is coarse. */
static inline double frozen_repetition(const struct frozen_signal *frozen)
{
    const int fine = frozen->samples == FROZEN_SAMPLES && frozen->longest <= FROZEN_FINE;

    return fine ? (double)frozen->repeated / (2 * frozen->longest + FROZEN_MARGIN) : 0.0;
}

#endif

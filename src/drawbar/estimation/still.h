/* Still: a sensor that repeats its value, and what it should have shown meanwhile.
 *
 * A fine sensor of a vehicle in motion hardly ever repeats a value to the last bit; how often in a row this one does is
 * learned. Where it repeats itself for clearly longer, while what is expected of it moves, it is stuck.
 */
#ifndef DRAWBAR_STILL_H
#define DRAWBAR_STILL_H

#include <math.h>
#include <stdint.h>

#define STILL_KNOWN 50                     /* samples in motion after which a sensor is known */
#define STILL_FINE 4                       /* repetitions in a row, at most, of a fine one */
#define STILL_MORE 5                       /* repetitions beyond twice as many that none of it has by chance */
#define STILL_MOVES 0.1                    /* speed below which repetitions say nothing, m/s */

struct still {
    double value;                          /* as it is reported */
    double least, most;                    /* between which what is expected has been meanwhile */
    double finest;                         /* smallest change of the reported value so far */
    int32_t repeated, longest, known;      /* repetitions in motion now, and at most; samples in motion */
};

/* Take in a value and the one that is expected. */
static inline void still_take(struct still *still, double reported, double expected, double speed)
{
    const int moves = fabs(speed) >= STILL_MOVES;
    const double change = fabs(reported - still->value);

    still->known += moves && still->known < STILL_KNOWN;
    if (change > 0.0 && !(still->finest > 0.0 && still->finest <= change))
        still->finest = change;
    if (!(change <= 0.0)) {                /* also when it is missing */
        still->longest = still->repeated > still->longest ? still->repeated : still->longest;
        still->value = reported;
        still->least = still->most = expected;
        still->repeated = 0;
    } else {
        still->repeated += moves;
    }
    still->least = fmin(still->least, expected);
    still->most = fmax(still->most, expected);
}

/* How far what is expected has moved meanwhile beyond the sensor's resolution, which counts as `most` at most. */
static inline double still_missed(const struct still *still, double most)
{
    return still->most - still->least - (still->finest > 0.0 ? fmin(still->finest, most) : most);
}

/* By how much a fine sensor has repeated itself more often than it ever does: from 1 on it is stuck; 0: it is not fine. */
static inline double still_unusual(const struct still *still)
{
    const int fine = still->known == STILL_KNOWN && still->longest <= STILL_FINE;

    return fine ? (double)still->repeated / (2 * still->longest + STILL_MORE) : 0.0;
}

#endif

/* Fix pair: the newest fixes of both receivers, which may report in turns, and whether one is repeated. */
#ifndef DRAWBAR_FIX_PAIR_H
#define DRAWBAR_FIX_PAIR_H

#include <math.h>
#include <string.h>
#include "antennas.h"
#include "geometry.h"
#include "signals.h"

#define PAIR_WAIT 0.3                      /* for so long a fix waits for the other antenna's, s */

/* State of one receiver. */
struct receiver {
    double fix[2], expected[2];            /* the newest fix; where the antenna was expected when it was first reported, m */
    time_stamp accepted;                   /* of the last accepted fix that was not coarse */
    time_stamp waiting;                    /* since when the newest one, not coarse, waits for the other antenna's */
    int32_t reported, was_accepted;        /* has it ever reported a fix; has one been accepted? */
};

/* Both fixes of a sample, compared with what is expected of them. */
struct fix_pair {
    double fixes[4];                       /* x, y of the tractor's and of the trailer's, m */
    double reported[2];                    /* standard deviation of each, m; NaN: nominal */
    double innovations[4];                 /* longitudinal and lateral, see antennas.h, m */
    double length_innovation;              /* of the antennas' distance, m */
    double widenings[2];                   /* of the gates, m */
    int both;                              /* both antennas have a fix that may confirm the other */
};

/* How far the antenna has moved since the receiver first reported exactly this fix, m. */
static inline double receiver_travelled(struct receiver *receiver, const double *fix, const double *expected)
{
    if (!receiver->reported || fix[0] != receiver->fix[0] || fix[1] != receiver->fix[1]) {
        memcpy(receiver->fix, fix, sizeof receiver->fix);
        memcpy(receiver->expected, expected, sizeof receiver->expected);
        receiver->reported = 1;
    }
    return distance(expected, receiver->expected);
}

static inline int32_t receiver_fix(struct receiver *receiver, const double *fix, const double *expected,
                                   double repetition)
{
    if (!isfinite(fix[0] + fix[1]))
        return DRAWBAR_FIX_MISSING;
    return receiver_travelled(receiver, fix, expected) > repetition ? DRAWBAR_FIX_STALE : DRAWBAR_FIX_ACCEPTED;
}

/* The status of each receiver's fix; returns whether both have one that was not compared yet: receivers may report in turns.
 * Both are then in the pair, the older one moved along with its antenna.
 *
 * expected: x, y of both antennas, m; repetition: motion of an antenna beyond which a repeated fix is stale, m; coarse: standard
 * deviation beyond which a fix waits for no other, m. */
static inline int pair_receive(struct fix_pair *pair, struct receiver *receivers, double time, const double *expected,
                               double repetition, double coarse, int32_t *found)
{
    int waiting = 0;

    for (int i = 0; i < 2; ++i) {
        struct receiver *receiver = &receivers[i];
        found[i] = receiver_fix(receiver, pair->fixes + 2 * i, expected + 2 * i, repetition);
        if (found[i] == DRAWBAR_FIX_ACCEPTED)
            receiver->waiting = pair->reported[i] > coarse ? -(double)INFINITY : time;
        waiting += receiver->reported && time - receiver->waiting < PAIR_WAIT;
    }
    for (int i = 0; i < 2 && waiting == 2; ++i) {
        struct receiver *receiver = &receivers[i];
        receiver->waiting = -(double)INFINITY;
        for (int j = 0; j < 2 && found[i] != DRAWBAR_FIX_ACCEPTED; ++j)
            pair->fixes[2 * i + j] = expected[2 * i + j] + (receiver->fix[j] - receiver->expected[j]);
    }
    return waiting == 2;
}

#endif

/* Screening of position fixes: repeated and implausible ones are masked before the estimator uses them.
 *
 * The innovation of each fix must lie in a validation gate, lateral and longitudinal (Bar-Shalom, Li, Kirubarajan 2001, section
 * 5.4), that widens while there is no fix and while the vehicle changes its motion (manoeuvre.h). Errors too small for the gate
 * show in the difference of both antennas' innovations (suspicion.h); where both agree against the estimate for long, they
 * overrule it (trust.h).
 */
#ifndef DRAWBAR_SCREENING_H
#define DRAWBAR_SCREENING_H

#include "fix_pair.h"
#include "manoeuvre.h"
#include "noise_level.h"
#include "signals.h"
#include "spike_filter.h"
#include "suspicion.h"
#include "sway.h"
#include "trust.h"

#define COARSE 3.0                         /* nominal standard deviations; a fix beyond neither confirms nor suspects another */

struct screening {
    /* settings, described in estimation/settings.py */
    double lateral, longitudinal, growth, single_growth, shift, release, length, hitch, repetition, patience, late;
    double steering, speed;
    double deviation;                      /* least standard deviation of one coordinate of a fix, m */
    int32_t memory, long_memory, settling;
    /* state */
    struct receiver receivers[2];
    struct noise_level noise;
    struct suspicion suspicion;
    struct trust trust;
    struct manoeuvre manoeuvre;
    struct spike_filter spikes[3];         /* of speed and both steerings */
    double length_error;                   /* mean error of the antennas' distance, m */
    time_stamp paired;                     /* when both receivers last had a new fix */
    int32_t refused;                       /* both fixes lay outside their gates then */
    int32_t lengths;                       /* samples in the mean error */
};

#define SCREENING_FIELDS(type, prefix)                                                                       \
    SETTING(type, prefix lateral, 0, 1, 0, 0) SETTING(type, prefix longitudinal, 0, 1, 0, 0)                 \
    SETTING(type, prefix growth, 0, 1, 0, 0) SETTING(type, prefix single_growth, 0, 1, 0, 0)                 \
    SETTING(type, prefix shift, 0, 1, 0, 0) SETTING(type, prefix release, 0, 1, 0, 0)                        \
    SETTING(type, prefix length, 0, 1, 0, 0) SETTING(type, prefix hitch, 0, 1, 0, 0)                         \
    SETTING(type, prefix repetition, 0, 1, 0, 0) SETTING(type, prefix late, 0, 1, 0, 0)                      \
    SETTING(type, prefix patience, 0, 1, 0, 0) SETTING(type, prefix deviation, 0, 1, 0, 0)                   \
    SETTING(type, prefix steering, 0, 1, 0, 0) SETTING(type, prefix speed, 0, 1, 0, 0)                       \
    SETTING(type, prefix memory, 1, 1, 0, 0) SETTING(type, prefix long_memory, 1, 1, 0, 0)                 \
    SETTING(type, prefix settling, 1, 1, 0, 0)

/* A measurement without the fixes that were rejected. */
struct screened {
    struct drawbar_measurement measurement;   /* NaN in place of masked values */
    int32_t fixes[2];                      /* enum drawbar_fix of the tractor's antenna and of the trailer's */
    int32_t exposed;                       /* enum antenna: has become suspect with this sample; its fixes just before were
                                            * wrong as well */
    int32_t restart;                       /* both antennas overrule the estimate: it is to start anew from this
                                            * measurement */
};

/* By how much each gate has widened without a fix, and because the vehicle of this length (m) has changed its yaw rate, m. */
static inline void screening_widenings(const struct screening *s, double time, double length, double *widenings)
{
    const double turned = s->late * s->manoeuvre.change.yaw_rate * length;
    double blind[2];

    for (int i = 0; i < 2; ++i)
        blind[i] = s->receivers[i].was_accepted ? time - s->receivers[i].accepted : 0.0;
    for (int i = 0; i < 2; ++i)
        widenings[i] = s->growth * fmin(blind[0], blind[1]) + s->single_growth * blind[i] + turned;
}

/* Compare both fixes with each other by their measured innovations (4 values, m). */
static inline void screening_compare(struct screening *s, const double *measured, const int *outside, double deviation,
                                     double widening)
{
    const double white = noise_deviation(&s->noise), half = 0.5 * s->length_error; /* of the lengths' error, each antenna's */
    const double innovations[] = {measured[0] - half, measured[1], measured[2] + half, measured[3]};
    const struct suspicion_limits limits = {
        .gate = s->lateral * deviation,
        .shift = s->shift * deviation,
        .release = s->release / s->shift,
        .correlated = fmax(s->deviation * s->deviation - white * white, 0.0),
        .widening = widening,
        .memory = s->memory,
    };

    const double difference[] = {innovations[0] - innovations[2], innovations[1] - innovations[3]};
    noise_update(&s->noise, difference, 2.0 * limits.gate, s->long_memory);
    if (s->trust.earned)                   /* an estimate without confirmation cannot suspect an antenna */
        suspicion_update(&s->suspicion, &limits, innovations, outside);
    else
        suspicion_forget(&s->suspicion);
}

/* After two rejected fixes, whose gates widen, accept a fix inside the widened gate only where both agree: else two false
 * fixes would return one after the other. Fixes that the model does not couple (single_growth) are exempt.
 *
 * across: both lateral gates before they widened, m. */
static inline void screening_narrow(struct screening *s, const double *innovations, const double *across, double widening,
                                    int *outside)
{
    const int disagree = outside[0] || outside[1]
        || distance(innovations, innovations + 2) > hypot(across[0], across[1]) + widening;

    if (s->refused && disagree && !(s->single_growth > 0.0))
        for (int i = 0; i < 2; ++i)
            outside[i] |= !(fabs(innovations[2 * i + 1]) <= across[i]);
    s->refused = outside[0] && outside[1];
}

/* The standard deviation of one coordinate of a nominal fix, m: the stated one, or the estimated one where that is more. */
static inline double screening_white(const struct screening *s)
{
    return fmax(noise_deviation(&s->noise), s->deviation);
}

/* Whether a sample without two new fixes is one between those of slower receivers, and is no evidence. */
static inline int screening_waits(const struct screening *s, double time)
{
    return time - s->paired < BETWEEN_FIXES;
}

/* Test both fixes against their gates and each other. deviation: of one coordinate of a nominal fix, with sway, m. */
static inline void screening_test(struct screening *s, double time, const struct fix_pair *pair, double deviation,
                                  int *outside)
{
    const double by_speed = s->late * s->manoeuvre.change.speed, *widenings = pair->widenings;
    const double widening = fmax(widenings[0], widenings[1]);
    double across[2];

    for (int i = 0; i < 2; ++i) {
        across[i] = s->lateral * fmax(deviation, pair->reported[i]);
        const double longitudinal = fmax(s->longitudinal, s->lateral * pair->reported[i]) + widenings[i] + by_speed;
        outside[i] = !(fabs(pair->innovations[2 * i + 1]) <= across[i] + widenings[i]
                       && fabs(pair->innovations[2 * i]) <= longitudinal);
    }
    if (pair->both) {
        s->paired = time;
        screening_narrow(s, pair->innovations, across, widening, outside);
        screening_compare(s, pair->innovations, outside, deviation, widening);
    } else if (!screening_waits(s, time)) {
        s->refused = 0;
        noise_interrupt(&s->noise);
        suspicion_forget(&s->suspicion);
    }
}

/* Whether the distance of the antennas is the mean one, or at first the configured one. Once they have confirmed the estimate,
 * the direction from one to the other must also be about the expected one. */
static inline int screening_plausible(const struct screening *s, const struct fix_pair *pair)
{
    const double turned = s->length + s->lateral * s->deviation + fmax(pair->widenings[0], pair->widenings[1]);

    return fabs(pair->length_innovation - s->length_error) <= (s->lengths ? s->length : s->longitudinal)
        && (!s->trust.earned || fabs(pair->innovations[1] - pair->innovations[3]) <= turned);
}

static inline void screening_learn(struct screening *s, double length_innovation)
{
    s->lengths = s->lengths < s->long_memory ? s->lengths + 1 : s->long_memory;
    s->length_error += (length_innovation - s->length_error) / s->lengths;
}

/* Compare the fixes of a measurement with what is expected of them: x, y of the tractor's antenna and of the trailer's, m.
 * `found` becomes the status of each. */
static inline struct fix_pair screening_pair(struct screening *s, const struct drawbar_measurement *measurement,
                                             const double *expected, int32_t *found)
{
    struct fix_pair pair = {
        .fixes = {measurement->tractor_x, measurement->tractor_y, measurement->trailer_x, measurement->trailer_y},
        .reported = {measurement->tractor_fix_deviation, measurement->trailer_fix_deviation},
    };

    pair.both = pair_receive(&pair, s->receivers, measurement->time, expected, s->repetition, COARSE * s->deviation, found);
    antenna_innovations(pair.fixes, expected, pair.innovations);
    pair.length_innovation = antenna_length_error(pair.fixes, expected);
    screening_widenings(s, measurement->time, distance(expected, expected + 2), pair.widenings);
    return pair;
}

/* Reject the fixes that lie outside their gates or are suspect. Returns how many of both do or are, new or not. */
static inline int screening_reject(const struct screening *s, const int *outside, int32_t *found)
{
    int refused = 0;

    for (int i = 0; i < 2; ++i)
        if (outside[i] || s->suspicion.suspect == TRACTOR_ANTENNA + i) {
            found[i] = found[i] == DRAWBAR_FIX_ACCEPTED ? DRAWBAR_FIX_REJECTED : found[i];
            ++refused;
        }
    return refused;
}

/* Put both fixes into a measurement. */
static inline void screening_place(const double *fixes, struct drawbar_measurement *measurement)
{
    measurement->tractor_x = fixes[0];
    measurement->tractor_y = fixes[1];
    measurement->trailer_x = fixes[2];
    measurement->trailer_y = fixes[3];
}

/* Start a screened measurement: of speed and steering angles single outliers are masked. */
static inline void screening_spikes(struct screening *s, const struct drawbar_measurement *measurement,
                                    struct drawbar_measurement *accepted)
{
    *accepted = *measurement;
    accepted->speed = spike_filtered(&s->spikes[0], s->speed, measurement->speed);
    accepted->tractor_steering = spike_filtered(&s->spikes[1], s->steering, measurement->tractor_steering);
    accepted->trailer_steering = spike_filtered(&s->spikes[2], s->steering, measurement->trailer_steering);
}

/* Mask the fixes that were not accepted. */
static inline void screening_accept(struct screening *s, const struct drawbar_measurement *measurement,
                                    struct screened *screened)
{
    const double reported[] = {measurement->tractor_fix_deviation, measurement->trailer_fix_deviation};
    struct drawbar_measurement *accepted = &screened->measurement;

    if (screened->fixes[0] != DRAWBAR_FIX_ACCEPTED)
        accepted->tractor_x = accepted->tractor_y = (double)NAN;
    if (screened->fixes[1] != DRAWBAR_FIX_ACCEPTED)
        accepted->trailer_x = accepted->trailer_y = (double)NAN;
    for (int i = 0; i < 2; ++i)
        if (screened->fixes[i] == DRAWBAR_FIX_ACCEPTED && !(reported[i] > COARSE * s->deviation)) {
            s->receivers[i].accepted = measurement->time;
            s->receivers[i].was_accepted = 1;
        }
}

/* Add the variance by sway of the masts (m2) to that of both fixes, unless the attitude of both bodies is measured: then it is none
 * of masts. Fixes that count less the further they are from the estimate would let it follow wheels that have play. */
static inline void screening_weigh(const struct screening *s, double sway, struct drawbar_measurement *accepted)
{
    double *reported[] = {&accepted->tractor_fix_deviation, &accepted->trailer_fix_deviation};
    const int measured = isfinite(accepted->tractor_roll) && isfinite(accepted->trailer_roll);

    for (int i = 0; i < 2 && sway > 0.0 && !measured; ++i) {
        const double white = isnan(*reported[i]) ? s->deviation : *reported[i];
        *reported[i] = sqrt(white * white + sway);
    }
}

/* Screen a measurement, as the sensors report it: mask what is rejected, and add sway to the variance of the fixes.
 *
 * expected: x, y (m) of the tractor's antenna and of the trailer's where the estimator expects them at its time;
 * yaw_rate: of the tractor, by its wheels, rad/s; NaN: unknown. */
static inline void screening_judge(struct screening *s, const struct drawbar_measurement *measurement,
                                   const double *expected, double yaw_rate, struct screened *screened)
{
    screening_spikes(s, measurement, &screened->measurement);
    const struct motion motion = {screened->measurement.speed, yaw_rate};
    const double white = screening_white(s);
    const double sway = s->single_growth > 0.0 ? 0.0 : sway_variance(&s->suspicion, white); /* not observable without coupling */
    const int32_t before = s->suspicion.suspect;
    int outside[2];

    manoeuvre_update(&s->manoeuvre, &motion, s->settling);
    const struct fix_pair pair = screening_pair(s, measurement, expected, screened->fixes);
    screening_test(s, measurement->time, &pair, sqrt(white * white + sway), outside);
    const int refused = screening_reject(s, outside, screened->fixes);
    const int agreeing = pair.both && screening_plausible(s, &pair);
    screened->restart = (pair.both || !screening_waits(s, measurement->time))
        && trust_overruled(&s->trust, measurement->time, agreeing, refused, s->patience);
    screened->exposed = s->suspicion.suspect != before && !screened->restart ? s->suspicion.suspect : NEITHER;
    if (screened->restart) {
        suspicion_forget(&s->suspicion);
        screened->fixes[0] = screened->fixes[1] = DRAWBAR_FIX_ACCEPTED;
        screening_place(pair.fixes, &screened->measurement);
    } else if (pair.both && !refused) {
        screening_learn(s, pair.length_innovation);
    }
    screening_accept(s, measurement, screened);
    screening_weigh(s, sway, &screened->measurement);
}

/* Move both fixes along the line through the antennas by half of the mean error of their distance: no state explains wrong
 * lengths, so the estimate would distort yaws and angles instead. Antennas that the model does not couple (single_growth) have
 * no known distance. */
static inline void screening_lengths(const struct screening *s, const double *expected, struct screened *screened)
{
    struct drawbar_measurement *accepted = &screened->measurement;
    const double share = 0.5 * s->length_error / distance(expected, expected + 2);
    const double east = share * (expected[0] - expected[2]), north = share * (expected[1] - expected[3]);

    if (s->single_growth > 0.0)
        return;
    accepted->tractor_x -= east;
    accepted->tractor_y -= north;
    accepted->trailer_x += east;
    accepted->trailer_y += north;
}

/* Mask a hitch angle whose innovation is too large, rad: it also follows from chain and antennas. */
static inline void screening_hitch(const struct screening *s, double expected, struct screened *screened)
{
    if (!(fabs(wrapped(screened->measurement.hitch_angle - expected)) <= s->hitch))
        screened->measurement.hitch_angle = (double)NAN;
}

/* The measurement, as reported, from which an estimate that both antennas overrule starts anew. */
static inline struct drawbar_measurement screened_anew(const struct screened *screened,
                                                       const struct drawbar_measurement *measurement)
{
    const struct drawbar_measurement *both = &screened->measurement;
    const double fixes[] = {both->tractor_x, both->tractor_y, both->trailer_x, both->trailer_y};
    struct drawbar_measurement anew = *measurement;

    screening_place(fixes, &anew);
    return anew;
}

/* Write the statuses of the fixes into an estimate. */
static inline void screened_mark(const struct screened *screened, struct drawbar_estimate *estimate)
{
    estimate->tractor_fix = screened->fixes[0];
    estimate->trailer_fix = screened->fixes[1];
}

#endif

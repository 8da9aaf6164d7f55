/* Screening of position fixes: what a receiver repeats, or cannot have seen, is masked before it is estimated with.
 *
 * Each fix is compared with where the estimator expects that antenna, across and along the vehicle: a validation gate
 * (Bar-Shalom, Li, Kirubarajan 2001, section 5.4) that widens while there is no fix and while the vehicle changes its
 * motion (manoeuvre.h). What is too small for the gate shows in how both antennas disagree (suspicion.h); what both agree
 * on prevails in the end (trust.h).
 */
#ifndef DRAWBAR_SCREENING_H
#define DRAWBAR_SCREENING_H

#include "leap.h"
#include "manoeuvre.h"
#include "noise_level.h"
#include "signals.h"
#include "suspicion.h"
#include "sway.h"
#include "trust.h"

#define COARSE 3.0                         /* usual deviations; with more a fix vouches for nothing and accuses no one */

/* What is remembered of one receiver. */
struct receiver {
    double fix[2], expected[2];            /* what it reports; where the antenna was expected when it first did, m */
    time_stamp accepted;                   /* of the last accepted fix that was not coarse */
    int32_t reported, was_accepted;        /* has it ever reported a fix; has one been accepted? */
};

struct screening {
    /* settings: estimation/settings.py tells what they mean */
    double lateral, longitudinal, growth, single_growth, shift, release, length, hitch, repetition, patience, late;
    double steering, speed;
    double deviation;                      /* of one coordinate of a fix at least, m */
    int32_t memory, long_memory, settling;
    /* state */
    struct receiver receivers[2];
    struct noise_level noise;
    struct suspicion suspicion;
    struct trust trust;
    struct manoeuvre manoeuvre;
    struct leap leaps[3];                  /* of speed and both steerings */
    double length_error;                   /* mean error of the antennas' distance, m */
    int32_t refused;                       /* both fixes of the last sample lay outside their gates */
    int32_t lengths;                       /* samples in it */
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

/* A measurement without the fixes that are not to be believed. */
struct screened {
    struct drawbar_measurement measurement;   /* NaN in place of what was masked */
    int32_t fixes[2];                      /* enum drawbar_fix of the tractor's antenna and of the trailer's */
    int32_t exposed;                       /* enum antenna: has become suspect with this sample; what it reported just
                                            * before was wrong as well */
    int32_t restart;                       /* both antennas overrule the estimate: it is to start anew from this
                                            * measurement */
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

/* By how much each gate has widened for want of a fix, and because the vehicle of this length (m) turns another way than
 * before, m. */
static inline void screening_rooms(const struct screening *s, double time, double length, double *rooms)
{
    const double turned = s->late * s->manoeuvre.change.yaw_rate * length;
    double blind[2];

    for (int i = 0; i < 2; ++i)
        blind[i] = s->receivers[i].was_accepted ? time - s->receivers[i].accepted : 0.0;
    for (int i = 0; i < 2; ++i)
        rooms[i] = s->growth * fmin(blind[0], blind[1]) + s->single_growth * blind[i] + turned;
}

/* Let both fixes, which lie so far (4 values, m) from where they are expected, be compared with each other. */
static inline void screening_compare(struct screening *s, double *offsets, const int *outside, double deviation,
                                     double room)
{
    const double changing = noise_deviation(&s->noise);
    const struct suspicion_limits limits = {
        .most = s->lateral * deviation,
        .shift = s->shift * deviation,
        .release = s->release / s->shift,
        .lasting = fmax(s->deviation * s->deviation - changing * changing, 0.0),
        .room = room,
        .memory = s->memory,
    };

    offsets[0] -= 0.5 * s->length_error;   /* each is off by half of what the configured lengths are wrong */
    offsets[2] += 0.5 * s->length_error;
    const double disagreement[] = {offsets[0] - offsets[2], offsets[1] - offsets[3]};
    noise_update(&s->noise, disagreement, 2.0 * limits.most, s->long_memory);
    if (s->trust.earned)                   /* an estimate that nobody has confirmed yet accuses no one */
        suspicion_update(&s->suspicion, &limits, offsets, outside);
    else
        suspicion_forget(&s->suspicion);
}

/* Let two false fixes not come back one after the other because the gates widen while both are refused: unless both come
 * back and agree, a fix must be inside without that. One that the model does not tie to the other (single_growth) stands by
 * itself.
 *
 * offsets: of both fixes (4 values, m); across: both gates before they widened, m; room: by how much they have, m. */
static inline void screening_narrow(struct screening *s, const double *offsets, const double *across, double room,
                                    int *outside)
{
    const int apart = outside[0] || outside[1] || distance(offsets, offsets + 2) > hypot(across[0], across[1]) + room;

    if (s->refused && apart && !(s->single_growth > 0.0))
        for (int i = 0; i < 2; ++i)
            outside[i] |= !(fabs(offsets[2 * i + 1]) <= across[i]);
    s->refused = outside[0] && outside[1];
}

/* The deviation of one coordinate of a usual fix, m: the stated one, or what the fixes show where that is more. */
static inline double screening_white(const struct screening *s)
{
    return fmax(noise_deviation(&s->noise), s->deviation);
}

/* Find which fixes lie outside their gates, and who is suspect.
 *
 * told: deviation of each fix, m, NaN: the usual one; both: both have a fix that can vouch for the other; deviation:
 * of one coordinate of a usual fix, with sway, m. */
static inline void screening_gate(struct screening *s, double time, const double *fixes, const double *expected,
                                  const double *told, int both, double deviation, int *outside)
{
    const double sped = s->late * s->manoeuvre.change.speed;
    double offsets[4], rooms[2], across[2];

    antenna_offsets(fixes, expected, offsets);
    screening_rooms(s, time, distance(expected, expected + 2), rooms);
    for (int i = 0; i < 2; ++i) {
        across[i] = s->lateral * fmax(deviation, told[i]);
        const double longitudinal = fmax(s->longitudinal, s->lateral * told[i]) + rooms[i] + sped;
        outside[i] = !(fabs(offsets[2 * i + 1]) <= across[i] + rooms[i] && fabs(offsets[2 * i]) <= longitudinal);
    }
    if (both) {
        screening_narrow(s, offsets, across, fmax(rooms[0], rooms[1]), outside);
        screening_compare(s, offsets, outside, deviation, fmax(rooms[0], rooms[1]));
    } else {
        s->refused = 0;
        noise_interrupt(&s->noise);
        suspicion_forget(&s->suspicion);
    }
}

/* Are the antennas as far from each other as they have been, or at first as they should be? Once they have confirmed the
 * estimate, one must also be seen from the other in about the expected direction: nothing turns the vehicle unseen. */
static inline int screening_plausible(const struct screening *s, double time, const double *fixes,
                                      const double *expected, double error)
{
    double offsets[4], rooms[2];

    antenna_offsets(fixes, expected, offsets);
    screening_rooms(s, time, distance(expected, expected + 2), rooms);
    const double turned = s->length + s->lateral * s->deviation + fmax(rooms[0], rooms[1]);
    return fabs(error - s->length_error) <= (s->lengths ? s->length : s->longitudinal)
        && (!s->trust.earned || fabs(offsets[1] - offsets[3]) <= turned);
}

static inline void screening_learn(struct screening *s, double error)
{
    s->lengths = s->lengths < s->long_memory ? s->lengths + 1 : s->long_memory;
    s->length_error += (error - s->length_error) / s->lengths;
}

/* What each receiver reports; returns whether both have a fix. */
static inline int screening_receive(struct screening *s, const double *fixes, const double *expected, int32_t *found)
{
    for (int i = 0; i < 2; ++i)
        found[i] = receiver_fix(&s->receivers[i], fixes + 2 * i, expected + 2 * i, s->repetition);
    return found[0] == DRAWBAR_FIX_ACCEPTED && found[1] == DRAWBAR_FIX_ACCEPTED;
}

/* Reject the fixes that lie outside their gates or are suspect; returns how many. */
static inline int screening_reject(const struct screening *s, const int *outside, int32_t *found)
{
    int rejected = 0;

    for (int i = 0; i < 2; ++i)
        if (found[i] == DRAWBAR_FIX_ACCEPTED && (outside[i] || s->suspicion.suspect == TRACTOR_ANTENNA + i)) {
            found[i] = DRAWBAR_FIX_REJECTED;
            ++rejected;
        }
    return rejected;
}

/* Begin a screened measurement: of speed and steering angles a single false one is masked. */
static inline void screening_leaps(struct screening *s, const struct drawbar_measurement *measurement,
                                   struct drawbar_measurement *believed)
{
    *believed = *measurement;
    believed->speed = leap_masked(&s->leaps[0], s->speed, measurement->speed);
    believed->tractor_steering = leap_masked(&s->leaps[1], s->steering, measurement->tractor_steering);
    believed->trailer_steering = leap_masked(&s->leaps[2], s->steering, measurement->trailer_steering);
}

/* Mask the fixes that are not to be believed. */
static inline void screening_accept(struct screening *s, const struct drawbar_measurement *measurement,
                                    struct screened *screened)
{
    const double told[] = {measurement->tractor_fix_deviation, measurement->trailer_fix_deviation};
    struct drawbar_measurement *believed = &screened->measurement;

    if (screened->fixes[0] != DRAWBAR_FIX_ACCEPTED)
        believed->tractor_x = believed->tractor_y = (double)NAN;
    if (screened->fixes[1] != DRAWBAR_FIX_ACCEPTED)
        believed->trailer_x = believed->trailer_y = (double)NAN;
    for (int i = 0; i < 2; ++i)
        if (screened->fixes[i] == DRAWBAR_FIX_ACCEPTED && !(told[i] > COARSE * s->deviation)) {
            s->receivers[i].accepted = measurement->time;
            s->receivers[i].was_accepted = 1;
        }
}

/* Let both fixes count for as little as this sway of their masts leaves them, a variance in m2. */
static inline void screening_weigh(const struct screening *s, double sway, struct drawbar_measurement *believed)
{
    double *told[] = {&believed->tractor_fix_deviation, &believed->trailer_fix_deviation};

    for (int i = 0; i < 2 && sway > 0.0; ++i) {
        const double white = isnan(*told[i]) ? s->deviation : *told[i];
        *told[i] = sqrt(white * white + sway);
    }
}

/* Mask what is not to be believed of a measurement, as the sensors report it, and say how little swaying fixes count.
 *
 * expected: x, y (m) of the tractor's antenna and of the trailer's where the estimator expects them at its time;
 * yaw_rate: of the tractor, as its wheels turn it then, rad/s; NaN: not known. */
static inline void screening_judge(struct screening *s, const struct drawbar_measurement *measurement,
                                   const double *expected, double yaw_rate, struct screened *screened)
{
    screening_leaps(s, measurement, &screened->measurement);
    const struct motion motion = {screened->measurement.speed, yaw_rate};
    const double fixes[] = {measurement->tractor_x, measurement->tractor_y, measurement->trailer_x,
                            measurement->trailer_y};
    const double told[] = {measurement->tractor_fix_deviation, measurement->trailer_fix_deviation};
    const int fine = !(fmax(told[0], told[1]) > COARSE * s->deviation);
    const double error = antenna_length_error(fixes, expected), white = screening_white(s);
    const double sway = s->single_growth > 0.0 ? 0.0 : sway_variance(&s->suspicion, white); /* untied antennas show none */
    const int32_t before = s->suspicion.suspect;
    int outside[2];

    manoeuvre_update(&s->manoeuvre, &motion, s->settling);
    const int both = screening_receive(s, fixes, expected, screened->fixes) && fine;
    screening_gate(s, measurement->time, fixes, expected, told, both, sqrt(white * white + sway), outside);
    const int rejected = screening_reject(s, outside, screened->fixes);
    const int agreeing = both && screening_plausible(s, measurement->time, fixes, expected, error);
    screened->restart = trust_overruled(&s->trust, measurement->time, agreeing, rejected, s->patience);
    screened->exposed = s->suspicion.suspect != before && !screened->restart ? s->suspicion.suspect : NEITHER;
    if (screened->restart) {
        suspicion_forget(&s->suspicion);
        screened->fixes[0] = screened->fixes[1] = DRAWBAR_FIX_ACCEPTED;
    } else if (both && !rejected) {
        screening_learn(s, error);
    }
    screening_accept(s, measurement, screened);
    screening_weigh(s, sway, &screened->measurement);
}

/* Move both fixes along the line through the antennas by half of what their distance is wrong on average: nothing of the chain
 * explains wrong lengths, and an estimate that has to would bend the chain. Antennas that the model does not tie together
 * (single_growth) have no distance that is known. */
static inline void screening_lengths(const struct screening *s, const double *expected, struct screened *screened)
{
    struct drawbar_measurement *believed = &screened->measurement;
    const double share = 0.5 * s->length_error / distance(expected, expected + 2);
    const double east = share * (expected[0] - expected[2]), north = share * (expected[1] - expected[3]);

    if (s->single_growth > 0.0)
        return;
    believed->tractor_x -= east;
    believed->tractor_y -= north;
    believed->trailer_x += east;
    believed->trailer_y += north;
}

/* Mask a hitch angle that is too far from the expected one, rad: chain and antennas know it as well. */
static inline void screening_hitch(const struct screening *s, double expected, struct screened *screened)
{
    if (!(fabs(wrapped(screened->measurement.hitch_angle - expected)) <= s->hitch))
        screened->measurement.hitch_angle = (double)NAN;
}

/* Let the estimate say what became of the fixes. */
static inline void screened_mark(const struct screened *screened, struct drawbar_estimate *estimate)
{
    estimate->tractor_fix = screened->fixes[0];
    estimate->trailer_fix = screened->fixes[1];
}

#endif

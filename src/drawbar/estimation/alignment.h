/* Alignment: from measured values to those that the sensors would measure at the points on the ground, now.
 *
 * Positions: position_alignment.h. The other sensors' values change by what is expected of their quantities since they were
 * measured (between_samples.h), the angles of hitch and joint without the errors that are found of them (angle_errors.h), the
 * tractor's yaw and yaw rate without their sensors' errors (yaw_alignment.h).
 */
#ifndef DRAWBAR_ALIGNMENT_H
#define DRAWBAR_ALIGNMENT_H

#include "ages.h"
#include "angle_errors.h"
#include "fix_deviation.h"
#include "position_alignment.h"
#include "unit.h"
#include "yaw_alignment.h"

#define FALSE_ANGLE 0.2                    /* difference of an angle from the expected one from which it may be false, rad */

struct component {
    struct fix_deviations deviations;
    struct chain chain;
    double fix_age;                        /* of positions whose receiver reports none, s */
    struct position_alignment positions;
    struct coarse_noise noises[ALIGNED];
    struct yaw_sensor yaw;                 /* the tractor's */
    struct yaw_rate_sensor yaw_rate;       /* the tractor's */
    struct rate_history rates;             /* the tractor's, by the wheels */
    struct yaw_residual yaw_residual;
    struct angle_errors angles;            /* of hitch and joint */
    int32_t identifies;                    /* these are learned: the estimate is no given truth */
};

#define COMPONENT_FIELDS                                                                                          \
    FIX_DEVIATIONS_FIELDS(component, deviations) CHAIN_FIELDS(component, chain)                                        \
    SETTING(component, fix_age, 0, 1, 0, 0) POSITION_ALIGNMENT_FIELDS(component, positions)                            \
    SETTING(component, yaw.gate, 0, 1, 0, 0)                                                                           \
    FIELD(component, yaw.error, 0, 1, 0, 0) FIELD(component, yaw.latency, 0, 1, 0, 0)                                  \
    FIELD(component, yaw.change, 0, 1, 0, 0) FIELD(component, yaw_rate.exclusion, 0, 1, 0, 0)                                           \
    FIELD(component, angles.latency, 0, 1, 0, 0) FIELD(component, angles.scales, 0, ANGLES, 0, 0)                      \
    SETTING(component, identifies, 1, 1, 0, 0)

/* The estimated latency of fixes beyond their age, s. */
static inline double fix_latency(const struct component *alignment)
{
    return fmax(alignment->yaw_rate.latency, 0.0);
}

/* The age of a fix, s, with the estimated latency; NaN: too old, or of the future. */
static inline double age_of_fix(const struct component *alignment, double reported)
{
    const double age = (reported == 0.0 || isnan(reported) ? alignment->fix_age : reported) + fix_latency(alignment);
    return age >= 0.0 && age <= OLDEST ? age : (double)NAN;
}

/* Bring the values of all sensors but the receivers up to now, in place, without the errors that are found of them. */
static inline void align_angles(const struct sample_interval *interval, const struct angle_errors *errors,
                                struct drawbar_measurement *m)
{
    const struct drawbar_estimate *last = interval->last, *now = interval->expected;
    const double hitch_age = isnan(m->hitch_angle_age) ? errors->latency : m->hitch_angle_age + errors->latency;

    m->hitch_angle *= 1.0 + errors->scales[HITCH];
    m->trailer_steering *= 1.0 + errors->scales[JOINT];
    m->hitch_angle = brought_up(interval, m->hitch_angle, hitch_age, last->hitch_angle, now->hitch_angle);
    m->speed = brought_up(interval, m->speed, m->speed_age, last->speed, now->speed);
    m->tractor_steering = brought_up(interval, m->tractor_steering, m->tractor_steering_age, last->tractor_steering,
                                     now->tractor_steering);
    m->trailer_steering = brought_up(interval, m->trailer_steering, m->trailer_steering_age, last->trailer_steering,
                                     now->trailer_steering);
}

/* Learn the errors of hitch and joint, from what is brought up to now; not from coarse fixes, nor while those of an antenna are
 * rejected, nor from a false angle. */
static inline void learn_angle_errors(struct component *alignment, const struct sample_interval *interval,
                                      const struct drawbar_measurement *m)
{
    const struct drawbar_estimate *last = interval->last, *now = interval->expected;
    const struct mast *masts = alignment->positions.masts;
    const int coarse = fixes_are_coarse(m) || alignment->positions.fix_deviation > COARSE_REFERENCE;
    const int rejected = last->tractor_fix == DRAWBAR_FIX_REJECTED || last->trailer_fix == DRAWBAR_FIX_REJECTED;
    const double missing = coarse || rejected ? (double)NAN : 0.0;
    const double beside = fmax(fabs(m->hitch_angle - now->hitch_angle), fabs(m->trailer_steering - now->trailer_steering));
    const double false_angle = beside > FALSE_ANGLE ? (double)NAN : 0.0;
    const struct angle_sample sample = {
        .points = {m->tractor_x + missing, m->tractor_y + missing, m->trailer_x + missing, m->trailer_y + missing},
        .yaw = now->tractor.yaw,
        .angles = {m->hitch_angle + false_angle, m->trailer_steering},
        .bent = now->hitch_angle - last->hitch_angle,
        .swung = now->trailer_steering - last->trailer_steering,
        .creep = now->creep,
        .sways = mast_sways(&masts[ALIGNED_TRACTOR], m->tractor_roll) || mast_sways(&masts[ALIGNED_TRAILER], m->trailer_roll),
    };

    angle_errors_take(&alignment->angles, &sample, alignment->positions.to_axle, interval->elapsed);
}

/* Set the standard deviation of each fix, already on the ground; drop what is no fix. */
static inline void judge_deviations(struct component *alignment, const struct drawbar_estimate *expected,
                                    struct drawbar_measurement *m)
{
    const double tractor[] = {m->tractor_x - expected->tractor.x, m->tractor_y - expected->tractor.y};
    const double trailer[] = {m->trailer_x - expected->trailer.x, m->trailer_y - expected->trailer.y};

    m->tractor_fix_deviation = fix_deviation(&alignment->deviations, &alignment->noises[ALIGNED_TRACTOR],
                                             m->tractor_fix_deviation, m->tractor_fix_quality, tractor);
    m->trailer_fix_deviation = fix_deviation(&alignment->deviations, &alignment->noises[ALIGNED_TRAILER],
                                             m->trailer_fix_deviation, m->trailer_fix_quality, trailer);
    if (m->tractor_fix_deviation < 0.0)
        m->tractor_x = m->tractor_y = (double)NAN;
    if (m->trailer_fix_deviation < 0.0)
        m->trailer_x = m->trailer_y = (double)NAN;
}

/* Where the trailer's point is behind the tractor's, whose yaw and angles are known, in place; NaN where one is not. */
static inline void complete_trailer(const struct chain *chain, struct drawbar_measurement *m)
{
    const double phi = m->tractor_yaw - m->hitch_angle, psi = phi - known(m->trailer_steering);
    double antenna[2];

    trailer_antenna(chain, m->tractor_x, m->tractor_y, m->tractor_yaw, phi, psi, antenna);
    m->trailer_x = antenna[0];
    m->trailer_y = antenna[1];
}

/* A body's first attitude: an angle that is missing or implausible counts as zero. */
static inline struct attitude first_attitude(const struct mast *mast, double roll, double pitch)
{
    const double leans = roll - mast->roll_offset, rises = pitch - mast->pitch_offset;

    return (struct attitude){fabs(leans) <= MOST_LEAN ? leans : 0.0, fabs(rises) <= MOST_LEAN ? rises : 0.0};
}

/* Move a position (m) from its antenna to the ground, in place. */
static inline void to_ground(const struct mast *mast, double yaw, struct attitude attitude, double *x, double *y)
{
    double arm[2];

    lever_arm(mast, yaw, attitude.roll, attitude.pitch, arm);
    *x -= arm[0];
    *y -= arm[1];
}

/* The measurement that a run begins with: of a vehicle at rest, so that only the masts matter. Its yaws follow from both
 * antennas' positions. A missing position of the trailer follows from the tractor's yaw and the angles. */
int UNIT(begin)(struct component *alignment, const struct drawbar_measurement *first,
                struct drawbar_measurement *aligned)
{
    static const struct drawbar_estimate nowhere = {.tractor = {(double)NAN, (double)NAN, (double)NAN}};
    const struct mast *const front = &alignment->positions.masts[ALIGNED_TRACTOR];
    const struct mast *const rear = &alignment->positions.masts[ALIGNED_TRAILER];
    const struct attitude tractor = first_attitude(front, first->tractor_roll, first->tractor_pitch);
    const struct attitude trailer = first_attitude(rear, first->trailer_roll, first->trailer_pitch);
    double ahead[2], behind[2], tractor_yaw, trailer_yaw;

    *aligned = *first;
    judge_deviations(alignment, &nowhere, aligned);
    if (!isfinite(aligned->trailer_x + aligned->trailer_y) && isfinite(aligned->tractor_yaw)) {
        to_ground(front, aligned->tractor_yaw, tractor, &aligned->tractor_x, &aligned->tractor_y);
        complete_trailer(&alignment->chain, aligned);
        return 0;
    }
    lever_arm(front, gamma_at_rest(aligned), tractor.roll, tractor.pitch, ahead);
    lever_arm(rear, 0.0, trailer.roll, trailer.pitch, behind);
    const double beyond[] = {ahead[0] - behind[0], ahead[1] - behind[1]};
    if (!yaws_apart(&alignment->chain, aligned, beyond, &tractor_yaw, &trailer_yaw))
        return 0;
    to_ground(front, tractor_yaw, tractor, &aligned->tractor_x, &aligned->tractor_y);
    to_ground(rear, trailer_yaw, trailer, &aligned->trailer_x, &aligned->trailer_y);
    return 0;
}

/* Report the identified errors of the sensors: unreported latencies, scales of hitch and joint, zeros of the roll sensors. */
void UNIT(report)(const struct component *alignment, struct drawbar_actuation *found)
{
    const struct roll_zero tractor = roll_zero(&alignment->positions, ALIGNED_TRACTOR);
    const struct roll_zero trailer = roll_zero(&alignment->positions, ALIGNED_TRAILER);

    found->fix_latency = fix_latency(alignment);
    found->hitch_latency = alignment->angles.latency;
    found->hitch_scale = alignment->angles.scales[HITCH];
    found->joint_scale = alignment->angles.scales[JOINT];
    found->tractor_roll_offset = tractor.value;
    found->tractor_roll_deviation = tractor.deviation;
    found->trailer_roll_offset = trailer.value;
    found->trailer_roll_deviation = trailer.deviation;
}

/* The largest recent departure of the fixes' yaw from the yaw rate, rad; NaN: unknown. */
void UNIT(departure)(const struct component *alignment, double *departure)
{
    *departure = yaw_residual_departure(&alignment->yaw_residual);
}

/* Align a measurement; returns 0 or the status with which the run ends. last: the newest estimate; expected: the one that
 * is expected at the measurement's time, before it is taken in; its own time is the model's, which time stamps need not keep. */
int UNIT(apply)(struct component *alignment, const struct drawbar_measurement *measurement,
                const struct drawbar_estimate *last, const struct drawbar_estimate *expected,
                struct drawbar_measurement *aligned)
{
    const struct sample_interval interval = {
        last, expected, measurement->time, measurement->time - last->time, expected->time - last->time};
    struct position_alignment *const positions = &alignment->positions;

    *aligned = *measurement;
    ages_of_now(aligned);
    lean_watch_propagate(&positions->leans, moved_within(&interval));
    move_swing(&positions->leans.swings[ALIGNED_TRACTOR], &interval, &last->tractor, &expected->tractor);
    move_swing(&positions->leans.swings[ALIGNED_TRAILER], &interval, &last->trailer, &expected->trailer);
    take_attitude(positions, ALIGNED_TRACTOR, &interval, aligned->tractor_attitude_age, &aligned->tractor_roll,
                  &aligned->tractor_pitch);
    take_attitude(positions, ALIGNED_TRAILER, &interval, aligned->trailer_attitude_age, &aligned->trailer_roll,
                  &aligned->trailer_pitch);
    record_ground(positions, &interval);
    double tractor[] = {aligned->tractor_x, aligned->tractor_y}, trailer[] = {aligned->trailer_x, aligned->trailer_y};
    align_fix(positions, ALIGNED_TRACTOR, &interval, age_of_fix(alignment, aligned->tractor_fix_age),
              aligned->tractor_fix_deviation, tractor);
    align_fix(positions, ALIGNED_TRAILER, &interval, age_of_fix(alignment, aligned->trailer_fix_age),
              aligned->trailer_fix_deviation, trailer);
    aligned->tractor_x = tractor[0];
    aligned->tractor_y = tractor[1];
    aligned->trailer_x = trailer[0];
    aligned->trailer_y = trailer[1];
    judge_deviations(alignment, expected, aligned);
    align_angles(&interval, &alignment->angles, aligned);
    if (alignment->identifies)
        learn_angle_errors(alignment, &interval, aligned);
    align_yaw(&alignment->yaw, &alignment->chain, &interval, fix_latency(alignment), aligned);
    align_yaw_rate(&alignment->yaw_rate, &alignment->rates, &alignment->yaw_residual, &alignment->chain, &interval,
                   aligned);
    const int present[] = {attitude_is_new(&positions->tracks[ALIGNED_TRACTOR], interval.now),
                           attitude_is_new(&positions->tracks[ALIGNED_TRAILER], interval.now)};
    return lean_watch_judge(&positions->leans, present, interval.elapsed);
}

#endif

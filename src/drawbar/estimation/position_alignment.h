/* Position alignment: fixes from their antennas to the points on the ground, at the time of the sample.
 *
 * Each position goes from its antenna to the ground with the yaw and the attitude of its own time, and from there as far as
 * the body has moved since. A fix that its receiver repeats is corrected as before, so that it stays recognisable as a
 * repetition.
 */
#ifndef DRAWBAR_POSITION_ALIGNMENT_H
#define DRAWBAR_POSITION_ALIGNMENT_H

#include "attitude_track.h"
#include "between_samples.h"
#include "ground_record.h"
#include "lean_watch.h"
#include "lever_arm.h"

enum { ALIGNED_TRACTOR, ALIGNED_TRAILER, ALIGNED };

struct reported_fix {
    double reported[2], aligned[2];        /* m */
    double age;                            /* when it was last reported, s */
    int32_t known;
};

struct position_alignment {
    struct mast masts[ALIGNED];
    double to_axle;                        /* from the trailer's tracked point back to its axle, m */
    double fix_deviation;                  /* of fixes whose receiver reports none, m */
    struct attitude_track tracks[ALIGNED];
    double local[ALIGNED];                 /* weight of the slope recorded nearby, see ground_slope */
    struct ground_record ground;
    struct reported_fix fixes[ALIGNED];
    struct lean_watch leans;               /* faults of the roll sensors */
};

#define POSITION_ALIGNMENT_FIELDS(type, place)                                                               \
    MAST_FIELDS(type, place.masts[ALIGNED_TRACTOR]) MAST_FIELDS(type, place.masts[ALIGNED_TRAILER])          \
    SETTING(type, place.to_axle, 0, 1, 0, 0) SETTING(type, place.fix_deviation, 0, 1, 0, 0)                  \
    SETTING(type, place.ground.spacing, 0, 1, 0, 0) FIELD(type, place.leans.faults, 1, LEAN_BODIES, 0, 0)        \
    FIELD(type, place.leans.bank.states, 0, SIGNS, LEANS, 0)                                                 \
    FIELD(type, place.leans.bank.covariance, 0, LEANS, LEANS, 0)

static inline const struct drawbar_pose *body_pose(const struct drawbar_estimate *estimate, int body)
{
    return body == ALIGNED_TRACTOR ? &estimate->tractor : &estimate->trailer;
}

/* The estimated zero of a body's roll sensor, beyond the stated offset. */
static inline struct roll_zero roll_zero(const struct position_alignment *positions, int body)
{
    return lean_bank_zero(&positions->leans.bank, body, positions->masts[body].roll_deviation);
}

/* Record roll and pitch of a body's sensor, and correct them in place by the stated offsets and the estimated zero; NaN where
 * they are too old. */
static inline void take_attitude(struct position_alignment *positions, int body, const struct sample_interval *interval, double age,
                                 double *roll_now, double *pitch_now)
{
    const struct mast *mast = &positions->masts[body];
    const double roll = *roll_now - mast->roll_offset, pitch = *pitch_now - mast->pitch_offset;
    const double last = body_pose(interval->last, body)->yaw;
    const double now = body_pose(interval->expected, body)->yaw;

    const double zero = roll_zero_correction(roll_zero(positions, body));
    if (attitude_record(&positions->tracks[body], interval->now, age, roll - zero, pitch))
        lean_watch_attitude(&positions->leans, body, at_age(interval, age, last, now), roll, pitch, interval->elapsed);
    const struct attitude_track *track = &positions->tracks[body];
    const int stands = attitude_is_new(track, interval->now);
    *roll_now = stands ? track->roll[track->count - 1] : (double)NAN;
    *pitch_now = stands ? track->pitch[track->count - 1] : (double)NAN;
}

/* Record the ground's slope below the tractor, or else below the trailer, by its newest attitude. */
static inline void record_ground(struct position_alignment *positions, const struct sample_interval *interval)
{
    const int body = attitude_is_new(&positions->tracks[ALIGNED_TRACTOR], interval->now) ? ALIGNED_TRACTOR : ALIGNED_TRAILER;
    const struct attitude_track *track = &positions->tracks[body];
    const struct drawbar_pose *last = body_pose(interval->last, body);
    const struct drawbar_pose *now = body_pose(interval->expected, body);
    double slope[2];

    if (!attitude_is_new(track, interval->now))
        return;
    const double age = interval->now - track->time[track->count - 1], yaw = at_age(interval, age, last->yaw, now->yaw);
    const double back = body == ALIGNED_TRAILER ? positions->to_axle : 0.0;
    slope_below(yaw, track->roll[track->count - 1], track->pitch[track->count - 1], slope);
    ground_record_slope(&positions->ground, at_age(interval, age, last->x, now->x) - back * cos(yaw),
                        at_age(interval, age, last->y, now->y) - back * sin(yaw), slope);
}

/* The component of a displacement (m) to the left of a heading (rad), m. */
static inline double to_left(double yaw, const double *displacement)
{
    return displacement[1] * cos(yaw) - displacement[0] * sin(yaw);
}

/* Propagate the swing of a body's antenna to its next expected ground point. */
static inline void move_swing(struct mast_swing *swing, const struct sample_interval *interval, const struct drawbar_pose *last,
                              const struct drawbar_pose *now)
{
    const double corrected[] = {last->x - swing->expected[0], last->y - swing->expected[1]};
    const double expected[] = {now->x, now->y}, left = to_left(last->yaw, corrected);

    if (swing_begun(swing) && isfinite(left))
        swing_propagate(swing, expected, left, moved_within(interval));
    else
        swing_begin(swing, expected);
}

struct attitude {
    double roll, pitch;                    /* rad */
};

/* The attitude of a body at an age (s), at which it was at a pose: by its own sensor, else by the recorded ground. */
static inline struct attitude attitude_then(struct position_alignment *positions, int body, const struct sample_interval *interval,
                                            double age, const struct drawbar_pose *pose)
{
    struct attitude_track *track = &positions->tracks[body];
    const double own = attitude_weight(track, interval->now, interval->elapsed);
    const double back = body == ALIGNED_TRAILER ? positions->to_axle : 0.0;
    const int follows = body == ALIGNED_TRAILER && attitude_is_new(&positions->tracks[ALIGNED_TRACTOR], interval->now);
    struct attitude measured, recorded;
    double slope[2];

    attitude_at(track, interval->now - age, &measured.roll, &measured.pitch);
    ground_slope(&positions->ground, pose->x - back * cos(pose->yaw), pose->y - back * sin(pose->yaw), follows,
                 interval->elapsed, &positions->local[body], slope);
    lean_on(slope, pose->yaw, &recorded.roll, &recorded.pitch);
    return (struct attitude){recorded.roll + own * (measured.roll - recorded.roll),
                             recorded.pitch + own * (measured.pitch - recorded.pitch)};
}

/* Update the antenna's swing with where it is (m) and its body's roll. deviation: of the fix, as reported, m. */
static inline void watch_swing(struct position_alignment *positions, int body, const struct sample_interval *interval, double age,
                               double deviation, const double *antenna)
{
    const struct drawbar_pose *now = body_pose(interval->expected, body);
    const struct mast *mast = &positions->masts[body];
    const struct attitude_track *track = &positions->tracks[body];
    const double from_ground[] = {antenna[0] - now->x, antenna[1] - now->y};
    const double noise = isnan(deviation) ? positions->fix_deviation : deviation;
    double roll, pitch;

    if (!attitude_is_new(track, interval->now))
        return;
    attitude_at(track, interval->now - age, &roll, &pitch);
    swing_update(&positions->leans.swings[body], to_left(now->yaw, from_ground) - mast->left * cos(roll), -mast->up * sin(roll),
                 noise, !lean_is_constant(&positions->leans.constant[body]), interval->elapsed);
}

/* Whether a fix is the one that was reported before; it is then aligned as it was, or NaN where it is older now. */
static inline int repeats_fix(struct reported_fix *known, double age, double elapsed, double *fix)
{
    const double aged = age - known->age;

    known->age = age;
    if (!known->known || fix[0] != known->reported[0] || fix[1] != known->reported[1])
        return 0;
    memcpy(fix, known->aligned, sizeof known->aligned);
    if (aged > 0.5 * elapsed)              /* it has been taken in already */
        fix[0] = fix[1] = (double)NAN;
    return 1;
}

/* Align one body's fix in place; NaN where it is too old or none, or has been reported before and is older now. deviation: of the
 * fix, as reported, m. */
static inline void align_fix(struct position_alignment *positions, int body, const struct sample_interval *interval, double age,
                             double deviation, double *fix)
{
    const struct drawbar_pose *last = body_pose(interval->last, body);
    const struct drawbar_pose *now = body_pose(interval->expected, body);
    const struct drawbar_pose then = pose_at_age(interval, age, last, now);
    const struct mast *mast = &positions->masts[body];
    struct reported_fix *known = &positions->fixes[body];
    const double reported[] = {fix[0], fix[1]};
    const int has_mast = !mast_is_none(mast);
    struct attitude attitude = {0.0, 0.0};
    double arm[2] = {0.0, 0.0};

    if (has_mast)                          /* also of a sample without a fix: its weights continue */
        attitude = attitude_then(positions, body, interval, age, &then);
    if (isnan(age)) {
        fix[0] = fix[1] = (double)NAN;
        return;
    }
    if (repeats_fix(known, age, interval->elapsed, fix))
        return;
    if (has_mast) {
        lever_arm(mast, then.yaw, attitude.roll, attitude.pitch, arm);
        fix[0] -= arm[0];
        fix[1] -= arm[1];
    }
    if (age > 0.0) {
        fix[0] += now->x - then.x;
        fix[1] += now->y - then.y;
    }
    if (has_mast) {
        const double antenna[] = {fix[0] + arm[0], fix[1] + arm[1]};
        watch_swing(positions, body, interval, age, deviation, antenna);
    }
    memcpy(known->reported, reported, sizeof reported);
    memcpy(known->aligned, fix, sizeof known->aligned);
    known->known = isfinite(fix[0] + fix[1]);
}

#endif

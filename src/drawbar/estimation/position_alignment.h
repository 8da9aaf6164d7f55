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
    int32_t known;
};

struct position_alignment {
    struct mast masts[ALIGNED];
    double to_axle;                        /* from the trailer's tracked point back to its axle, m */
    double fix_deviation;                  /* of fixes whose receiver does not tell, m */
    struct attitude_track tracks[ALIGNED];
    double local[ALIGNED];                 /* share of what was recorded nearby, see ground_slope */
    struct ground_record ground;
    struct reported_fix fixes[ALIGNED];
    struct lean_watch leans;               /* what the roll sensors are worth */
};

#define POSITION_ALIGNMENT_FIELDS(type, place)                                                               \
    MAST_FIELDS(type, place.masts[ALIGNED_TRACTOR]) MAST_FIELDS(type, place.masts[ALIGNED_TRAILER])          \
    SETTING(type, place.to_axle, 0, 1, 0, 0) SETTING(type, place.fix_deviation, 0, 1, 0, 0)                  \
    SETTING(type, place.ground.spacing, 0, 1, 0, 0) FIELD(type, place.leans.doubts, 1, LEANING, 0, 0)        \
    FIELD(type, place.leans.bank.states, 0, SIGNS, LEANS, 0)                                                 \
    FIELD(type, place.leans.bank.covariance, 0, LEANS, LEANS, 0)

/* What the roll sensor of a body shows while it stands level, beyond the stated offset, as far as it is found. */
static inline struct roll_zero roll_zero(const struct position_alignment *positions, int body)
{
    return lean_bank_zero(&positions->leans.bank, body, positions->masts[body].roll_deviation);
}

/* Take in roll and pitch of a body's sensor, and put in their place what they are without its offsets and what is found of
 * the roll's beyond, NaN where they are too old to show how the body stands now. */
static inline void take_attitude(struct position_alignment *positions, int body, const struct since *since, double age,
                                 double *told_roll, double *told_pitch)
{
    const struct mast *mast = &positions->masts[body];
    const double roll = *told_roll - mast->roll_offset, pitch = *told_pitch - mast->pitch_offset;
    const double last = body == ALIGNED_TRACTOR ? since->last->tractor.yaw : since->last->trailer.yaw;
    const double now = body == ALIGNED_TRACTOR ? since->expected->tractor.yaw : since->expected->trailer.yaw;

    const double zero = roll_zero_shown(roll_zero(positions, body));
    if (attitude_take(&positions->tracks[body], since->now, age, roll - zero, pitch))
        lean_watch_attitude(&positions->leans, body, at_age(since, age, last, now), roll, pitch, since->elapsed);
    const struct attitude_track *track = &positions->tracks[body];
    const int stands = attitude_is_new(track, since->now);
    *told_roll = stands ? track->roll[track->count - 1] : (double)NAN;
    *told_pitch = stands ? track->pitch[track->count - 1] : (double)NAN;
}

/* Record the ground below the tractor, or else below the trailer, as its newest attitude shows it. */
static inline void record_ground(struct position_alignment *positions, const struct since *since)
{
    const int body = attitude_is_new(&positions->tracks[ALIGNED_TRACTOR], since->now) ? ALIGNED_TRACTOR : ALIGNED_TRAILER;
    const struct attitude_track *track = &positions->tracks[body];
    const struct drawbar_pose *last = body == ALIGNED_TRACTOR ? &since->last->tractor : &since->last->trailer;
    const struct drawbar_pose *now = body == ALIGNED_TRACTOR ? &since->expected->tractor : &since->expected->trailer;
    double slope[2];

    if (!attitude_is_new(track, since->now))
        return;
    const double age = since->now - track->time[track->count - 1], yaw = at_age(since, age, last->yaw, now->yaw);
    const double back = body == ALIGNED_TRAILER ? positions->to_axle : 0.0;
    slope_below(yaw, track->roll[track->count - 1], track->pitch[track->count - 1], slope);
    ground_take(&positions->ground, at_age(since, age, last->x, now->x) - back * cos(yaw),
                at_age(since, age, last->y, now->y) - back * sin(yaw), slope);
}

/* How far left a way (m) leads, for one who faces so. */
static inline double to_left(double yaw, const double *way)
{
    return way[1] * cos(yaw) - way[0] * sin(yaw);
}

/* Let the swing of a body's antenna know where its ground point is expected. */
static inline void move_swing(struct mast_swing *swing, const struct since *since, const struct drawbar_pose *last,
                              const struct drawbar_pose *now)
{
    const double corrected[] = {last->x - swing->expected[0], last->y - swing->expected[1]};
    const double expected[] = {now->x, now->y}, left = to_left(last->yaw, corrected);

    if (swing->begun && isfinite(left))
        swing_move(swing, expected, left, moved_since(since));
    else
        swing_begin(swing, expected);
}

/* How a body leaned at an age (s): by its own sensor, and by the ground that was recorded as far as that is not there. */
static inline void lean(struct position_alignment *positions, int body, const struct since *since, double age,
                        const struct drawbar_pose *pose, double *roll, double *pitch)
{
    struct attitude_track *track = &positions->tracks[body];
    const double own = attitude_trust(track, since->now);
    const double back = body == ALIGNED_TRAILER ? positions->to_axle : 0.0;
    const int follows = body == ALIGNED_TRAILER && attitude_is_new(&positions->tracks[ALIGNED_TRACTOR], since->now);
    double slope[2], recorded[2];

    attitude_at(track, since->now - age, roll, pitch);
    ground_slope(&positions->ground, pose->x - back * cos(pose->yaw), pose->y - back * sin(pose->yaw), follows,
                 since->elapsed, &positions->local[body], slope);
    lean_on(slope, pose->yaw, &recorded[0], &recorded[1]);
    *roll = recorded[0] + own * (*roll - recorded[0]);
    *pitch = recorded[1] + own * (*pitch - recorded[1]);
}

/* Let the antenna's swing be held against its body's own roll. deviation: of the fix, as it is told, m; fix: on the ground,
 * m; arm: that has been taken off, m. */
static inline void watch_swing(struct position_alignment *positions, int body, const struct since *since, double age,
                               double deviation, const double *fix, const double *arm)
{
    const struct drawbar_pose *now = body == ALIGNED_TRACTOR ? &since->expected->tractor : &since->expected->trailer;
    const struct mast *mast = &positions->masts[body];
    const struct attitude_track *track = &positions->tracks[body];
    const double antenna[] = {fix[0] + arm[0] - now->x, fix[1] + arm[1] - now->y};
    const double noise = isnan(deviation) ? positions->fix_deviation : deviation;
    double roll, pitch;

    if (!attitude_is_new(track, since->now))
        return;
    attitude_at(track, since->now - age, &roll, &pitch);
    swing_take(&positions->leans.swings[body], to_left(now->yaw, antenna) - mast->left * cos(roll), -mast->up * sin(roll),
               noise, !lean_is_still(&positions->leans.still[body]), since->elapsed);
}

/* Align one body's fix in place; NaN where it is too old or none. deviation: of the fix, as it is told, m. */
static inline void align_fix(struct position_alignment *positions, int body, const struct since *since, double age,
                             double deviation, double *fix)
{
    const struct drawbar_pose *last = body == ALIGNED_TRACTOR ? &since->last->tractor : &since->last->trailer;
    const struct drawbar_pose *now = body == ALIGNED_TRACTOR ? &since->expected->tractor : &since->expected->trailer;
    const struct mast *mast = &positions->masts[body];
    struct reported_fix *known = &positions->fixes[body];
    const double reported[] = {fix[0], fix[1]};
    double roll = 0.0, pitch = 0.0, arm[2] = {0.0, 0.0};   /* no mast: no arm */

    const struct drawbar_pose then = {at_age(since, age, last->x, now->x), at_age(since, age, last->y, now->y),
                                      at_age(since, age, last->yaw, now->yaw)};
    if (!mast_is_none(mast))
        lean(positions, body, since, age, &then, &roll, &pitch);
    if (isnan(age)) {
        fix[0] = fix[1] = (double)NAN;
        return;
    }
    if (known->known && reported[0] == known->reported[0] && reported[1] == known->reported[1]) {
        memcpy(fix, known->aligned, sizeof known->aligned);
        return;
    }
    if (!mast_is_none(mast)) {
        lever_arm(mast, then.yaw, roll, pitch, arm);
        fix[0] -= arm[0];
        fix[1] -= arm[1];
    }
    if (age > 0.0) {
        fix[0] += now->x - then.x;
        fix[1] += now->y - then.y;
    }
    if (!mast_is_none(mast))
        watch_swing(positions, body, since, age, deviation, fix, arm);
    memcpy(known->reported, reported, sizeof reported);
    memcpy(known->aligned, fix, sizeof known->aligned);
    known->known = isfinite(fix[0] + fix[1]);
}

#endif

/* Alignment: from what the sensors reported to what they would report of the points on the ground, now.
 *
 * Each position goes from its antenna to the ground with the yaw and the attitude of its own time, and from there as far as
 * the body has moved since; the other sensors' values by what they have changed since, the tractor's yaw and yaw rate without
 * their sensors' errors. Between two samples everything is taken to move evenly, as the estimator predicts it. A fix that its
 * receiver repeats is corrected as before, so that it stays recognisable as a repetition.
 */
#ifndef DRAWBAR_ALIGNMENT_H
#define DRAWBAR_ALIGNMENT_H

#include "ages.h"
#include "attitude_track.h"
#include "fix_deviation.h"
#include "ground_record.h"
#include "lean_watch.h"
#include "lever_arm.h"
#include "rate_history.h"
#include "unit.h"
#include "yaw_rate.h"
#include "yaw_rate_sensor.h"
#include "yaw_sensor.h"
#include "yaws_at_rest.h"

#define OLDEST 1.0                         /* what is older is missing, s */
#define SHOWS_YAW 0.1                      /* deviation beyond which fixes show no yaw, m */

enum { ALIGNED_TRACTOR, ALIGNED_TRAILER, ALIGNED };

struct reported_fix {
    double reported[2], aligned[2];        /* m */
    int32_t known;
};

struct component {
    struct mast masts[ALIGNED];
    struct fix_deviations deviations;
    struct chain chain;
    double to_axle;                        /* from the trailer's tracked point back to its axle, m */
    double fix_age;                        /* of positions whose receiver does not tell, s */
    double fix_deviation;                  /* of fixes whose receiver does not tell, m */
    struct attitude_track tracks[ALIGNED];
    double local[ALIGNED];                 /* share of what was recorded nearby, see ground_slope */
    struct ground_record ground;
    struct reported_fix fixes[ALIGNED];
    struct coarse_noise noises[ALIGNED];
    struct lean_watch leans;               /* what the roll sensors are worth */
    struct yaw_sensor yaw;                 /* the tractor's */
    struct yaw_rate_sensor yaw_rate;       /* the tractor's */
    struct rate_history rates;             /* the tractor's, by the wheels */
};

#define COMPONENT_FIELDS                                                                                          \
    MAST_FIELDS(component, masts[ALIGNED_TRACTOR]) MAST_FIELDS(component, masts[ALIGNED_TRAILER])                      \
    FIX_DEVIATIONS_FIELDS(component, deviations) CHAIN_FIELDS(component, chain)                                        \
    SETTING(component, to_axle, 0, 1, 0, 0) SETTING(component, fix_age, 0, 1, 0, 0)                                    \
    SETTING(component, fix_deviation, 0, 1, 0, 0)                                                                      \
    SETTING(component, ground.spacing, 0, 1, 0, 0) SETTING(component, yaw.gate, 0, 1, 0, 0)                            \
    FIELD(component, leans.doubts, 1, LEANING, 0, 0)                                                                   \
    FIELD(component, yaw.error, 0, 1, 0, 0) FIELD(component, yaw_rate.doubted, 0, 1, 0, 0)                             \
    FIELD(component, leans.bank.states, 0, SIGNS, LEANS, 0) FIELD(component, leans.bank.covariance, 0, LEANS, LEANS, 0)

/* One sample of alignment: what was estimated last, and what is expected now. */
struct since {
    const struct drawbar_estimate *last, *expected;
    time_stamp now;
    double elapsed;                        /* s */
};

/* Where something that is `then` (0) and `now` (1) was at an age (s). */
static inline double at_age(const struct since *since, double age, double then, double now)
{
    return age > 0.0 && since->elapsed > 0.0 ? now - age / since->elapsed * (now - then) : now;
}

/* How far the vehicle has moved, m. */
static inline double moved_since(const struct since *since)
{
    const double moved = fabs(since->expected->speed) * since->elapsed;
    return isfinite(moved) ? moved : 0.0;
}

/* How old a fix is, s, with the latency that was found; NaN: too old, or of the future. */
static inline double age_of_fix(const struct component *alignment, double told)
{
    const double age = (told == 0.0 || isnan(told) ? alignment->fix_age : told) + fmax(alignment->yaw_rate.latency, 0.0);
    return age >= 0.0 && age <= OLDEST ? age : (double)NAN;
}

/* What the roll sensor of a body shows while it stands level, beyond the stated offset, as far as it is found. */
static inline struct roll_zero roll_zero(const struct component *alignment, int body)
{
    return lean_bank_zero(&alignment->leans.bank, body, alignment->masts[body].roll_deviation);
}

/* Take in roll and pitch of a body's sensor, and put in their place what they are without its offsets and what is found of
 * the roll's beyond, NaN where they are too old to show how the body stands now. */
static inline void take_attitude(struct component *alignment, int body, const struct since *since, double age,
                                 double *told_roll, double *told_pitch)
{
    const struct mast *mast = &alignment->masts[body];
    const double roll = *told_roll - mast->roll_offset, pitch = *told_pitch - mast->pitch_offset;
    const double last = body == ALIGNED_TRACTOR ? since->last->tractor.yaw : since->last->trailer.yaw;
    const double now = body == ALIGNED_TRACTOR ? since->expected->tractor.yaw : since->expected->trailer.yaw;

    const double zero = roll_zero_shown(roll_zero(alignment, body));
    if (attitude_take(&alignment->tracks[body], since->now, age, roll - zero, pitch))
        lean_watch_attitude(&alignment->leans, body, at_age(since, age, last, now), roll, pitch, since->elapsed);
    const struct attitude_track *track = &alignment->tracks[body];
    const int stands = attitude_is_new(track, since->now);
    *told_roll = stands ? track->roll[track->count - 1] : (double)NAN;
    *told_pitch = stands ? track->pitch[track->count - 1] : (double)NAN;
}

/* Record the ground below the tractor, or else below the trailer, as its newest attitude shows it. */
static inline void record_ground(struct component *alignment, const struct since *since)
{
    const int body = attitude_is_new(&alignment->tracks[ALIGNED_TRACTOR], since->now) ? ALIGNED_TRACTOR : ALIGNED_TRAILER;
    const struct attitude_track *track = &alignment->tracks[body];
    const struct drawbar_pose *last = body == ALIGNED_TRACTOR ? &since->last->tractor : &since->last->trailer;
    const struct drawbar_pose *now = body == ALIGNED_TRACTOR ? &since->expected->tractor : &since->expected->trailer;
    double slope[2];

    if (!attitude_is_new(track, since->now))
        return;
    const double age = since->now - track->time[track->count - 1], yaw = at_age(since, age, last->yaw, now->yaw);
    const double back = body == ALIGNED_TRAILER ? alignment->to_axle : 0.0;
    slope_below(yaw, track->roll[track->count - 1], track->pitch[track->count - 1], slope);
    ground_take(&alignment->ground, at_age(since, age, last->x, now->x) - back * cos(yaw),
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
static inline void lean(struct component *alignment, int body, const struct since *since, double age,
                        const struct drawbar_pose *pose, double *roll, double *pitch)
{
    struct attitude_track *track = &alignment->tracks[body];
    const double own = attitude_trust(track, since->now);
    const double back = body == ALIGNED_TRAILER ? alignment->to_axle : 0.0;
    const int follows = body == ALIGNED_TRAILER && attitude_is_new(&alignment->tracks[ALIGNED_TRACTOR], since->now);
    double slope[2], recorded[2];

    attitude_at(track, since->now - age, roll, pitch);
    ground_slope(&alignment->ground, pose->x - back * cos(pose->yaw), pose->y - back * sin(pose->yaw), follows,
                 since->elapsed, &alignment->local[body], slope);
    lean_on(slope, pose->yaw, &recorded[0], &recorded[1]);
    *roll = recorded[0] + own * (*roll - recorded[0]);
    *pitch = recorded[1] + own * (*pitch - recorded[1]);
}

/* Let the antenna's swing be held against its body's own roll. deviation: of the fix, as it is told, m; fix: on the ground,
 * m; arm: that has been taken off, m. */
static inline void watch_swing(struct component *alignment, int body, const struct since *since, double age,
                               double deviation, const double *fix, const double *arm)
{
    const struct drawbar_pose *now = body == ALIGNED_TRACTOR ? &since->expected->tractor : &since->expected->trailer;
    const struct mast *mast = &alignment->masts[body];
    const struct attitude_track *track = &alignment->tracks[body];
    const double antenna[] = {fix[0] + arm[0] - now->x, fix[1] + arm[1] - now->y};
    const double noise = isnan(deviation) ? alignment->fix_deviation : deviation;
    double roll, pitch;

    if (!attitude_is_new(track, since->now))
        return;
    attitude_at(track, since->now - age, &roll, &pitch);
    swing_take(&alignment->leans.swings[body], to_left(now->yaw, antenna) - mast->left * cos(roll), -mast->up * sin(roll),
               noise, !lean_is_still(&alignment->leans.still[body]), since->elapsed);
}

/* Align one body's fix in place; NaN where it is too old or none. deviation: of the fix, as it is told, m. */
static inline void align_fix(struct component *alignment, int body, const struct since *since, double age,
                             double deviation, double *fix)
{
    const struct drawbar_pose *last = body == ALIGNED_TRACTOR ? &since->last->tractor : &since->last->trailer;
    const struct drawbar_pose *now = body == ALIGNED_TRACTOR ? &since->expected->tractor : &since->expected->trailer;
    const struct mast *mast = &alignment->masts[body];
    struct reported_fix *known = &alignment->fixes[body];
    const double reported[] = {fix[0], fix[1]};
    double roll = 0.0, pitch = 0.0, arm[2] = {0.0, 0.0};   /* no mast: no arm */

    const struct drawbar_pose then = {at_age(since, age, last->x, now->x), at_age(since, age, last->y, now->y),
                                      at_age(since, age, last->yaw, now->yaw)};
    if (!mast_is_none(mast))
        lean(alignment, body, since, age, &then, &roll, &pitch);
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
        watch_swing(alignment, body, since, age, deviation, fix, arm);
    memcpy(known->reported, reported, sizeof reported);
    memcpy(known->aligned, fix, sizeof known->aligned);
    known->known = isfinite(fix[0] + fix[1]);
}

/* What a sensor would report now that reported `value` at an age (s): as its quantity changes from last to expected. */
static inline double brought_up(const struct since *since, double value, double age, double last, double expected)
{
    if (age == 0.0 || isnan(age))
        return value;
    return age > 0.0 && age <= OLDEST ? value + expected - at_age(since, age, last, expected) : (double)NAN;
}

/* Bring the values of all sensors but the receivers up to now, in place. */
static inline void align_angles(const struct since *since, struct drawbar_measurement *m)
{
    const struct drawbar_estimate *last = since->last, *now = since->expected;

    m->hitch_angle = brought_up(since, m->hitch_angle, m->hitch_angle_age, last->hitch_angle, now->hitch_angle);
    m->speed = brought_up(since, m->speed, m->speed_age, last->speed, now->speed);
    m->tractor_steering = brought_up(since, m->tractor_steering, m->tractor_steering_age, last->tractor_steering,
                                     now->tractor_steering);
    m->trailer_steering = brought_up(since, m->trailer_steering, m->trailer_steering_age, last->trailer_steering,
                                     now->trailer_steering);
}

/* The tractor's yaw rate by an estimate, rad/s. */
static inline double wheels_yaw_rate(const struct component *alignment, const struct drawbar_estimate *estimate)
{
    return tractor_yaw_rate(estimate, estimate->longitudinal_slip * estimate->speed, alignment->chain.wheelbase);
}

/* The tractor's yaw as fixes and angles show it, rad; NaN where one of them is missing or coarse. */
static inline double yaw_of_fixes(const struct component *alignment, const struct drawbar_measurement *m)
{
    const int coarse = fmax(m->tractor_fix_deviation, m->trailer_fix_deviation) > SHOWS_YAW;
    double tractor, trailer;

    if (coarse || !isfinite(m->hitch_angle + m->trailer_steering)
        || !yaws_at_rest(&alignment->chain, m, &tractor, &trailer))
        return (double)NAN;
    return tractor;
}

/* Direction of the line from the trailer's point to the tractor's, rad. */
static inline double line_direction(const struct drawbar_estimate *estimate)
{
    const struct drawbar_pose *tractor = &estimate->tractor, *trailer = &estimate->trailer;
    return atan2(tractor->y - trailer->y, tractor->x - trailer->x);
}

/* Bring the tractor's yaw up to now, without its mounting's error, in place; NaN where it is not to be believed. */
static inline void align_yaw(struct component *alignment, const struct since *since, struct drawbar_measurement *m)
{
    const double last = since->last->tractor.yaw, now = since->expected->tractor.yaw;
    const double told = brought_up(since, m->tractor_yaw, m->tractor_attitude_age, last, now);

    m->tractor_yaw = yaw_believed(&alignment->yaw, told, now, yaw_of_fixes(alignment, m));
}

/* Bring the tractor's yaw rate up to now, without the sensor's bias, in place; NaN where it is not to be believed. */
static inline void align_yaw_rate(struct component *alignment, const struct since *since, struct drawbar_measurement *m)
{
    const double now = wheels_yaw_rate(alignment, since->expected);
    const double age = m->tractor_attitude_age - fmin(alignment->yaw_rate.latency, 0.0);

    rate_history_take(&alignment->rates, wheels_yaw_rate(alignment, since->last));
    const double told = age > OLDEST
        ? (double)NAN : rate_history_brought_up(&alignment->rates, m->tractor_yaw_rate, age, since->elapsed, now);
    const double turned = wrapped(line_direction(since->expected) - line_direction(since->last));
    const struct shown_yaw shown = {yaw_of_fixes(alignment, m), since->elapsed > 0.0 ? turned / since->elapsed : 0.0};

    m->tractor_yaw_rate = yaw_rate_believed(&alignment->yaw_rate, told, now, &shown, since->elapsed);
}

/* Let each fix, already on the ground, have the deviation that it is to be reckoned with; take away what is none. */
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

/* The measurement that a run begins with: of a vehicle at rest, so that only the masts matter. Its yaws follow from where
 * both antennas are. A trailer without a position is where the tractor's yaw and the angles put it. */
int UNIT(begin)(struct component *alignment, const struct drawbar_measurement *first,
                struct drawbar_measurement *aligned)
{
    const double told[] = {first->tractor_roll, first->tractor_pitch, first->trailer_roll, first->trailer_pitch};
    double arms[4], yaws[ALIGNED], lean[4];

    static const struct drawbar_estimate nowhere = {.tractor = {(double)NAN, (double)NAN, (double)NAN}};

    *aligned = *first;
    judge_deviations(alignment, &nowhere, aligned);
    const struct drawbar_measurement reported = *aligned;
    for (int i = 0; i < 4; ++i) {
        const struct mast *mast = &alignment->masts[i / 2];
        const double angle = told[i] - (i % 2 ? mast->pitch_offset : mast->roll_offset);
        lean[i] = fabs(angle) <= MOST_LEAN ? angle : 0.0;
    }
    if (!isfinite(reported.trailer_x + reported.trailer_y) && isfinite(reported.tractor_yaw)) {
        lever_arm(&alignment->masts[ALIGNED_TRACTOR], reported.tractor_yaw, lean[0], lean[1], arms);
        aligned->tractor_x = reported.tractor_x - arms[0];
        aligned->tractor_y = reported.tractor_y - arms[1];
        complete_trailer(&alignment->chain, aligned);
        return 0;
    }
    const struct mast *tractor = &alignment->masts[ALIGNED_TRACTOR], *trailer = &alignment->masts[ALIGNED_TRAILER];
    lever_arm(tractor, gamma_at_rest(&reported), lean[0], lean[1], arms);
    lever_arm(trailer, 0.0, lean[2], lean[3], arms + 2);
    const double beyond[] = {arms[0] - arms[2], arms[1] - arms[3]};
    if (!yaws_apart(&alignment->chain, &reported, beyond, &yaws[ALIGNED_TRACTOR], &yaws[ALIGNED_TRAILER]))
        return 0;
    lever_arm(tractor, yaws[ALIGNED_TRACTOR], lean[0], lean[1], arms);
    lever_arm(trailer, yaws[ALIGNED_TRAILER], lean[2], lean[3], arms + 2);
    aligned->tractor_x = reported.tractor_x - arms[0];
    aligned->tractor_y = reported.tractor_y - arms[1];
    aligned->trailer_x = reported.trailer_x - arms[2];
    aligned->trailer_y = reported.trailer_y - arms[3];
    return 0;
}

/* What is found of the sensors: by how much fixes are later than was told, and how the roll sensors are mounted. */
void UNIT(tell)(const struct component *alignment, struct drawbar_actuation *found)
{
    const struct roll_zero tractor = roll_zero(alignment, ALIGNED_TRACTOR), trailer = roll_zero(alignment, ALIGNED_TRAILER);

    found->fix_latency = fmax(alignment->yaw_rate.latency, 0.0);
    found->tractor_roll_offset = tractor.value;
    found->tractor_roll_deviation = tractor.deviation;
    found->trailer_roll_offset = trailer.value;
    found->trailer_roll_deviation = trailer.deviation;
}

/* Align a measurement; returns 0 or the status with which the run ends. last: the newest estimate; expected: the one that
 * is expected at the measurement's time, before it is taken in. */
int UNIT(apply)(struct component *alignment, const struct drawbar_measurement *measurement,
                const struct drawbar_estimate *last, const struct drawbar_estimate *expected,
                struct drawbar_measurement *aligned)
{
    const struct since since = {last, expected, measurement->time, measurement->time - last->time};

    *aligned = *measurement;
    ages_of_now(aligned);
    lean_watch_move(&alignment->leans, moved_since(&since));
    move_swing(&alignment->leans.swings[ALIGNED_TRACTOR], &since, &last->tractor, &expected->tractor);
    move_swing(&alignment->leans.swings[ALIGNED_TRAILER], &since, &last->trailer, &expected->trailer);
    take_attitude(alignment, ALIGNED_TRACTOR, &since, aligned->tractor_attitude_age, &aligned->tractor_roll,
                  &aligned->tractor_pitch);
    take_attitude(alignment, ALIGNED_TRAILER, &since, aligned->trailer_attitude_age, &aligned->trailer_roll,
                  &aligned->trailer_pitch);
    record_ground(alignment, &since);
    double tractor[] = {aligned->tractor_x, aligned->tractor_y}, trailer[] = {aligned->trailer_x, aligned->trailer_y};
    align_fix(alignment, ALIGNED_TRACTOR, &since, age_of_fix(alignment, aligned->tractor_fix_age),
              aligned->tractor_fix_deviation, tractor);
    align_fix(alignment, ALIGNED_TRAILER, &since, age_of_fix(alignment, aligned->trailer_fix_age),
              aligned->trailer_fix_deviation, trailer);
    aligned->tractor_x = tractor[0];
    aligned->tractor_y = tractor[1];
    aligned->trailer_x = trailer[0];
    aligned->trailer_y = trailer[1];
    judge_deviations(alignment, expected, aligned);
    align_angles(&since, aligned);
    align_yaw(alignment, &since, aligned);
    align_yaw_rate(alignment, &since, aligned);
    const int present[] = {attitude_is_new(&alignment->tracks[ALIGNED_TRACTOR], since.now),
                           attitude_is_new(&alignment->tracks[ALIGNED_TRAILER], since.now)};
    return lean_watch_look(&alignment->leans, present, since.elapsed);
}

#endif

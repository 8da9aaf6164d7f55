/* Yaw alignment: the tractor's yaw and yaw rate at the time of the sample, without their sensors' errors. */
#ifndef DRAWBAR_YAW_ALIGNMENT_H
#define DRAWBAR_YAW_ALIGNMENT_H

#include "between_samples.h"
#include "rate_history.h"
#include "yaw_rate.h"
#include "yaw_rate_sensor.h"
#include "yaw_sensor.h"
#include "yaw_residual.h"
#include "yaws_at_rest.h"

#define COARSE_REFERENCE 0.1               /* standard deviation of fixes beyond which there is no reference, m */

/* The tractor's yaw rate by an estimate, rad/s. */
static inline double wheels_yaw_rate(const struct chain *chain, const struct drawbar_estimate *estimate)
{
    return tractor_yaw_rate(estimate, estimate->longitudinal_slip * estimate->speed, chain->wheelbase);
}

/* Whether a fix is too coarse for a reference. */
static inline int fixes_are_coarse(const struct drawbar_measurement *m)
{
    return fmax(m->tractor_fix_deviation, m->trailer_fix_deviation) > COARSE_REFERENCE;
}

/* The tractor's yaw by fixes and angles, rad; NaN where one of them is missing or coarse. */
static inline double yaw_of_fixes(const struct chain *chain, const struct drawbar_measurement *m)
{
    double tractor, trailer;

    if (fixes_are_coarse(m) || !isfinite(m->hitch_angle + m->trailer_steering)
        || !yaws_at_rest(chain, m, &tractor, &trailer))
        return (double)NAN;
    return tractor;
}

/* Direction of the line from the trailer's point to the tractor's, rad. */
static inline double line_direction(const struct drawbar_estimate *estimate)
{
    const struct drawbar_pose *tractor = &estimate->tractor, *trailer = &estimate->trailer;
    return atan2(tractor->y - trailer->y, tractor->x - trailer->x);
}

/* Bring the tractor's yaw up to now, without its sensor's errors, in place; NaN where it is rejected. fix_latency: that fixes
 * are corrected for, s. */
static inline void align_yaw(struct yaw_sensor *sensor, const struct chain *chain, const struct sample_interval *interval,
                             double fix_latency, struct drawbar_measurement *m)
{
    const double last = interval->last->tractor.yaw, now = interval->expected->tractor.yaw;
    const double measured = brought_up(interval, m->tractor_yaw, m->tractor_attitude_age, last, now);

    const double rate = interval->predicted > 0.0 ? (now - last) / interval->predicted : 0.0;
    const struct yaw_known known = {now, rate, yaw_of_fixes(chain, m), fix_latency};

    m->tractor_yaw = yaw_judged(sensor, measured, &known, interval->elapsed);
}

/* Bring the tractor's yaw rate up to now, without the sensor's errors, in place; NaN where it is excluded. The departure of the
 * fixes' yaw from it shows even then. */
static inline void align_yaw_rate(struct yaw_rate_sensor *sensor, struct rate_history *rates, struct yaw_residual *residual,
                                  const struct chain *chain, const struct sample_interval *interval, struct drawbar_measurement *m)
{
    const double now = wheels_yaw_rate(chain, interval->expected);
    const double age = m->tractor_attitude_age - fmin(sensor->latency, 0.0);

    if (!yaw_rate_begun(sensor))
        rate_history_begin(rates, now);
    const double measured = age > OLDEST
        ? (double)NAN : rate_history_brought_up(rates, m->tractor_yaw_rate, age, interval->predicted, now);
    rate_history_record(rates, now);
    const double turned = wrapped(line_direction(interval->expected) - line_direction(interval->last));
    const struct yaw_reference reference = {yaw_of_fixes(chain, m), interval->predicted > 0.0 ? turned / interval->predicted : 0.0};

    yaw_residual_update(residual, reference.yaw, yaw_rate_corrected(sensor, measured), interval->elapsed);
    m->tractor_yaw_rate = yaw_rate_judged(sensor, measured, now, &reference, interval->elapsed);
}

#endif

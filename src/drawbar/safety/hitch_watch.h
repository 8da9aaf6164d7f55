/* Hitch watch: whether the measured angles of hitch and joint contradict the motion of both bodies.
 *
 * The estimate absorbs most of a wrong hitch angle in yaws and side-slips, and both bodies are steered beside the line. A
 * residual of a few degrees remains in both angles, beyond its root mean square on this ground. A stuck sensor is detected
 * earlier: it repeats one angle while the estimate turns. One that drifts leaves no residual: it is followed by side-slips
 * that become more and more different, where the ground moves both bodies alike.
 */
#ifndef DRAWBAR_HITCH_WATCH_H
#define DRAWBAR_HITCH_WATCH_H

#include <math.h>
#include "frozen_signal.h"
#include "geometry.h"
#include "signals.h"
#include "status.h"

#define HITCH_MEAN 0.5                     /* time constant of the mean residuals, s */
#define HITCH_FACTOR 7.0                   /* root mean squares beyond which a mean residual is a contradiction */
#define HITCH_PRIOR 0.0105                 /* prior root mean square, rad, */
#define HITCH_PRIOR_TIME 5.0               /* and its weight, s */
#define HITCH_BASELINE 30.0                /* time constant of the mean square, s */
#define HITCH_CLIP 3.0                     /* limits at which a residual is clipped */
#define HITCH_BASELINE_CLIP 2.0            /* root mean squares at which a mean residual is clipped: no fault may raise them */
#define HITCH_SPEED 0.1                    /* below which the mean square is not updated, m/s */
#define HITCH_SIDE_SLIP (4.5 * DRAWBAR_PI / 180.0) /* difference of the bodies' side-slips that is a contradiction, rad, */
#define HITCH_SETTLED 15.0                 /* once the mean square covers this time, with its prior, s */
#define HITCH_CONFIRMED (2.6 * DRAWBAR_PI / 180.0) /* departure of the fixes' yaw from the yaw rate below which the angles are
                                              confirmed: the wheels slip instead, rad */
#define HITCH_CONFIRMED_SHARE (1.0 / 3.0)  /* and for how much a contradiction then counts */
#define HITCH_TURNED 0.5                   /* share of `most` that the estimate turns while a stuck sensor does not, */
#define HITCH_SHIFTED (1.0 * DRAWBAR_PI / 180.0)   /* and an angle, for a sensor of fine resolution, rad, */
#define HITCH_OF_PATIENCE 0.5              /* largest share of the patience that one sample counts for */
#define HITCH_REPETITION_GAIN 1.5          /* largest factor by which repetitions reduce that angle */

struct hitch_watch {
    /* settings, described in safety/sanity.py */
    double least, most, patience;
    /* state */
    double means[2];                       /* of the residuals: measured minus estimated angles of hitch and joint, rad */
    double baseline, baseline_time; /* mean square of their norm, rad2; time that it covers, s */
    struct frozen_signal frozen;           /* reported and estimated hitch angle, rad */
    double contradicted_time, stuck_time;  /* for how long, s */
    int32_t initialised;
};

#define HITCH_WATCH_FIELDS(type, place)                                                                      \
    SETTING(type, place.least, 0, 1, 0, 0) SETTING(type, place.most, 0, 1, 0, 0)                             \
    SETTING(type, place.patience, 0, 1, 0, 0) FIELD(type, place.stuck_time, 0, 1, 0, 0)

/* The residual of an angle, clipped so that no single one exceeds the mean's limit, rad; zero of a missing one. */
static inline double hitch_residual(double measured, double estimated, double limit)
{
    return isfinite(measured) ? clipped(wrapped(measured - estimated), HITCH_CLIP * limit) : 0.0;
}

/* Whether the mean residuals exceed their limit. */
static inline int hitch_is_contradicted(struct hitch_watch *watch, const struct drawbar_measurement *m,
                                    const struct drawbar_estimate *estimate, double elapsed)
{
    const int solved = estimate->status == SOLVED;
    const double baseline = sqrt(watch->baseline), limit = fmin(fmax(watch->least, HITCH_FACTOR * baseline), watch->most);
    const double differences[] = {
        solved ? hitch_residual(m->hitch_angle, estimate->hitch_angle, limit) : 0.0,
        solved ? hitch_residual(m->trailer_steering, estimate->trailer_steering, limit) : 0.0,
    };
    const double share = fmin(-expm1(-elapsed / HITCH_MEAN), 1.0 / HITCH_CLIP);

    for (int i = 0; i < 2; ++i)
        watch->means[i] += share * (differences[i] - watch->means[i]);
    const double mean = hypot(watch->means[0], watch->means[1]);
    if (fabs(m->speed) >= HITCH_SPEED && elapsed > 0.0) {
        const double clipped_mean = fmin(mean, HITCH_BASELINE_CLIP * baseline);
        watch->baseline_time = fmin(watch->baseline_time + elapsed, HITCH_BASELINE);
        watch->baseline += elapsed / watch->baseline_time * (clipped_mean * clipped_mean - watch->baseline);
    }
    const int apart = fabs(estimate->tractor_crab - estimate->trailer_crab) > HITCH_SIDE_SLIP;
    return mean > limit || (solved && apart && watch->baseline_time >= HITCH_SETTLED);
}

/* For how long the sensor has repeated one angle although the estimate has turned away from it, s; infinite at once where its
 * sequence of repetitions is not plausible. */
static inline double hitch_stuck(struct hitch_watch *watch, double reported, double estimated, double speed,
                                 double elapsed)
{
    const struct frozen_signal *frozen = &watch->frozen;
    const double difference = fabs(wrapped(estimated - reported)), least = HITCH_TURNED * watch->most;

    frozen_update(&watch->frozen, reported, estimated, speed);
    const double repetition = frozen_repetition(frozen);
    if (repetition >= 1.0 && frozen_excess(frozen, HITCH_SHIFTED, 0.0) > HITCH_SHIFTED / fmin(repetition, HITCH_REPETITION_GAIN))
        return (double)INFINITY;
    return frozen->most - frozen->least > least && difference > 0.5 * least ? watch->stuck_time + elapsed : 0.0;
}

/* Judge a step: 0, or the status with which the run ends. reported: by the sensor; m: brought up to now; departure: of the
 * fixes' yaw from the yaw rate, rad, NaN: unknown. */
static inline int hitch_judge(struct hitch_watch *watch, double reported, const struct drawbar_measurement *m,
                              const struct drawbar_estimate *estimate, double departure, double elapsed)
{
    if (!watch->initialised) {
        watch->baseline = HITCH_PRIOR * HITCH_PRIOR;
        watch->baseline_time = HITCH_PRIOR_TIME;
        watch->frozen.value = (double)NAN;
        watch->initialised = 1;
    }
    const int differs = hitch_is_contradicted(watch, m, estimate, elapsed);
    const double counts = fmin(elapsed, HITCH_OF_PATIENCE * watch->patience);
    if (!isfinite(reported) || estimate->status != SOLVED) {   /* nothing to compare */
        watch->contradicted_time = watch->stuck_time = 0.0;
        return 0;
    }
    const double share = departure < HITCH_CONFIRMED ? HITCH_CONFIRMED_SHARE : 1.0;
    watch->contradicted_time = differs ? watch->contradicted_time + share * counts : 0.0;
    watch->stuck_time = hitch_stuck(watch, reported, estimate->hitch_angle, m->speed, counts);
    return fmax(watch->contradicted_time, watch->stuck_time) > watch->patience ? DRAWBAR_HITCH : 0;
}

#endif

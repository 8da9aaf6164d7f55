/* Errors of the angles between both bodies, from the ways that both axles go: the latency of the hitch angle beyond its reported
 * age and beyond that of the fixes, and the scale errors of the sensors of hitch and joint.
 *
 * An axle goes where its body faces, so two pairs of fixes show the angle between tractor and trailer. Where the measured one
 * is wrong, the trailer seems to move across itself, by its way times the error. Summed up this distance grows with a constant
 * error of the angles, with each scale error times that angle, and with the latency times the change of the hitch angle; a Kalman
 * filter separates these (docs/theory/identification.md). However long the way, the sum is known as well as two positions are.
 */
#ifndef DRAWBAR_ANGLE_ERRORS_H
#define DRAWBAR_ANGLE_ERRORS_H

#include <math.h>
#include <stdint.h>
#include <string.h>
#include "geometry.h"
#include "kalman_update.h"
#include "noinline.h"

#define ACROSS_NOISE 0.05                  /* standard deviation of the distance by one pair of fixes, m */
#define ACROSS_GATE 0.3                    /* a distance that is not believed; twice in a row the sum begins anew, m */
#define ACROSS_SETTLING 150                /* number of distances whose mean square shows by how much masts sway */
#define ACROSS_USUAL 1.5                   /* mean square up to which they do not, in variances of the noise above */
#define ACROSS_WEIGHT 4.0                  /* variance per mean square beyond that: what sways does so for seconds */
#define ANGLE_NOISE 0.02                   /* standard deviation of one angle between both bodies, rad */
#define ANGLE_OFFSET_PRIOR 0.035           /* prior standard deviation of its constant error, rad */
#define ANGLE_OFFSET_WALK 0.005            /* its random walk, as on slopes, rad per square root of a second */
#define ANGLE_SCALE_PRIOR 0.1              /* prior standard deviation of each scale error */
#define ANGLE_SCALE_WALK 0.001             /* its random walk, per square root of a second */
#define ANGLE_SCALE_DRAWN 1.0              /* information by which it is drawn to zero, per second and squared speed, s/m^2 */
#define STEADY_ANGLES 0.03                 /* largest expected change of the angle between both bodies that counts as none, rad/s */
#define LEAST_ANGLE_SCALE 0.04             /* by which it is beyond two standard deviations where it is corrected */
#define MOST_ANGLE_SCALE 0.4               /* limit of its correction */
#define ANGLE_SCALE_RATE 0.05              /* rate of its correction, 1/s */
#define HITCH_LATENCY_PRIOR 0.1            /* prior standard deviation of the latency, s */
#define HITCH_LATENCY_WALK 0.002           /* its random walk, s per square root of a second */
#define MOST_HITCH_LATENCY 0.25            /* limit of its correction, s */
#define HITCH_LATENCY_RATE 0.1             /* rate of its correction, s/s */

enum { HITCH, JOINT, ANGLES };
enum { ACROSS, ANGLE_OFFSET, ANGLE_SCALE, HITCH_LATENCY = ANGLE_SCALE + ANGLES, ANGLE_STATES };

/* One sample. */
struct angle_sample {
    double points[4];                      /* x, y of the tractor's axle and of the trailer's point, m; NaN: unknown */
    double yaw;                            /* of the tractor, as expected, rad */
    double angles[ANGLES];                 /* whose sum is the tractor's yaw minus the trailer's, rad; NaN: unknown */
    double bent;                           /* expected change of the hitch angle since the last sample, rad */
    double swung;                          /* expected change of the joint since the last sample, rad */
    double creep;                          /* side-slip of axles per lateral acceleration, rad/g */
    int32_t sways;                         /* an antenna stands on a mast whose roll is not measured */
};

/* What the bodies have done since the last pair of fixes. */
struct angle_motion {
    double lasted;                         /* s */
    double yaw, angles[ANGLES];            /* integrals, rad s */
    double turned, closed, bent, swung;    /* changes of yaw, sum of both angles, and expected hitch and joint, rad */
};

struct angle_errors {
    double state[ANGLE_STATES];            /* distance across that is not explained, m; constant error, rad; scale errors:
                                              true per measured angle, less 1; latency, s */
    double covariance[ANGLE_STATES][ANGLE_STATES];
    double scales[ANGLES], latency;        /* corrected for; s */
    double spread;                         /* mean square of the distances beyond what is expected of them, m2 */
    double points[4];                      /* of the last pair of fixes, m */
    double yaw, angles[ANGLES];            /* of the last sample, rad */
    struct angle_motion motion;
    int32_t continues;                     /* there is a last pair, and the angles since are known */
    int32_t outside;                       /* number of distances beyond the gate in a row */
    int32_t spreads;                       /* number of distances in the mean square */
};

/* Forget everything but the scale errors, which positions that jump do not touch, and the corrected latency, which fades. */
static COLD void angle_errors_begin(struct angle_errors *errors)
{
    struct angle_errors anew = {.latency = errors->latency, .spread = errors->spread, .spreads = errors->spreads};

    for (int i = HITCH; i < ANGLES; ++i) {
        const double variance = errors->covariance[ANGLE_SCALE + i][ANGLE_SCALE + i];
        anew.covariance[ANGLE_SCALE + i][ANGLE_SCALE + i] = variance > 0.0 ? variance : ANGLE_SCALE_PRIOR * ANGLE_SCALE_PRIOR;
        anew.state[ANGLE_SCALE + i] = errors->state[ANGLE_SCALE + i];
        anew.scales[i] = errors->scales[i];
    }
    anew.covariance[ANGLE_OFFSET][ANGLE_OFFSET] = ANGLE_OFFSET_PRIOR * ANGLE_OFFSET_PRIOR;
    anew.covariance[HITCH_LATENCY][HITCH_LATENCY] = HITCH_LATENCY_PRIOR * HITCH_LATENCY_PRIOR;
    *errors = anew;
}

/* Begin the sum: nothing is across the first pair of fixes. */
static COLD void angle_errors_begin_sum(struct angle_errors *errors)
{
    for (int i = 0; i < ANGLE_STATES; ++i)
        errors->covariance[ACROSS][i] = errors->covariance[i][ACROSS] = 0.0;
    errors->covariance[ACROSS][ACROSS] = ACROSS_NOISE * ACROSS_NOISE;
    errors->state[ACROSS] = 0.0;
}

/* Propagate over a way (m) since the last pair of fixes. */
static COLD void angle_errors_propagate(struct angle_errors *errors, double way, double creep)
{
    const struct angle_motion *motion = &errors->motion;
    const double speed = way / motion->lasted, noise = way * ANGLE_NOISE, walk = motion->lasted;
    const double row[ANGLE_STATES] = {1.0, way, speed * motion->angles[HITCH], speed * motion->angles[JOINT], speed * motion->bent};
    double cross[ANGLE_STATES] = {0.0};

    errors->state[ACROSS] -= errors->scales[HITCH] * row[ANGLE_SCALE + HITCH] + errors->scales[JOINT] * row[ANGLE_SCALE + JOINT]
        + errors->latency * row[HITCH_LATENCY] + creep * speed * speed / GRAVITY * motion->closed;
    for (int i = ACROSS + 1; i < ANGLE_STATES; ++i)
        errors->state[ACROSS] += row[i] * errors->state[i];
    for (int i = 0; i < ANGLE_STATES; ++i)
        for (int j = 0; j < ANGLE_STATES; ++j)
            cross[i] += row[j] * errors->covariance[j][i];
    errors->covariance[ACROSS][ACROSS] = noise * noise;
    for (int i = 0; i < ANGLE_STATES; ++i)
        errors->covariance[ACROSS][ACROSS] += row[i] * cross[i];
    for (int i = ACROSS + 1; i < ANGLE_STATES; ++i)
        errors->covariance[ACROSS][i] = errors->covariance[i][ACROSS] = cross[i];
    errors->covariance[ANGLE_OFFSET][ANGLE_OFFSET] += walk * ANGLE_OFFSET_WALK * ANGLE_OFFSET_WALK;
    for (int i = ANGLE_SCALE; i < HITCH_LATENCY; ++i)
        errors->covariance[i][i] += walk * ANGLE_SCALE_WALK * ANGLE_SCALE_WALK;
    errors->covariance[HITCH_LATENCY][HITCH_LATENCY] += walk * HITCH_LATENCY_WALK * HITCH_LATENCY_WALK;
}

/* Draw the scale errors to zero, as measurements of zero would.
 *
 * Where the true angles hardly change, what changes in the measured ones is noise, which looks like angles that are less than
 * measured. Zero counts for more than that noise, and for less than what a curve shows. */
static COLD void angle_errors_draw_to_zero(struct angle_errors *errors, double way)
{
    const struct angle_motion *motion = &errors->motion;
    const double information = ANGLE_SCALE_DRAWN * way * way / motion->lasted;
    const int steady = fabs(motion->bent + motion->swung) < STEADY_ANGLES * motion->lasted;

    for (int i = ANGLE_SCALE; steady && i < HITCH_LATENCY && information > 0.0; ++i) {
        double cross[ANGLE_STATES];
        memcpy(cross, errors->covariance[i], sizeof cross);
        kalman_update(ANGLE_STATES, errors->state, *errors->covariance, cross, cross[i] + 1.0 / information, -errors->state[i]);
    }
}

/* The variance of the distance by one pair of fixes on masts that sway, m2: where distances are spread more than usual they count
 * for less. distance: this one, m; expected: its variance without that of this pair, m2. */
static COLD double angle_errors_sway(struct angle_errors *errors, double distance, double expected)
{
    const double usual = ACROSS_NOISE * ACROSS_NOISE;

    errors->spreads += errors->spreads < ACROSS_SETTLING;
    errors->spread += (distance * distance - expected - errors->spread) / errors->spreads;
    return usual + ACROSS_WEIGHT * fmax(errors->spread - ACROSS_USUAL * usual, 0.0);
}

/* Update with what is left of the distance; one beyond the gate is not used. */
static COLD void angle_errors_update(struct angle_errors *errors, int sways)
{
    const double innovation = -errors->state[ACROSS], expected = errors->covariance[ACROSS][ACROSS];
    double cross[ANGLE_STATES];

    errors->outside = fabs(innovation) > ACROSS_GATE ? errors->outside + 1 : 0;
    if (errors->outside)
        return;
    const double noise = sways ? angle_errors_sway(errors, innovation, expected) : ACROSS_NOISE * ACROSS_NOISE;
    memcpy(cross, errors->covariance[ACROSS], sizeof cross);
    kalman_update(ANGLE_STATES, errors->state, *errors->covariance, cross, expected + noise, innovation);
}

/* Compare the ways of both axles since the last pair of fixes. ahead: of the trailer's point before its axle, m. */
static COLD void angle_errors_compare(struct angle_errors *errors, const struct angle_sample *sample, double ahead)
{
    const struct angle_motion *motion = &errors->motion;
    const double yaw = motion->yaw / motion->lasted, psi = yaw - (motion->angles[HITCH] + motion->angles[JOINT]) / motion->lasted;
    double moved[4];

    for (int i = 0; i < 4; ++i)
        moved[i] = sample->points[i] - errors->points[i];
    const double way = moved[2] * cos(psi) + moved[3] * sin(psi);
    const double tractor = moved[1] * cos(yaw) - moved[0] * sin(yaw);
    const double trailer = moved[3] * cos(psi) - moved[2] * sin(psi) - ahead * (motion->turned - motion->closed);
    angle_errors_propagate(errors, way, sample->creep);
    errors->state[ACROSS] -= tractor - trailer;
    angle_errors_draw_to_zero(errors, way);
    angle_errors_update(errors, sample->sways);
    if (errors->outside > 1)
        angle_errors_begin(errors);
}

/* Add what the bodies have done since the last sample. */
static COLD void angle_errors_move(struct angle_errors *errors, const struct angle_sample *sample, double elapsed)
{
    const double turned = wrapped(sample->yaw - errors->yaw);
    struct angle_motion *motion = &errors->motion;

    motion->lasted += elapsed;
    motion->yaw += (errors->yaw + 0.5 * turned) * elapsed;
    for (int i = HITCH; i < ANGLES; ++i) {
        motion->angles[i] += 0.5 * (errors->angles[i] + sample->angles[i]) * elapsed;
        motion->closed += sample->angles[i] - errors->angles[i];
    }
    motion->turned += turned;
    motion->bent += sample->bent;
    motion->swung += sample->swung;
    errors->yaw += turned;
    memcpy(errors->angles, sample->angles, sizeof errors->angles);
}

/* Whether both fixes are there, and neither is the last one repeated. */
static inline int angle_errors_is_pair(const struct angle_errors *errors, const double *points)
{
    const double *last = errors->points;

    return isfinite(points[0] + points[1] + points[2] + points[3])
        && (points[0] != last[0] || points[1] != last[1]) && (points[2] != last[2] || points[3] != last[3]);
}

/* Move a correction towards its estimate less its standard deviation, where that is more than two of them and `sure`. */
static COLD void angle_errors_correct(const struct angle_errors *errors, int i, double sure, double least, double most,
                                        double step, double *correction)
{
    const double state = errors->state[i], deviation = sqrt(errors->covariance[i][i]);
    const double wanted = fabs(state) > 2.0 * deviation + sure ? clamped(state - copysign(deviation, state), least, most) : 0.0;

    *correction += clamped(wanted - *correction, -step, step);
}

/* Take a sample in, whose angles are corrected; elapsed: since the last, s. */
static NOINLINE void angle_errors_take(struct angle_errors *errors, const struct angle_sample *sample, double ahead, double elapsed)
{
    if (!(errors->covariance[HITCH_LATENCY][HITCH_LATENCY] > 0.0))
        angle_errors_begin(errors);
    const int known = isfinite(sample->yaw + sample->angles[0] + sample->angles[1] + sample->bent + sample->creep) && elapsed > 0.0;
    const int pair = known && angle_errors_is_pair(errors, sample->points);

    errors->continues = errors->continues && known && errors->motion.lasted + elapsed < BETWEEN_FIXES;
    if (errors->continues)
        angle_errors_move(errors, sample, elapsed);
    if (pair && errors->continues)
        angle_errors_compare(errors, sample, ahead);
    if (pair) {
        if (!errors->continues)
            angle_errors_begin_sum(errors);
        memcpy(errors->points, sample->points, sizeof errors->points);
        errors->yaw = sample->yaw;
        memcpy(errors->angles, sample->angles, sizeof errors->angles);
        memset(&errors->motion, 0, sizeof errors->motion);
        errors->continues = 1;
    }
    if (!(elapsed > 0.0))
        return;
    for (int i = HITCH; i < ANGLES; ++i)
        angle_errors_correct(errors, ANGLE_SCALE + i, LEAST_ANGLE_SCALE, -MOST_ANGLE_SCALE, MOST_ANGLE_SCALE,
                             ANGLE_SCALE_RATE * elapsed, &errors->scales[i]);
    angle_errors_correct(errors, HITCH_LATENCY, 0.0, 0.0, MOST_HITCH_LATENCY, HITCH_LATENCY_RATE * elapsed, &errors->latency);
}

#endif

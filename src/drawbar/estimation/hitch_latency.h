/* Latency of the hitch angle beyond its reported age and beyond that of the fixes, from the ways that both axles go.
 *
 * An axle goes where its body faces, so two pairs of fixes show the angle between tractor and trailer. Where the measured one
 * is late and changes, the trailer seems to move across itself, by its speed times the latency times the change. Summed up this
 * distance grows with a constant error of the angles and with a scale error as well; a Kalman filter separates these
 * (docs/theory/identification.md). However long the way, the sum is known as well as two positions are.
 */
#ifndef DRAWBAR_HITCH_LATENCY_H
#define DRAWBAR_HITCH_LATENCY_H

#include <math.h>
#include <stdint.h>
#include <string.h>
#include "geometry.h"
#include "noinline.h"

#define ACROSS_NOISE 0.05                  /* standard deviation of the distance by one pair of fixes, m */
#define ACROSS_GATE 0.3                    /* a distance that is not believed; twice in a row the filter begins anew, m */
#define HITCH_NOISE 0.02                   /* standard deviation of one angle between both bodies, rad */
#define HITCH_OFFSET_PRIOR 0.035           /* prior standard deviation of its constant error, rad */
#define HITCH_OFFSET_WALK 0.005            /* its random walk, as on slopes, rad per square root of a second */
#define HITCH_SCALE_PRIOR 0.05             /* prior standard deviation of its scale error */
#define HITCH_LATENCY_PRIOR 0.1            /* prior standard deviation of the latency, s */
#define HITCH_LATENCY_WALK 0.002           /* its random walk, s per square root of a second */
#define MOST_HITCH_LATENCY 0.25            /* limit of the correction, s */
#define HITCH_LATENCY_RATE 0.1             /* rate of the correction, s/s */

enum { ACROSS, HITCH_OFFSET, HITCH_SCALE, HITCH_LATENCY, HITCH_STATES };

/* One sample. */
struct hitch_sample {
    double points[4];                      /* x, y of the tractor's axle and of the trailer's point, m; NaN: unknown */
    double yaw;                            /* of the tractor, as expected, rad */
    double gamma;                          /* tractor's yaw minus trailer's, by hitch angle and joint, rad; NaN: unknown */
    double bent;                           /* expected change of the hitch angle since the last sample, rad */
    double creep;                          /* side-slip of axles per lateral acceleration, rad/g */
};

/* What the bodies have done since the last pair of fixes. */
struct hitch_motion {
    double lasted;                         /* s */
    double yaw, gamma;                     /* integrals, rad s */
    double turned, closed, bent;           /* changes of yaw, gamma and expected hitch angle, rad */
};

struct hitch_latency {
    double state[HITCH_STATES];            /* distance across that is not explained, m; constant error, rad; scale error;
                                              latency, s */
    double covariance[HITCH_STATES][HITCH_STATES];
    double latency;                        /* corrected for, s */
    double points[4];                      /* of the last pair of fixes, m */
    double yaw, gamma;                     /* of the last sample, rad */
    struct hitch_motion motion;
    int32_t continues;                     /* there is a last pair, and the angles since are known */
    int32_t outside;                       /* number of distances beyond the gate in a row */
};

/* Forget everything but the correction, which fades. */
static COLD void hitch_latency_begin(struct hitch_latency *hitch)
{
    *hitch = (struct hitch_latency){.latency = hitch->latency};
    hitch->covariance[HITCH_OFFSET][HITCH_OFFSET] = HITCH_OFFSET_PRIOR * HITCH_OFFSET_PRIOR;
    hitch->covariance[HITCH_SCALE][HITCH_SCALE] = HITCH_SCALE_PRIOR * HITCH_SCALE_PRIOR;
    hitch->covariance[HITCH_LATENCY][HITCH_LATENCY] = HITCH_LATENCY_PRIOR * HITCH_LATENCY_PRIOR;
}

/* Begin the sum: nothing is across the first pair of fixes. */
static inline void hitch_latency_begin_sum(struct hitch_latency *hitch)
{
    for (int i = 0; i < HITCH_STATES; ++i)
        hitch->covariance[ACROSS][i] = hitch->covariance[i][ACROSS] = 0.0;
    hitch->covariance[ACROSS][ACROSS] = ACROSS_NOISE * ACROSS_NOISE;
    hitch->state[ACROSS] = 0.0;
}

/* Propagate over a way (m) since the last pair of fixes. */
static COLD void hitch_latency_propagate(struct hitch_latency *hitch, double way, double creep)
{
    const struct hitch_motion *motion = &hitch->motion;
    const double speed = way / motion->lasted, noise = way * HITCH_NOISE;
    const double row[HITCH_STATES] = {1.0, way, speed * motion->gamma, speed * motion->bent};
    double cross[HITCH_STATES] = {0.0};

    hitch->state[ACROSS] -= speed * hitch->latency * motion->bent + creep * speed * speed / GRAVITY * motion->closed;
    for (int i = ACROSS + 1; i < HITCH_STATES; ++i)
        hitch->state[ACROSS] += row[i] * hitch->state[i];
    for (int i = 0; i < HITCH_STATES; ++i)
        for (int j = 0; j < HITCH_STATES; ++j)
            cross[i] += row[j] * hitch->covariance[j][i];
    hitch->covariance[ACROSS][ACROSS] = noise * noise;
    for (int i = 0; i < HITCH_STATES; ++i)
        hitch->covariance[ACROSS][ACROSS] += row[i] * cross[i];
    for (int i = ACROSS + 1; i < HITCH_STATES; ++i)
        hitch->covariance[ACROSS][i] = hitch->covariance[i][ACROSS] = cross[i];
    hitch->covariance[HITCH_OFFSET][HITCH_OFFSET] += motion->lasted * HITCH_OFFSET_WALK * HITCH_OFFSET_WALK;
    hitch->covariance[HITCH_LATENCY][HITCH_LATENCY] += motion->lasted * HITCH_LATENCY_WALK * HITCH_LATENCY_WALK;
}

/* Update with what is left of the distance; one beyond the gate is not used. */
static inline void hitch_latency_update(struct hitch_latency *hitch)
{
    const double innovation = -hitch->state[ACROSS];
    const double variance = hitch->covariance[ACROSS][ACROSS] + ACROSS_NOISE * ACROSS_NOISE;
    double cross[HITCH_STATES];

    hitch->outside = fabs(innovation) > ACROSS_GATE ? hitch->outside + 1 : 0;
    if (hitch->outside)
        return;
    memcpy(cross, hitch->covariance[ACROSS], sizeof cross);
    for (int i = 0; i < HITCH_STATES; ++i) {
        hitch->state[i] += cross[i] / variance * innovation;
        for (int j = 0; j < HITCH_STATES; ++j)
            hitch->covariance[i][j] -= cross[i] * cross[j] / variance;
    }
}

/* Compare the ways of both axles since the last pair of fixes. ahead: of the trailer's point before its axle, m. */
static COLD void hitch_latency_compare(struct hitch_latency *hitch, const struct hitch_sample *sample, double ahead)
{
    const struct hitch_motion *motion = &hitch->motion;
    const double yaw = motion->yaw / motion->lasted, psi = yaw - motion->gamma / motion->lasted;
    double moved[4];

    for (int i = 0; i < 4; ++i)
        moved[i] = sample->points[i] - hitch->points[i];
    const double way = moved[2] * cos(psi) + moved[3] * sin(psi);
    const double tractor = moved[1] * cos(yaw) - moved[0] * sin(yaw);
    const double trailer = moved[3] * cos(psi) - moved[2] * sin(psi) - ahead * (motion->turned - motion->closed);
    hitch_latency_propagate(hitch, way, sample->creep);
    hitch->state[ACROSS] -= tractor - trailer;
    hitch_latency_update(hitch);
    if (hitch->outside > 1)
        hitch_latency_begin(hitch);
}

/* Add what the bodies have done since the last sample. */
static inline void hitch_latency_move(struct hitch_latency *hitch, const struct hitch_sample *sample, double elapsed)
{
    const double turned = wrapped(sample->yaw - hitch->yaw), closed = sample->gamma - hitch->gamma;
    struct hitch_motion *motion = &hitch->motion;

    motion->lasted += elapsed;
    motion->yaw += (hitch->yaw + 0.5 * turned) * elapsed;
    motion->gamma += (hitch->gamma + 0.5 * closed) * elapsed;
    motion->turned += turned;
    motion->closed += closed;
    motion->bent += sample->bent;
    hitch->yaw += turned;
    hitch->gamma = sample->gamma;
}

/* Whether both fixes are there, and neither is the last one repeated. */
static inline int hitch_latency_is_pair(const struct hitch_latency *hitch, const double *points)
{
    const double *last = hitch->points;

    return isfinite(points[0] + points[1] + points[2] + points[3])
        && (points[0] != last[0] || points[1] != last[1]) && (points[2] != last[2] || points[3] != last[3]);
}

/* Move the corrected latency towards the estimate less its standard deviation, where that is two of them at least. */
static inline void hitch_latency_apply(struct hitch_latency *hitch, double elapsed)
{
    const double state = hitch->state[HITCH_LATENCY], deviation = sqrt(hitch->covariance[HITCH_LATENCY][HITCH_LATENCY]);
    const double wanted = state > 2.0 * deviation ? fmin(state - deviation, MOST_HITCH_LATENCY) : 0.0;

    hitch->latency += clamped(wanted - hitch->latency, -HITCH_LATENCY_RATE * elapsed, HITCH_LATENCY_RATE * elapsed);
}

/* Take a sample in, whose angles are corrected; elapsed: since the last, s. */
static NOINLINE void hitch_latency_take(struct hitch_latency *hitch, const struct hitch_sample *sample, double ahead, double elapsed)
{
    if (!(hitch->covariance[HITCH_LATENCY][HITCH_LATENCY] > 0.0))
        hitch_latency_begin(hitch);
    const int known = isfinite(sample->yaw + sample->gamma + sample->bent + sample->creep) && elapsed > 0.0;
    const int pair = known && hitch_latency_is_pair(hitch, sample->points);

    hitch->continues = hitch->continues && known && hitch->motion.lasted + elapsed < BETWEEN_FIXES;
    if (hitch->continues)
        hitch_latency_move(hitch, sample, elapsed);
    if (pair && hitch->continues)
        hitch_latency_compare(hitch, sample, ahead);
    if (pair) {
        if (!hitch->continues)
            hitch_latency_begin_sum(hitch);
        memcpy(hitch->points, sample->points, sizeof hitch->points);
        hitch->yaw = sample->yaw;
        hitch->gamma = sample->gamma;
        memset(&hitch->motion, 0, sizeof hitch->motion);
        hitch->continues = 1;
    }
    if (elapsed > 0.0)
        hitch_latency_apply(hitch, elapsed);
}

#endif

/* Sanity: faults that no controller can correct, and that slow the vehicle down or end the run: of positions
 * (position_watch.h), of the hitch angle (hitch_watch.h), and a loop that oscillates (swings.h). */
#ifndef DRAWBAR_SANITY_H
#define DRAWBAR_SANITY_H

#include "hitch_watch.h"
#include "position_watch.h"
#include "signals.h"
#include "status.h"
#include "swings.h"
#include "unit.h"

#define MOST_SPELLS 2                      /* how often a run may begin to oscillate */
#define SMALL_SWING 0.5                    /* share of a steering swing that is small, as of play: it is only driven slower for */
#define SMALL_SWINGS 2                     /* times as many half waves of which are an oscillation */
#define SWING_SPEED 0.1                    /* below which a vehicle shows no calm, m/s */

struct component {
    /* settings, described in safety/sanity.py */
    double coarse_after, coarse_share, coarse_budget;
    double swing, steering_swing, swing_share, swing_calm;
    struct position_watch positions;
    struct hitch_watch hitch;
    double wheelbase;                      /* m */
    int32_t swings_slow, swings_stop;      /* half waves */
    /* state */
    struct swings errors[2], steering, play;
    int32_t swinging, oscillations;        /* it oscillates; how often that has started, */
    int32_t slowing;                       /* and how many of these times the vehicle is driven slower for */
    double calm;                           /* driven since the last swing, s */
    int32_t initialised;
};

#define COMPONENT_FIELDS                                                                                               \
    POSITION_WATCH_FIELDS(component, positions) HITCH_WATCH_FIELDS(component, hitch)                                   \
    SETTING(component, coarse_after, 0, 1, 0, 0) SETTING(component, coarse_share, 0, 1, 0, 0)                          \
    SETTING(component, coarse_budget, 0, 1, 0, 0) SETTING(component, wheelbase, 0, 1, 0, 0)                            \
    SETTING(component, swing, 0, 1, 0, 0) SETTING(component, steering_swing, 0, 1, 0, 0)                               \
    SETTING(component, swing_share, 0, 1, 0, 0) SETTING(component, swing_calm, 0, 1, 0, 0)                             \
    SETTING(component, swings_slow, 1, 1, 0, 0) SETTING(component, swings_stop, 1, 1, 0, 0)

/* How many half waves in a row either error or the steering has swung; `small`: the steering by half as much. */
static inline int32_t swings_of(struct component *sanity, const struct drawbar_estimate *estimate,
                                const struct drawbar_body_reference *tractor, const struct drawbar_body_reference *trailer,
                                double elapsed, int32_t *small)
{
    const double beside = estimate->tractor_steering - atan(sanity->wheelbase * tractor->closest[AT_CURVATURE]);
    const int32_t one = swings_update(&sanity->errors[0], elapsed, tractor->lateral_error, sanity->swing);
    const int32_t other = swings_update(&sanity->errors[1], elapsed, trailer->lateral_error, sanity->swing);
    const int32_t steering = swings_update(&sanity->steering, elapsed, beside, sanity->steering_swing);
    const int32_t errors = one > other ? one : other;

    *small = swings_update(&sanity->play, elapsed, beside, SMALL_SWING * sanity->steering_swing);
    return errors > steering ? errors : steering;
}

/* Update with half waves in a row; returns the part of the set speed that may be driven. The speed that oscillated first is tried
 * again once it is calm: it may have been the way onto the line, or delays that were not known yet. It stays low if it was not. */
static inline double share_of_swings(struct component *sanity, int32_t swings, int32_t small, double speed, double elapsed)
{
    const int large = swings >= sanity->swings_slow, swinging = large || small >= SMALL_SWINGS * sanity->swings_slow;
    const int begins = swinging && !sanity->swinging;
    double share = 1.0;

    sanity->swinging = swinging;
    sanity->oscillations += begins;
    sanity->slowing += begins && sanity->slowing < (large ? MOST_SPELLS : 1);
    sanity->calm = swings > 0 || swinging ? 0.0 : fabs(speed) >= SWING_SPEED ? sanity->calm + elapsed : sanity->calm;
    if (sanity->oscillations == 1 && sanity->calm > sanity->swing_calm)
        sanity->slowing = 0;
    for (int32_t i = 0; i < sanity->slowing; ++i)
        share *= sanity->swing_share;
    return share;
}

/* Judge one step, as it was reported and as it was aligned: returns 0 or the status with which the run ends; `share`
 * becomes the part of the set speed that may be driven. departure: see yaw_residual.h, rad. */
int UNIT(judge)(struct component *sanity, const struct drawbar_measurement *reported,
                const struct drawbar_measurement *measurement, const struct drawbar_estimate *estimate,
                const struct drawbar_body_reference *tractor, const struct drawbar_body_reference *trailer, double departure,
                double *share)
{
    struct position_watch *positions = &sanity->positions;

    if (!sanity->initialised) {
        positions_begin(positions, measurement->time);
        sanity->initialised = 1;
    }
    const double coarse = positions_without_fine(positions, measurement, estimate);
    const double elapsed = measurement->time - positions->time;
    double fixes[4];
    fine_fixes(positions, measurement, fixes);
    const int backwards = positions_move_backwards(positions, measurement, fixes, estimate);
    const int jumped = positions_have_jumped(positions, measurement, fixes, estimate);
    const int contradiction = hitch_judge(&sanity->hitch, reported->hitch_angle, measurement, estimate, departure, elapsed);
    int32_t small;
    const int32_t swings = swings_of(sanity, estimate, tractor, trailer, elapsed, &small);

    *share = share_of_swings(sanity, swings, small, estimate->speed, elapsed);
    *share *= coarse > sanity->coarse_after && !is_between_fixes(positions, coarse, estimate) ? sanity->coarse_share : 1.0;
    if (backwards)
        return DRAWBAR_BACKWARDS;
    if (jumped)
        return DRAWBAR_JUMPED;
    if (contradiction)
        return contradiction;
    if (coarse > sanity->coarse_budget)
        return DRAWBAR_COARSE;
    return swings >= sanity->swings_stop || (sanity->oscillations > MOST_SPELLS && swings >= sanity->swings_slow)
        ? DRAWBAR_OSCILLATION : 0;
}

#endif

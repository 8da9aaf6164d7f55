/* Pace: the speed that is commanded. It is the set speed, approached by a ramp, and less of it the longer the vehicle
 * is driven on predictions alone.
 *
 * Two clocks measure for how long that has been: `unsolved`, since estimator and both controllers have last had a solution
 * (a sample counts for as long as it lasted, and for one sample time at least), and `overdue`, by which samples came
 * late, less half of the time that has passed in order since. For a sixth of the endurance the speed stays; then it falls
 * in proportion, to zero at the endurance, and with it the run ends.
 *
 * Every model takes a sample for one sample time. `counted` is the time that samples were taken for, beyond what has
 * passed by their time stamps. Jitter does not add up in it, since a late sample is taken for that much less;
 * another sample rate does. Clocks may differ by a share.
 */
#ifndef DRAWBAR_PACE_H
#define DRAWBAR_PACE_H

#include "components.h"
#include "geometry.h"

#define PACE_KEPT (1.0 / 6.0)              /* share of the endurance for which the speed stays */
#define PACE_CLOCKS 0.05                   /* share of the time that has passed by which clocks may differ */
#define PACE_COUNTED 5.0                   /* sample times by which counted and passed time may differ beyond that */

static inline void pace_begin(struct autopilot *a)
{
    a->speed = a->wanted_speed;
    a->sane = 1.0;
    a->unsolved = a->overdue = a->counted = 0.0;
}

/* The least speed that plans assume, m/s: a plan takes the speed for constant, and one made for a machine that has
 * just started, and creeps, would steer too much too late. */
static inline double pace_planned(const struct autopilot *a)
{
    const double wanted = a->sane * a->wanted_speed;
    return wanted > 0.0 ? fmin(a->settings.planned_speed, wanted) : a->settings.planned_speed;
}

/* Follow a vehicle that is driven by others at a speed (m/s): later commands start from it. Returns the speed for plans,
 * m/s. */
static inline double pace_follow(struct autopilot *a, double speed)
{
    a->speed = clamped(speed, 0.0, a->settings.speed);
    return a->speed;
}

/* Note for how long (s) the last sample lasted; return how many samples were left out. */
static inline int pace_left_out(struct autopilot *a, double elapsed)
{
    const double sample = a->settings.sample_time, allowed = PACE_CLOCKS * elapsed;
    const int late = elapsed > 1.5 * sample;
    const int lasted = late ? (int)fmax((elapsed - fmax(a->counted, 0.0)) / sample + 0.5, 1.0) : 1;

    a->unsolved += fmax(elapsed - sample, 0.0);
    a->overdue = late ? a->overdue + elapsed - sample : fmax(a->overdue - 0.5 * sample, 0.0);
    a->counted += lasted * sample - elapsed;
    a->counted -= clamped(a->counted, -allowed, allowed);
    a->diagnostics.flags |= late ? DRAWBAR_LATE : 0;
    return lasted - 1;
}

/* Whether samples come at another rate than the models take them for. */
static inline int pace_is_of_another_rate(const struct autopilot *a)
{
    return fabs(a->counted) > PACE_COUNTED * a->settings.sample_time;
}

/* Set the speed to command. Returns 0, or enum drawbar_status where the run cannot continue. */
static inline int pace_step(struct autopilot *a, int solved)
{
    const struct step_settings *settings = &a->settings;
    const double change = settings->acceleration * settings->sample_time;
    const double ramped = a->speed + clamped(a->sane * a->wanted_speed - a->speed, -change, change);
    struct drawbar_diagnostics *d = &a->diagnostics;

    a->unsolved = solved ? 0.0 : a->unsolved + settings->sample_time;
    const double spent = fmax(a->unsolved, a->overdue) / settings->endurance;
    const double share = clamped((1.0 - spent) / (1.0 - PACE_KEPT), 0.0, 1.0);
    a->speed = fmin(ramped, share * settings->speed);
    d->speed = a->speed;
    d->unsolved = a->unsolved;
    d->overdue = a->overdue;
    d->flags |= (solved ? 0 : DRAWBAR_SOLVER) | (fmin(share, a->sane) < 1.0 ? DRAWBAR_SLOWED : 0);
    if (share > 0.0)
        return 0;
    return a->unsolved >= a->overdue ? DRAWBAR_UNSOLVED : DRAWBAR_OVERDUE;
}

#endif

/* One position loop: valve or motor, front wheels, joint or pedal (hardware note, section 5.3).
 *
 *     u     = (K e + I) / r            r: full rate of the side to which it goes; |u| <= 1
 *     drive = sign(u) (d + (limit - d) |u|)      d: the share of the dead band that is skipped
 *
 * Within the stop zone the drive is 0. I integrates only where u is not saturated or the error takes it back, and never
 * beyond its limit; it is 0 from the moment the loop is released.
 */
#ifndef DRAWBAR_POSITION_LOOP_H
#define DRAWBAR_POSITION_LOOP_H

#include <math.h>
#include "linearise.h"

struct position_memory {
    double integral;                       /* I, rad/s or strokes/s */
};

static int position_loop_is_sound(const struct drawbar_position_loop *loop)
{
    const double least = 1.0 / LARGEST_SETTING;
    int sound = setting_within(loop->proportional, least, LARGEST_SETTING)
        && setting_within(loop->integral, 0.0, LARGEST_SETTING) && setting_within(loop->integral_limit, 0.0, 1.0)
        && setting_within(loop->stop_zone, 0.0, LARGEST_SETTING) && setting_within(loop->limit, least, LARGEST_SETTING)
        && setting_within(loop->compensation, 0.0, 1.0) && setting_within(loop->drive_limit, least, 1.0);

    for (int side = 0; side < 2; ++side)
        sound = sound && setting_within(loop->full_rate[side], least, LARGEST_SETTING)
            && loop->dead_band[side] >= 0.0 && loop->dead_band[side] < loop->drive_limit;
    return sound;
}

/* Integrate an error over dt, unless the actuator is fully open (saturated: its sign, or 0) and the error asks for more. */
static double integrated(const struct drawbar_position_loop *loop, double integral, double error, double saturated,
                         double dt)
{
    if (saturated * error > 0.0)
        return integral;
    const double next = integral + loop->integral * error * dt;
    const double left = loop->integral_limit * loop->full_rate[0], right = -loop->integral_limit * loop->full_rate[1];
    return next > left ? left : next < right ? right : next;
}

/* Return the drive for an error, and whether it is as large as it can be: *saturated its sign, or 0. */
static double position_drive(const struct drawbar_position_loop *loop, struct position_memory *memory, double error,
                             double dt, double *saturated)
{
    *saturated = 0.0;
    if (fabs(error) <= loop->stop_zone)
        return 0.0;
    const double rate = loop->proportional * error + memory->integral;
    const int side = rate >= 0.0 ? 0 : 1;
    const double share = fabs(rate) / loop->full_rate[side], sign = side == 0 ? 1.0 : -1.0;
    if (share >= 1.0)
        *saturated = sign;
    memory->integral = integrated(loop, memory->integral, error, *saturated, dt);
    if (rate == 0.0)
        return 0.0;
    const double skipped = loop->compensation * loop->dead_band[side];
    return sign * (skipped + (loop->drive_limit - skipped) * (share < 1.0 ? share : 1.0));
}

#endif

/* The outer loop of the speed: set point -> ramp -> feed-forward and PI -> the pedal's set point (section 5.4).
 *
 *     pedal = v_ref / v_full + K (v_ref - v) + I, clamped to [0, full]
 *
 * I integrates only where neither the pedal nor the loop below it is as far as it can go in that direction. At the set
 * point 0 the reference reaches 0, and from then on the pedal is 0 whatever is measured.
 */
#ifndef DRAWBAR_SPEED_LOOP_H
#define DRAWBAR_SPEED_LOOP_H

#include <math.h>
#include "linearise.h"

struct speed_memory {
    double reference;                      /* m/s */
    double integral;                       /* I, strokes */
    double unmoved;                        /* for how long the pedal has been pressed without motion, s */
};

static int speed_loop_is_sound(const struct drawbar_speed_loop *loop)
{
    const double least = 1.0 / LARGEST_SETTING;

    return setting_within(loop->proportional, 0.0, LARGEST_SETTING)
        && setting_within(loop->integral, 0.0, LARGEST_SETTING)
        && setting_within(loop->full_speed, least, LARGEST_SETTING)
        && setting_within(loop->acceleration, least, LARGEST_SETTING)
        && setting_within(loop->deceleration, least, LARGEST_SETTING)
        && setting_within(loop->stopping, least, LARGEST_SETTING) && setting_within(loop->full_pedal, least, 1.0)
        && setting_within(loop->moving_pedal, least, 1.0) && setting_within(loop->patience, least, LARGEST_SETTING);
}

/* Begin where the vehicle is, so that engaging is no jump. */
static void speed_begin(const struct drawbar_speed_loop *loop, struct speed_memory *memory, double speed)
{
    memory->reference = speed < 0.0 ? 0.0 : speed > loop->full_speed ? loop->full_speed : speed;
    memory->integral = memory->unmoved = 0.0;
}

static double ramped(const struct drawbar_speed_loop *loop, double reference, double wanted, double dt)
{
    if (wanted > reference)
        return fmin(wanted, reference + loop->acceleration * dt);
    return fmax(wanted, reference - (wanted == 0.0 ? loop->stopping : loop->deceleration) * dt);
}

/* Return the pedal's set point. held: the sign of the direction in which the pedal moves as fast as it can, or 0. */
static double speed_pedal(const struct drawbar_speed_loop *loop, struct speed_memory *memory, double wanted,
                          double speed, double held, double dt)
{
    memory->reference = ramped(loop, memory->reference, wanted, dt);
    if (memory->reference == 0.0) {
        memory->integral = 0.0;
        return 0.0;
    }
    const double error = memory->reference - speed;
    const double pedal = memory->reference / loop->full_speed + loop->proportional * error + memory->integral;
    const double beyond = pedal > loop->full_pedal ? 1.0 : pedal < 0.0 ? -1.0 : held;
    if (!(beyond * error > 0.0)) {
        const double next = memory->integral + loop->integral * error * dt;
        memory->integral = fmax(-loop->full_pedal, fmin(loop->full_pedal, next));
    }
    return fmax(0.0, fmin(loop->full_pedal, pedal));
}

/* Whether the wheels have reported standstill for too long although the pedal is pressed. */
static int speed_is_unmoved(const struct drawbar_speed_loop *loop, struct speed_memory *memory, double pedal,
                            int standing, double dt)
{
    memory->unmoved = standing && pedal > loop->moving_pedal ? memory->unmoved + dt : 0.0;
    return memory->unmoved > loop->patience;
}

#endif

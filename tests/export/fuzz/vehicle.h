/* A vehicle that obeys: the articulated model (docs/theory) without slip, so that a fuzzer's runs are mostly plausible.
 * WHEELBASE, FREE_JOINT_BEHIND (the rear axle), DRAWBAR_LENGTH, TRAILER_LENGTH, POINT_BEHIND (the actuated joint) (m), LAG (s),
 * TRACTOR_RATE and TRAILER_RATE (rad/s) are those of the configuration, nearly. */
#ifndef VEHICLE_H
#define VEHICLE_H

#include <math.h>
#include "drawbar_signals.h"

#define STEPS 10
#define SLOPE 0.05                         /* the ground's, which falls to the south, rad */
#define TRACTOR_MAST 2.5                   /* height, m */
#define TRAILER_MAST 2.0

struct vehicle {
    double time, x, y, yaw, trailer_yaw;   /* s, m, rad */
    double joint, steering, speed;         /* rad, rad, m/s */
};

static inline double followed(double angle, double command, double rate, double step)
{
    const double wanted = (command - angle) / LAG;

    return angle + step * fmin(fmax(wanted, -rate), rate);
}

static inline void vehicle_move(struct vehicle *v, const struct drawbar_command *command, double step)
{
    const double joint = followed(v->joint, command->trailer_steering, TRAILER_RATE, step);
    const double turned = (joint - v->joint) / step, length = TRAILER_LENGTH + DRAWBAR_LENGTH * cos(joint);
    const double yaw_rate = v->speed * tan(v->steering) / WHEELBASE, beside = v->yaw - v->trailer_yaw;
    const double pulled = v->speed * sin(beside) - FREE_JOINT_BEHIND * yaw_rate * cos(beside);

    v->x += step * v->speed * cos(v->yaw);
    v->y += step * v->speed * sin(v->yaw);
    v->trailer_yaw += step * (pulled - DRAWBAR_LENGTH * turned * cos(joint)) / length;
    v->yaw += step * yaw_rate;
    v->joint = joint;
    v->steering = followed(v->steering, command->tractor_steering, TRACTOR_RATE, step);
    v->speed += step * (command->speed - v->speed) / 0.5;
    v->time += step;
}

/* Let one sample pass under the command. */
static inline void vehicle_drive(struct vehicle *v, const struct drawbar_command *command, double sample)
{
    for (int i = 0; i < STEPS; ++i)
        vehicle_move(v, command, sample / STEPS);
}

/* What the cheapest sensors report, and how both bodies lean; it has no others. */
static inline struct drawbar_measurement vehicle_measure(const struct vehicle *v)
{
    const double drawbar_yaw = v->trailer_yaw + v->joint;
    struct drawbar_measurement measured = DRAWBAR_NOTHING_MEASURED;

    measured.time = v->time;
    measured.tractor_x = v->x;
    measured.tractor_y = v->y;
    measured.trailer_x = v->x - FREE_JOINT_BEHIND * cos(v->yaw) - DRAWBAR_LENGTH * cos(drawbar_yaw)
        - POINT_BEHIND * cos(v->trailer_yaw);
    measured.trailer_y = v->y - FREE_JOINT_BEHIND * sin(v->yaw) - DRAWBAR_LENGTH * sin(drawbar_yaw)
        - POINT_BEHIND * sin(v->trailer_yaw);
    measured.hitch_angle = v->yaw - drawbar_yaw;
    measured.speed = v->speed;
    measured.tractor_steering = v->steering;
    measured.trailer_steering = v->joint;
    measured.tractor_y -= TRACTOR_MAST * sin(SLOPE);
    measured.trailer_y -= TRAILER_MAST * sin(SLOPE);
    measured.tractor_roll = SLOPE * cos(v->yaw);
    measured.tractor_pitch = SLOPE * sin(v->yaw);
    measured.trailer_roll = SLOPE * cos(v->trailer_yaw);
    measured.trailer_pitch = SLOPE * sin(v->trailer_yaw);
    return measured;
}

#endif

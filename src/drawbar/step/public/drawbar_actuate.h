/* Actuation: the low level, from set points of both steering angles and the speed to the drives of valves, motors and
 * the pedal.
 *
 * Once:                    drawbar_actuate_init
 * 50 to 200 times a second: drawbar_actuate, then send the drives to the outputs, whatever the statuses
 *
 * It stands by itself: it needs nothing of drawbar.h, and no path. A board or a valve that closes its own position loop
 * needs none of it. The same law drives a proportional valve and a PWM motor; they differ in their numbers alone. No
 * function allocates memory, reads a clock or keeps anything outside the state.
 *
 * SI units, radians, steering left positive. A pedal's position is a share of its stroke, 0 where the vehicle stands.
 * "Counts" are whatever the sensor's converter gives: integers, volts.
 *
 * What any fault does: a steering actuator gets drive 0, so that it is released; the pedal is driven back to 0, and where
 * its own sensor is at fault gets drive 0, so that its spring must bring it back. A fault stays until the caller has
 * asked for nothing (steer or drive 0) for one call. These are the reactions of a regulator, not a safety function: an
 * independent gate has to stand between it and the outputs.
 */
#ifndef DRAWBAR_ACTUATE_H
#define DRAWBAR_ACTUATE_H

#include <stdint.h>
#include "drawbar_api.h"

#ifdef __cplusplus
extern "C" {
#endif

#define DRAWBAR_TABLE_POINTS 16            /* of a sensor's table, at most */
#define DRAWBAR_ACTUATE_DOUBLES 256        /* size of the state */

/* What is actuated. */
enum drawbar_actuator {
    DRAWBAR_ACTUATOR_FRONT,                /* front wheels */
    DRAWBAR_ACTUATOR_JOINT,                /* the trailer's joint */
    DRAWBAR_ACTUATOR_PEDAL,                /* of the hydrostat */
    DRAWBAR_ACTUATORS
};

/* How one actuator fares; the higher number is the worse. */
enum drawbar_actuate_status {
    DRAWBAR_ACTUATE_FINE = 0,              /* it does as it is asked */
    DRAWBAR_ACTUATE_OFF = 1,               /* nothing is asked of it: drive 0 */
    DRAWBAR_ACTUATE_STANDING = 2,          /* not steered any further until the vehicle moves: it stands */
    DRAWBAR_ACTUATE_FAULT = 16,            /* from here on: a fault, see above */
    DRAWBAR_ACTUATE_TIME = 16,             /* the time is not finite, does not increase, or a call came too late */
    DRAWBAR_ACTUATE_SET_POINT = 17,        /* the set point is not finite or beyond its limit */
    DRAWBAR_ACTUATE_SENSOR = 18,           /* counts not finite or outside the sensor's electrical range */
    DRAWBAR_ACTUATE_SPEED = 19,            /* the measured speed is not finite or beyond what the vehicle can do */
    DRAWBAR_ACTUATE_NO_FEEDBACK = 20,      /* the pedal is pressed and the wheels report that they stand */
    DRAWBAR_ACTUATE_WRONG_CALL = 64,       /* from here on: the call was wrong, all drives are 0 */
    DRAWBAR_ACTUATE_NULL = 64,             /* a pointer is NULL */
    DRAWBAR_ACTUATE_NOT_INITIALISED = 65,  /* drawbar_actuate_init has not been called with success */
    DRAWBAR_ACTUATE_SETTINGS = 66,         /* a setting is not finite or beyond what is allowed here */
    DRAWBAR_ACTUATE_UNALIGNED = 67,        /* a pointer is not aligned as a double */
    DRAWBAR_ACTUATE_ARITHMETIC = 68        /* compiled with -ffast-math or the like: NaN passes for a number */
};

/* From counts to an angle or a position: a table, or a cubic polynomial. */
struct drawbar_sensor {
    double lowest, highest;                /* electrical range, counts; what is outside is a fault */
    double counts[DRAWBAR_TABLE_POINTS];   /* of the table, increasing */
    double values[DRAWBAR_TABLE_POINTS];   /* there, rad or strokes, rising or falling throughout; linear between them,
                                            * and beyond the ends as in the last piece */
    double cubic[4];                       /* without a table: c0 + c1 n + c2 n^2 + c3 n^3, rising or falling from
                                            * lowest to highest */
    int32_t points;                        /* of the table, 2 to 16; 0: the cubic */
    int32_t reserved;
};

/* A position loop: u = (K e + I) / r, drive = sign(u) (c d + (limit - c d) |u|) with the compensation c and the dead band d;
 * see docs/actuation.md. */
struct drawbar_position_loop {
    double proportional;                   /* K, 1/s, above 0 */
    double integral;                       /* of I, 1/s^2, 0 or more; 0 is a good value */
    double integral_limit;                 /* largest |I| as a share of the full rate, 0 to 1 */
    double stop_zone;                      /* largest error at which the drive is 0, rad or strokes, 0 or more */
    double limit;                          /* largest set point, rad or strokes, above 0 */
    double dead_band[2];                   /* drive below which nothing moves, to the left (or up), to the right;
                                            * 0 to below drive_limit */
    double compensation;                   /* share of the dead band that is skipped, 0 to 1 */
    double full_rate[2];                   /* r, at the largest drive, left (or up), right, rad/s or strokes/s, above 0 */
    double drive_limit;                    /* largest drive, above 0 to 1 */
};

/* The outer loop of the speed: a ramp, feed-forward and PI make the pedal's set point. */
struct drawbar_speed_loop {
    double proportional;                   /* strokes per m/s, 0 or more */
    double integral;                       /* strokes per m/s and second, 0 or more */
    double full_speed;                     /* at the full pedal, and the largest set point, m/s, above 0 */
    double acceleration;                   /* of the reference, m/s^2, above 0: upwards, */
    double deceleration;                   /* downwards, */
    double stopping;                       /* and towards 0 */
    double full_pedal;                     /* largest pedal, strokes, above 0 to 1 */
    double moving_pedal;                   /* beyond which the wheels must report motion, strokes, above 0 to 1 */
    double patience;                       /* for how long they may report none, s, above 0 */
};

/* Numbers of one machine; those of actuators that are not there may be 0. */
struct drawbar_actuate_settings {
    struct drawbar_sensor sensors[DRAWBAR_ACTUATORS];
    struct drawbar_position_loop loops[DRAWBAR_ACTUATORS];
    struct drawbar_speed_loop speed;
    double longest_period;                 /* between two calls, s, above 0 to 1 */
    double standstill;                     /* speed below which the vehicle stands, m/s, above 0 */
    double standing_time;                  /* for how long a standing tyre may be steered, s, 0 or more */
    int32_t present[DRAWBAR_ACTUATORS];    /* 0: there is no such actuator */
    int32_t reserved;
};

struct drawbar_actuate_input {
    double time;                           /* of any steady clock, s */
    double counts[DRAWBAR_ACTUATORS];      /* of the sensors */
    double steering[2];                    /* set points, rad; looked at where steer is set */
    double speed;                          /* set point, m/s, 0 to full_speed; looked at where drive is set */
    double measured_speed;                 /* of the wheels, m/s; not finite: for the steering, the vehicle stands */
    int32_t steer[2];                      /* not 0: steer. Set it to 0 while the operator overrides */
    int32_t drive;                         /* not 0: drive */
    int32_t reserved;
};

struct drawbar_actuate_output {
    double drives[DRAWBAR_ACTUATORS];      /* -1 to 1, to the left or up positive; always finite, 0: no power */
    double positions[DRAWBAR_ACTUATORS];   /* measured, rad or strokes; NaN where the sensor is at fault or absent */
    double pedal;                          /* the pedal's set point, strokes */
    int32_t statuses[DRAWBAR_ACTUATORS];   /* enum drawbar_actuate_status */
    int32_t reserved;
};

/* All that the low level of one vehicle remembers, its settings included. Its content is private. */
struct drawbar_actuate_state {
    double memory[DRAWBAR_ACTUATE_DOUBLES];
};

/* Check the settings and take them over; everything is off. Returns enum drawbar_actuate_status: FINE, or
 * what was wrong with the call or the build. */
DRAWBAR_API int drawbar_actuate_init(struct drawbar_actuate_state *state, const struct drawbar_actuate_settings *settings);

/* Compute the drives; returns the worst of the statuses. The output is complete whatever is returned, unless it is NULL. */
DRAWBAR_API int drawbar_actuate(struct drawbar_actuate_state *state, const struct drawbar_actuate_input *input,
                                struct drawbar_actuate_output *output);

/* What a status means, in one line. */
DRAWBAR_API const char *drawbar_actuate_status_text(int status);

#ifdef __cplusplus
}
#endif

#endif

/* The signals that enter and leave one control step; signals.py has the same ones, with more words.
 *
 * SI units, radians, x east, y north, yaw counter-clockwise from east and continuous, steering left positive. NaN: missing.
 */
#ifndef DRAWBAR_SIGNALS_H
#define DRAWBAR_SIGNALS_H

#include <stdint.h>

/* One pose of the path's table; see drawbar_set_path. */
struct drawbar_path_node {
    double arc_length;                     /* from the path's start, m */
    double x, y;                           /* m */
    double yaw;                            /* continuous along the path, rad */
};

enum drawbar_fix {
    DRAWBAR_FIX_ACCEPTED,
    DRAWBAR_FIX_MISSING,                   /* the receiver reported none */
    DRAWBAR_FIX_STALE,                     /* the receiver repeated an old one while the vehicle moved */
    DRAWBAR_FIX_REJECTED                   /* further from where it was expected than it can be */
};

struct drawbar_measurement {
    double time;                           /* s */
    double tractor_x, tractor_y;           /* tractor antenna, m */
    double trailer_x, trailer_y;           /* trailer antenna, m */
    double hitch_angle;                    /* tractor yaw minus drawbar yaw, rad */
    double speed;                          /* of the wheels, m/s */
    double tractor_steering;               /* front wheels, rad */
    double trailer_steering;               /* actuated joint between drawbar and trailer, rad */
};

struct drawbar_pose {
    double x, y;                           /* m */
    double yaw;                            /* rad */
};

struct drawbar_estimate {
    double time;                           /* s */
    struct drawbar_pose tractor, trailer;  /* of the antennas */
    double hitch_angle;                    /* beta, rad */
    double speed;                          /* v, of the wheels, m/s */
    double tractor_steering;               /* delta_t, rad */
    double trailer_steering;               /* delta_i, rad */
    double longitudinal_slip;              /* mu */
    double tractor_slip;                   /* kappa */
    double trailer_slip;                   /* eta; 1 where the model has none */
    double steering_offset;                /* b, rad; 0 where the model has none */
    double tractor_crab;                   /* alpha_r, rad; 0 where the model has none */
    double trailer_crab;                   /* alpha_i, rad; 0 where the model has none */
    int32_t status;                        /* of its solver: 0 solved, 1 too many iterations, 2 infeasible,
                                            * 3 not finite, 4 failed its check, 5 bad input */
    int32_t tractor_fix, trailer_fix;      /* enum drawbar_fix */
    int32_t reserved;
};

struct drawbar_command {
    double time;                           /* s */
    double tractor_steering;               /* rad */
    double trailer_steering;               /* rad, in the actuator's own sign */
    double speed;                          /* m/s */
};

#endif

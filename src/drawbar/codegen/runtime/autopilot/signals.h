/* The signals that flow through one control step; signals.py has the same ones, with more words.
 *
 * SI units, radians, x east, y north, yaw counter-clockwise from east and continuous, steering left positive. NaN: missing.
 */
#ifndef DRAWBAR_SIGNALS_H
#define DRAWBAR_SIGNALS_H

#include <stdint.h>

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
    int32_t status;                        /* enum qp_status */
    int32_t tractor_fix, trailer_fix;      /* enum drawbar_fix */
    int32_t reserved;
};

/* The path as one body's controller sees it. */
struct drawbar_body_reference {
    double progress;                       /* arc length of the closest point, m */
    double lateral_error;                  /* of the body from the path, left positive, m */
    double closest[4];                     /* the path there: x, y (m), yaw (rad, any branch), curvature (1/m) */
    const double (*samples)[4];            /* the same at each stage, yaw on the branch of the estimate: (N+1) rows */
};

/* One nominal controller's answer; the arrays are the controller's own and valid until its next call. */
struct drawbar_body_plan {
    double steering;                       /* nominal steering to apply now, rad */
    const double (*poses)[3];              /* (N+1) rows: predicted x, y (m), yaw (rad) of the antenna */
    const double *steerings;               /* (N) planned steering, rad */
    const double *deviation;               /* x^ - x- in the error coordinates of this body's controller */
    int32_t deviations;                    /* how many there are; none where the vehicle is held to no nominal state */
    int32_t status;                        /* enum qp_status */
};

struct drawbar_command {
    double time;                           /* s */
    double tractor_steering;               /* rad */
    double trailer_steering;               /* rad, in the actuator's own sign */
    double speed;                          /* m/s */
};

#endif

/* Signals between the components of one control step. Arrays behind pointers are their maker's own and valid until
 * its next call.
 *
 * Generated from signals/ and statuses.py by `python -m drawbar.signals.c_headers`; change them there. */
#ifndef DRAWBAR_INNER_SIGNALS_H
#define DRAWBAR_INNER_SIGNALS_H

#include <float.h>
#include <math.h>
#include "drawbar_signals.h"

/* What the run monitor decided about a run. */
enum monitor_verdict {
    ON_COURSE = 0,
    OFF_COURSE = 1,                     /* the tractor is too far from the path, or its distance is not known */
    BLIND = 2                           /* neither antenna has had an accepted fix for too long */
};

/* The path as one body's controller sees it: the closest point and one sample for each stage. */
struct drawbar_body_reference {
    double progress;                    /* arc length of the closest point, m */
    double lateral_error;               /* of the body from the path, left positive, m */
    double closest[4];                  /* the path at the closest point: x (m), y (m), yaw (rad, on any branch),
                                         * curvature (1/m) */
    const double (*samples)[4];         /* (N + 1) x (m), y (m), yaw (rad, on the branch of the estimate),
                                         * curvature (1/m) of each stage */
};

/* One nominal controller's answer. */
struct drawbar_body_plan {
    double steering;                    /* nominal steering to apply now, rad */
    const double (*poses)[3];           /* (N + 1) predicted x (m), y (m), yaw (rad) of the body's point */
    const double *steerings;            /* (N) planned steering, rad */
    const double *deviation;            /* (deviations) x^ - x- in the error coordinates of this body's
                                         * controller; empty where there is no nominal state */
    int32_t status;                     /* enum drawbar_solver */
    int32_t deviations;
};

/* How one steering command came about: nominal plus ancillary, then clipped. */
struct drawbar_body_steering {
    double nominal;                     /* of the plan, rad */
    double ancillary;                   /* K (x^ - x-), rad */
    double command;                     /* their sum within the bound, rad */
    double margin;                      /* how far inside its tube the body is: 1 at its centre, 0 on its
                                         * boundary, negative outside; NaN: none declared */
    int32_t saturated;                  /* the sum was beyond the bound */
    int32_t reserved;
};

/* The truth, which only a simulation has. */
struct drawbar_truth {
    double time;                        /* s */
    struct drawbar_pose tractor;
    struct drawbar_pose trailer;
    double speed;                       /* wheel speed, m/s */
    double tractor_steering;            /* rad */
    double trailer_steering;            /* rad */
    double longitudinal_slip;           /* mu */
    double tractor_slip;                /* kappa */
    double steering_offset;             /* b, rad */
    double tractor_crab;                /* alpha_r, rad */
    double trailer_crab;                /* alpha_i, rad */
    double tractor_roll;                /* right side down positive, rad */
    double tractor_pitch;               /* nose up positive, rad */
    double trailer_roll;                /* right side down positive, rad */
    double trailer_pitch;               /* nose up positive, rad */
    double tractor_height;              /* of the tractor's point on the ground, m */
    double trailer_height;              /* of the trailer's point on the ground, m */
};

/* Largest magnitudes that sensors can mean, of the measurement's numbers but the time, in order. */
static const double measurement_limits[] = {
    10000000.0,                 /* tractor_x */
    10000000.0,                 /* tractor_y */
    10000000.0,                 /* trailer_x */
    10000000.0,                 /* trailer_y */
    6.283185307179586,          /* hitch_angle */
    50.0,                       /* speed */
    6.283185307179586,          /* tractor_steering */
    6.283185307179586,          /* trailer_steering */
    10000000.0,                 /* tractor_fix_deviation */
    10000000.0,                 /* trailer_fix_deviation */
    6.283185307179586,          /* tractor_roll */
    6.283185307179586,          /* tractor_pitch */
    6.283185307179586,          /* tractor_yaw */
    50.0,                       /* tractor_yaw_rate */
    6.283185307179586,          /* trailer_roll */
    6.283185307179586,          /* trailer_pitch */
    50.0,                       /* trailer_yaw_rate */
    DBL_MAX,                    /* tractor_fix_age */
    DBL_MAX,                    /* trailer_fix_age */
    DBL_MAX,                    /* hitch_angle_age */
    DBL_MAX,                    /* speed_age */
    DBL_MAX,                    /* tractor_steering_age */
    DBL_MAX,                    /* trailer_steering_age */
    DBL_MAX,                    /* tractor_attitude_age */
    DBL_MAX,                    /* trailer_attitude_age */
};

#endif

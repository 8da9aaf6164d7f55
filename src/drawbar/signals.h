/* The signals between the parts of one control step; signals.py has the same ones, with more words. */
#ifndef DRAWBAR_INNER_SIGNALS_H
#define DRAWBAR_INNER_SIGNALS_H

#include "drawbar_signals.h"

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

/* How one steering command came about: nominal plus ancillary, then clipped. */
struct drawbar_body_steering {
    double nominal;                        /* rad */
    double ancillary;                      /* K (x^ - x-), rad */
    double command;                        /* after the bound, rad */
    double margin;                         /* 1 at the tube's centre, 0 on its boundary; NaN: none declared */
    int32_t saturated;
};

#endif

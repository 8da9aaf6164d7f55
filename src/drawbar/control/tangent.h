/* Where a body is beside its path. */
#ifndef DRAWBAR_TANGENT_H
#define DRAWBAR_TANGENT_H

#include <math.h>

#include "signals.h"

/* The distance of a body from the tangent of its reference where it is now, left positive, m. */
static inline double tangent_distance(const struct drawbar_pose *pose, const struct drawbar_body_reference *reference)
{
    const double *now = reference->samples[0];
    return cos(now[2]) * (pose->y - now[1]) - sin(now[2]) * (pose->x - now[0]);
}

#endif

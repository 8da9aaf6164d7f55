/* Tangent of a body's path, beside which the body is. */
#ifndef DRAWBAR_TANGENT_H
#define DRAWBAR_TANGENT_H

#include "geometry.h"
#include "signals.h"

/* The distance of a body from the tangent of its reference where it is now, left positive, m. */
static inline double tangent_distance(const struct drawbar_pose *pose, const struct drawbar_body_reference *reference)
{
    const double *now = reference->samples[0];
    return cos(now[AT_YAW]) * (pose->y - now[AT_Y]) - sin(now[AT_YAW]) * (pose->x - now[AT_X]);
}

#endif

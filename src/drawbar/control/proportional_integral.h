/* Proportional-integral control of the trailer's lateral error; both gains zero hold the joint straight.
 *
 * A positive joint angle shifts the trailer to the right, so an error to the left wants a positive one. While the
 * output would pass its limit the integral rests (conditional integration, Astrom and Hagglund 1995, section 3.5); so
 * it never holds more than the limit, and gives way as soon as the error changes its sign.
 */
#ifndef DRAWBAR_PROPORTIONAL_INTEGRAL_H
#define DRAWBAR_PROPORTIONAL_INTEGRAL_H

#include "geometry.h"

struct proportional_integral {
    double proportional, integral;         /* gains, rad/m and rad/(m s) */
    double interval;                       /* sample time, s */
    double limit;                          /* largest output, rad */
    double gathered;                       /* state: the integral's part of the output, rad */
};

/* The joint angle (rad) for this lateral error (m, left positive). */
static inline double proportional_integral(struct proportional_integral *law, double error)
{
    const double gathered = law->gathered + law->integral * law->interval * error;
    const double wanted = law->proportional * error + gathered;

    if (fabs(wanted) <= law->limit)
        law->gathered = gathered;
    return clipped(wanted, law->limit);
}

#endif

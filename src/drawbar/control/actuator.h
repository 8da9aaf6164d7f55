/* Actuator: from a planned steering rate to the command that makes a lagging actuator follow it, delta' = (u - delta) /
 * tau, whose command u is held over a sample. */
#ifndef DRAWBAR_ACTUATOR_H
#define DRAWBAR_ACTUATOR_H

#include "geometry.h"

struct actuator {
    double lead;                           /* dt / (1 - exp(-dt / tau)), s */
    double limit;                          /* largest command, rad */
    double rate_share;                     /* part of its rate that plans may ask for */
    double sign;                           /* -1 where the actuator is reversed, else 1 */
};

#define ACTUATOR_FIELDS(place)                                                                    \
    SETTING(component, place.lead, 0, 1, 0, 0) SETTING(component, place.limit, 0, 1, 0, 0) \
    SETTING(component, place.rate_share, 0, 1, 0, 0) SETTING(component, place.sign, 0, 1, 0, 0)

/* The command (rad) that moves the steering (rad) at a mean rate (rad/s) over a sample. It ends at the limit, which the
 * lag then approaches from inside; `rate` becomes the rate of that command. */
static inline double actuator_follow(const struct actuator *actuator, double steering, double *rate)
{
    const double wanted = actuator->sign * (steering + actuator->lead * *rate);
    const double command = clipped(wanted, actuator->limit);

    *rate = (actuator->sign * command - steering) / actuator->lead;
    return command;
}

/* The command (rad) that leads the steering to an angle (rad) and keeps it there. */
static inline double actuator_hold(const struct actuator *actuator, double steering)
{
    return clipped(actuator->sign * steering, actuator->limit);
}

#endif

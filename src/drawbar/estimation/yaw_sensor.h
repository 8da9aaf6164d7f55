/* Yaw sensor: two antennas on the tractor, which tell where it faces.
 *
 * The line of the antennas is never quite the one that was configured. Where fixes of both bodies and the angles between
 * them show the yaw too, how far it is off on average is found and taken off; where the tractor has the only receiver
 * nothing shows it, and the estimated side-slip takes it up. A yaw that is far from what is expected, as one of wrong
 * ambiguities is, is not believed.
 */
#ifndef DRAWBAR_YAW_SENSOR_H
#define DRAWBAR_YAW_SENSOR_H

#include <math.h>
#include <stdint.h>
#include "geometry.h"

#define YAW_SHOWN 0.15                     /* furthest that fixes and angles may show it off from what is known of that, rad */
#define YAW_UNPROVED 3                     /* samples that a mounting without error counts for */
#define YAW_MEMORY 500                     /* samples that the error is averaged over at most */

struct yaw_sensor {
    double gate;                           /* furthest that a yaw may be from the expected one, rad */
    double error;                          /* of the mounting, clockwise, rad */
    int32_t samples;
};

/* The told yaw (rad) without the mounting's error and with the turns of the expected one; NaN where it is none to believe.
 *
 * shown: by fixes and angles, rad; NaN: by none. */
static inline double yaw_believed(struct yaw_sensor *sensor, double told, double expected, double shown)
{
    const double off = wrapped(told + sensor->error - expected), error = wrapped(shown - told) - sensor->error;

    if (!(fabs(off) <= sensor->gate))
        return (double)NAN;
    if (fabs(error) <= YAW_SHOWN) {
        sensor->samples += sensor->samples < YAW_MEMORY;
        sensor->error += error / (sensor->samples + YAW_UNPROVED);
    }
    return expected + off;
}

#endif

/* Yaw sensor: two antennas on the tractor, which measure its yaw.
 *
 * The mounting of the antennas differs from the configured one. Where fixes of both bodies and the angles between them give a
 * reference for the yaw, the mean difference is the mounting's error and is corrected; where the tractor has the only receiver
 * it is not observable, and the estimated side-slip absorbs it. A yaw outside its gate, as with wrong ambiguities, is rejected.
 */
#ifndef DRAWBAR_YAW_SENSOR_H
#define DRAWBAR_YAW_SENSOR_H

#include <math.h>
#include <stdint.h>
#include "geometry.h"

#define YAW_REFERENCE_GATE 0.15            /* largest change of the mounting's error by one reference, rad */
#define YAW_PRIOR_SAMPLES 3                /* weight of the prior, a mounting without error, in samples */
#define YAW_MEMORY 500                     /* samples that the mean covers at most */

struct yaw_sensor {
    double gate;                           /* largest innovation, rad */
    double error;                          /* of the mounting, clockwise, rad */
    int32_t samples;
};

/* The measured yaw (rad) without the mounting's error and with the turns of the expected one; NaN where it is rejected.
 *
 * reference: by fixes and angles, rad; NaN: unknown. */
static inline double yaw_judged(struct yaw_sensor *sensor, double measured, double expected, double reference)
{
    const double innovation = wrapped(measured + sensor->error - expected), error = wrapped(reference - measured) - sensor->error;

    if (!(fabs(innovation) <= sensor->gate))
        return (double)NAN;
    if (fabs(error) <= YAW_REFERENCE_GATE) {
        sensor->samples += sensor->samples < YAW_MEMORY;
        sensor->error += error / (sensor->samples + YAW_PRIOR_SAMPLES);
    }
    return expected + innovation;
}

#endif

/* Ages of measured values, where the clock of a sensor is a little ahead of the one that stamps the sample. */
#ifndef DRAWBAR_AGES_H
#define DRAWBAR_AGES_H

#include "signals.h"

#define AHEAD 0.05                         /* by how much a value may be of the future and counts as of now, s */
#define OF_NOW 1e-6                        /* s; 0: not reported */

/* Set the ages of values that are a little of the future to now, in place. */
static inline void ages_of_now(struct drawbar_measurement *m)
{
    double *const ages[] = {&m->tractor_fix_age, &m->trailer_fix_age, &m->hitch_angle_age, &m->speed_age,
                            &m->tractor_steering_age, &m->trailer_steering_age, &m->tractor_attitude_age,
                            &m->trailer_attitude_age};

    for (int i = 0; i < (int)(sizeof ages / sizeof *ages); ++i)
        if (*ages[i] < 0.0 && *ages[i] >= -AHEAD)
            *ages[i] = OF_NOW;
}

#endif

/* Neighbour: what the trailer's controller may know of the tractor; its coupling decides how much of it is used
 * (subsystem.h). */
#ifndef DRAWBAR_NEIGHBOUR_H
#define DRAWBAR_NEIGHBOUR_H

#include "signals.h"

struct drawbar_neighbour {
    const struct drawbar_body_reference *reference;   /* its line: given to both controllers by the guidance */
    const struct drawbar_body_plan *plan;             /* what its controller plans */
};

#endif

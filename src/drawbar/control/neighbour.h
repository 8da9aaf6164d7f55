/* Neighbour: line and plan of the tractor for the trailer's controller; its coupling decides which of them is used
 * (subsystem.h). */
#ifndef DRAWBAR_NEIGHBOUR_H
#define DRAWBAR_NEIGHBOUR_H

#include "signals.h"

struct drawbar_neighbour {
    const struct drawbar_body_reference *reference;   /* its line: given to both controllers by the guidance */
    const struct drawbar_body_plan *plan;  /* what its controller plans */
};

#endif

/* Hosted unit, the end of a unit of Python's own library: gives Python the places of the component's fields, and lets it
 * set them.
 *
 * A component's memory holds two structures. Python writes the settings into the second; the first, at work, begins as
 * its copy.
 */
#ifndef DRAWBAR_HOSTED_H
#define DRAWBAR_HOSTED_H

#include "fields.h"
#include "unit.h"

int64_t UNIT(size) = sizeof(struct component);
#ifdef WORK
int64_t UNIT(work_size) = sizeof(WORK);
#else
int64_t UNIT(work_size) = 0;
#endif

int UNIT(initialise)(struct component *component)
{
    component[0] = component[1];
    return 0;
}

int UNIT(set_watcher)(void (*by)(int32_t phase))
{
    watcher = by;
    return 0;
}

#endif

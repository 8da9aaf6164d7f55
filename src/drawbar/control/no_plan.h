/* No plan: the phases of a controller whose laws neither prepare anything nor look ahead. */
#ifndef DRAWBAR_NO_PLAN_H
#define DRAWBAR_NO_PLAN_H

#include "signals.h"
#include "status.h"
#include "unit.h"

struct component;

int UNIT(ready)(struct component *component)
{
    (void)component;
    return SOLVED;
}

int UNIT(skip)(struct component *component, int samples)
{
    (void)samples;
    return UNIT(ready)(component);
}

int UNIT(actuation)(struct component *component, const struct drawbar_actuation *known)
{
    (void)component, (void)known;
    return 0;
}

#endif

/* Ideal estimator, the truth in place of an estimate: the caller writes it into `given` before each update. For Python's
 * own library alone. */
#ifndef DRAWBAR_IDEAL_H
#define DRAWBAR_IDEAL_H

#include "solver_resources.h"
#include "signals.h"
#include "status.h"
#include "unit.h"

struct component {
    struct drawbar_estimate given;
};

#define COMPONENT_FIELDS FIELD(component, given, 0, sizeof(struct drawbar_estimate) / sizeof(double), 0, 0)

int UNIT(begin)(struct component *component, const struct drawbar_measurement *first)
{
    (void)component;
    (void)first;
    return SOLVED;
}

int UNIT(expected)(struct component *component, struct drawbar_estimate *estimate)
{
    *estimate = component->given;
    return SOLVED;
}

int UNIT(update)(struct component *component, const struct drawbar_measurement *measurement,
                 struct drawbar_estimate *estimate, struct solver_resources *resources)
{
    (void)resources;
    *estimate = component->given;
    estimate->time = measurement->time;
    return SOLVED;
}

int UNIT(ready)(struct component *component, const struct drawbar_command *acting)
{
    (void)component;
    (void)acting;
    return SOLVED;
}

int UNIT(skip)(struct component *component, const struct drawbar_command *acting)
{
    return UNIT(ready)(component, acting);
}

int UNIT(actuation)(struct component *component, const struct drawbar_actuation *known)
{
    (void)component, (void)known;
    return 0;
}

#endif

/* Faults of the solvers: the linker lets the library call these in place of its own functions, which they call. A solver
 * that fails says so; the steering of a plan may then be any number at all. */
#ifndef SOLVERS_H
#define SOLVERS_H

#include "components.h"

enum { ESTIMATOR_FAILS = 1, TRACTOR_FAILS = 2, TRAILER_FAILS = 4 };

struct solver_faults {
    int which;                             /* flags of those above */
    int32_t status;                        /* what they say */
    int spoilt;                            /* the plans' steering is replaced */
    double steering;                       /* by this */
    int happened;                          /* since somebody cleared it */
};

static struct solver_faults solver_faults;

typedef int update(struct component *, const struct drawbar_measurement *, struct drawbar_estimate *, struct solver_resources *);
typedef int feedback(struct component *, const struct drawbar_estimate *, const struct drawbar_body_reference *,
                     const struct drawbar_neighbour *, struct drawbar_body_plan *, struct solver_resources *);

update __real_drawbar_estimator_update, __wrap_drawbar_estimator_update;
feedback __real_drawbar_tractor_feedback, __wrap_drawbar_tractor_feedback;
feedback __real_drawbar_trailer_feedback, __wrap_drawbar_trailer_feedback;

/* Whether this one is to fail now. */
static int fails(int which)
{
    solver_faults.happened |= solver_faults.which & which;
    return solver_faults.which & which;
}

static int spoil(struct drawbar_body_plan *plan)
{
    if (solver_faults.spoilt)
        plan->steering = solver_faults.steering;
    return plan->status = solver_faults.status;
}

int __wrap_drawbar_estimator_update(struct component *component, const struct drawbar_measurement *measurement,
                                    struct drawbar_estimate *estimate, struct solver_resources *resources)
{
    const int status = __real_drawbar_estimator_update(component, measurement, estimate, resources);

    return fails(ESTIMATOR_FAILS) ? (estimate->status = solver_faults.status) : status;
}

int __wrap_drawbar_tractor_feedback(struct component *component, const struct drawbar_estimate *estimate,
                                    const struct drawbar_body_reference *reference,
                                    const struct drawbar_neighbour *neighbour, struct drawbar_body_plan *plan,
                                    struct solver_resources *resources)
{
    const int status = __real_drawbar_tractor_feedback(component, estimate, reference, neighbour, plan, resources);

    return fails(TRACTOR_FAILS) ? spoil(plan) : status;
}

int __wrap_drawbar_trailer_feedback(struct component *component, const struct drawbar_estimate *estimate,
                                    const struct drawbar_body_reference *reference,
                                    const struct drawbar_neighbour *neighbour, struct drawbar_body_plan *plan,
                                    struct solver_resources *resources)
{
    const int status = __real_drawbar_trailer_feedback(component, estimate, reference, neighbour, plan, resources);

    return fails(TRAILER_FAILS) ? spoil(plan) : status;
}

#endif

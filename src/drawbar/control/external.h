/* External controller, the user's own, in Python: called back at each sample. For Python's own library alone.
 *
 * It gives both steering angles; its further plan is unknown, so the plan assumes that they are held and that both
 * bodies are on their references. The unit defines N, the samples of the path ahead.
 */
#ifndef DRAWBAR_EXTERNAL_H
#define DRAWBAR_EXTERNAL_H

#include <string.h>
#include "solver_resources.h"
#include "no_plan.h"
#include "signals.h"
#include "status.h"
#include "unit.h"

enum { EXTERNAL_TRACTOR, EXTERNAL_TRAILER, EXTERNAL_BODIES };

/* Writes both angles (rad), the trailer's in the sense of the joint. */
typedef void (*external_call)(const struct drawbar_estimate *estimate, const struct drawbar_body_reference *tractor,
                              const struct drawbar_body_reference *trailer, double *angles);

struct component {
    external_call call;
    double joint_sign;                     /* -1 where the trailer's actuator is reversed, else 1 */
    double poses[EXTERNAL_BODIES][N + 1][3], steerings[EXTERNAL_BODIES][N];
};

#define COMPONENT_FIELDS FIELD(component, call, 0, 1, 0, 0) SETTING(component, joint_sign, 0, 1, 0, 0)

static void hold(struct component *component, int body, const struct drawbar_body_reference *reference, double angle,
                 double command, struct drawbar_body_plan *plan)
{
    for (int k = 0; k <= N; ++k)
        memcpy(component->poses[body][k], reference->samples[k], sizeof component->poses[body][k]);
    for (int k = 0; k < N; ++k)
        component->steerings[body][k] = angle;
    *plan = (struct drawbar_body_plan){
        .steering = command, .poses = (const double (*)[3])component->poses[body],
        .steerings = component->steerings[body], .status = SOLVED
    };
}

int UNIT(feedback)(struct component *component, const struct drawbar_estimate *estimate,
                   const struct drawbar_body_reference *tractor_reference,
                   const struct drawbar_body_reference *trailer_reference, struct drawbar_body_plan *tractor,
                   struct drawbar_body_plan *trailer, struct solver_resources *resources)
{
    double angles[EXTERNAL_BODIES] = {(double)NAN, (double)NAN};

    (void)resources;
    component->call(estimate, tractor_reference, trailer_reference, angles);
    hold(component, EXTERNAL_TRACTOR, tractor_reference, angles[0], angles[0], tractor);
    hold(component, EXTERNAL_TRAILER, trailer_reference, angles[1], component->joint_sign * angles[1], trailer);
    return SOLVED;
}

#endif

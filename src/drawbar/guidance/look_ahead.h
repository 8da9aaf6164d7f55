/* Look-ahead guidance, the paper's: references from the point a fixed distance ahead of the closest one. The tractor's
 * reference advances from there at nominal speed, the trailer's stays. */
#ifndef DRAWBAR_LOOK_AHEAD_H
#define DRAWBAR_LOOK_AHEAD_H

#include "guidance.h"
#include "unit.h"

struct component {
    struct guidance guidance;
    double look_ahead;                     /* m */
    double advance[BODIES];                /* of each body's reference from stage to stage, m */
};

#define COMPONENT_FIELDS                                                                                          \
    GUIDANCE_FIELDS(component, guidance.) SETTING(component, look_ahead, 0, 1, 0, 0) SETTING(component, advance, 0, BODIES, 0, 0)

/* The look-ahead alone leads onto the line. */
void UNIT(rejoin)(struct component *component)
{
    (void)component;
}

/* Place both bodies on the path from where they stand when the run begins; returns an enum drawbar_guidance. */
int UNIT(begin)(struct component *component, const struct path *path, double start,
                const struct drawbar_measurement *first, double *distance)
{
    return guidance_begin(&component->guidance, path, start, first, distance);
}

/* Go on along another path; nothing changes where the vehicle is not on it. */
int UNIT(change)(struct component *component, const struct path *path, double start,
                 const struct drawbar_estimate *estimate)
{
    return guidance_change(&component->guidance, path, start, estimate);
}

/* Whether the tractor has reached the end of the path. */
int UNIT(finished)(struct component *component, const struct path *path)
{
    return guidance_finished(&component->guidance, path);
}

/* What both controllers shall follow now; returns an enum drawbar_guidance. */
int UNIT(reference)(struct component *component, const struct path *path, const struct drawbar_estimate *estimate,
                    struct drawbar_body_reference *tractor, struct drawbar_body_reference *trailer, void *work)
{
    struct guidance *guidance = &component->guidance;
    struct drawbar_body_reference *const references[BODIES] = {tractor, trailer};
    const int status = guidance_advance(guidance, path, estimate, references);

    (void)work;
    if (status != DRAWBAR_GUIDANCE_FINE)
        return status;
    for (int i = 0; i < BODIES; ++i) {
        double places[STAGES + 1];
        for (int j = 0; j <= STAGES; ++j)
            places[j] = component->look_ahead + component->advance[i] * j + guidance->progress[i];
        drawbar_path_samples(path, places, STAGES + 1, guidance->samples[i]);
    }
    guidance_to_branch(guidance, estimate);
    return DRAWBAR_GUIDANCE_FINE;
}

#endif

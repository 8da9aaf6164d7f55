/* The phases of one body's nominal controller, around those of its solver; see subsystem.h. */
#ifndef DRAWBAR_SUBSYSTEM_PHASES_H
#define DRAWBAR_SUBSYSTEM_PHASES_H

#include "optimised_start.h"
#include "subsystem.h"

#if POSE_STATES
typedef char states_begin_with_a_pose[(int)X_X == AT_X && (int)X_Y == AT_Y && (int)X_YAW == AT_YAW ? 1 : -1];
#endif

/* The nominal state, without what separates it from the estimate along the path; the estimate itself where there is
 * none to go on from. */
static void nominal_state(struct subsystem *body, const double *closest)
{
    memcpy(body->nominal, body->follows ? body->successor : body->estimated, sizeof body->nominal);
    if (POSE_STATES && body->follows)
        move_beside(body->nominal, closest);
}

/* Let the problem start where the tube wants it to. */
static void set_begin(struct subsystem *body, struct rti *solver)
{
    const double *begin = body->restarts ? body->estimated : body->nominal;

    memcpy(iteration_begin(solver), begin, NX * sizeof *begin);
    if (FREE_INITIAL)
        allow_first_state(body, solver);
}

/* The feedback phase before its solver's: take in estimate, reference and, where the coupling is planned, the other
 * body's plan (or NULL). */
int UNIT(enter)(struct component *component, const struct drawbar_estimate *estimate,
                const struct drawbar_body_reference *reference, const struct drawbar_body_plan *neighbour)
{
    struct subsystem *body = &component->subsystem;
    struct drawbar_estimate here = *estimate;
    struct drawbar_body_reference ahead = *reference;
    double samples[N + 1][4];

    if (FREE_INITIAL && POSE_STATES) {
        change_frame(body, &component->rti, reference->closest);
        see_from_frame(body, &here, &ahead, samples);
    }
    body_state(&here, body->estimated);
    nominal_state(body, ahead.closest);
    set_begin(body, &component->rti);
    fill(component, &here, &ahead, neighbour);
    iteration_enter(&body->iteration, &component->rti);
    return SOLVED;
}

/* x^ - x- in the coordinates in which the ancillary law acts. */
static void state_deviation(struct subsystem *body, const double *nominal)
{
    (POSE_STATES ? pose_deviation : plain_deviation)(body->estimated, nominal, NX, body->deviation);
}

/* The feedback phase after its solver's: make a plan of the solution. */
int UNIT(leave)(struct component *component, struct drawbar_body_plan *plan)
{
    struct subsystem *body = &component->subsystem;
    struct rti *solver = &component->rti;
    double *first = STATE(solver->z, 0);

    plan->status = iteration_leave(&body->iteration, solver);
    body->follows = plan->status == SOLVED;
    if (!body->follows)                    /* of a plan that failed only its begin is known */
        memcpy(first, iteration_begin(solver), NX * sizeof *first);
    plan->steering = body_command(component);
    if (body->follows)
        memcpy(body->successor, iteration_successor(solver), sizeof body->successor);
    body_plan(component);
    if (FREE_INITIAL && POSE_STATES)
        place_in_world(body);
    state_deviation(body, FREE_INITIAL ? first : body->nominal);
    plan->poses = (const double (*)[3])body->poses;
    plan->steerings = body->steerings;
    plan->deviation = body->deviation;
    plan->deviations = DEVIATIONS;
    return plan->status;
}

/* The preparation phase after its solver's. */
int UNIT(judge)(struct component *component)
{
    iteration_judge(&component->subsystem.iteration, &component->rti);
    return SOLVED;
}

#ifdef EXPORTED
int UNIT(feedback)(struct component *component, const struct drawbar_estimate *estimate,
                   const struct drawbar_body_reference *reference, const struct drawbar_body_plan *neighbour,
                   struct drawbar_body_plan *plan, void *work)
{
    UNIT(enter)(component, estimate, reference, neighbour);
    rti_feedback(&component->rti, work);
    return UNIT(leave)(component, plan);
}

int UNIT(ready)(struct component *component)
{
    rti_shift(&component->rti);
    rti_prepare(&component->rti);
    return UNIT(judge)(component);
}
#endif

#endif

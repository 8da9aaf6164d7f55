/* The phases of one body's nominal controller, around those of its solver; see subsystem.h. */
#ifndef DRAWBAR_SUBSYSTEM_PHASES_H
#define DRAWBAR_SUBSYSTEM_PHASES_H

#include "optimised_start.h"
#include "subsystem.h"

#if POSE_STATES
typedef char states_begin_with_a_pose[(int)X_X == AT_X && (int)X_Y == AT_Y && (int)X_YAW == AT_YAW ? 1 : -1];
#endif

/* The nominal state, moved along the path to beside the estimate; the estimate itself without a last plan. */
static void nominal_state(struct subsystem *body, const double *closest)
{
    memcpy(body->nominal, body->predicts ? body->successor : body->estimated, sizeof body->nominal);
    if (POSE_STATES && body->predicts)
        move_beside(body->nominal, closest);
}

/* Set the problem's initial state: the estimate, the nominal state, or free within the tube. */
static void set_begin(struct subsystem *body, struct rti *solver)
{
    const double *begin = body->restarts ? body->estimated : body->nominal;

    memcpy(iteration_begin(solver), begin, NX * sizeof *begin);
    if (FREE_INITIAL)
        allow_first_state(body, solver);
}

/* Fill the problem with estimate, reference and, for couplings that need it, the other body's line and plan (or NULL). */
static void take_in(struct component *component, const struct drawbar_estimate *estimate,
                    const struct drawbar_body_reference *reference, const struct drawbar_neighbour *neighbour)
{
    struct subsystem *body = &component->subsystem;
    struct drawbar_estimate here = *estimate;
    struct drawbar_body_reference ahead = *reference;
    double samples[N + 1][4];

    if (FREE_INITIAL && POSE_STATES) {
        change_frame(body, &component->rti, reference->closest);
        state_in_frame(body, &here, &ahead, samples);
    }
    body_state(&here, body->estimated);
    nominal_state(body, ahead.closest);
    set_begin(body, &component->rti);
    fill(component, &here, &ahead, neighbour);
    iteration_enter(&body->iteration, &component->rti);
}

/* x^ - x- in the coordinates in which the ancillary law acts. */
static void state_deviation(struct subsystem *body, const double *nominal)
{
    (POSE_STATES ? pose_deviation : plain_deviation)(body->estimated, nominal, NX, body->deviation);
}

/* Repeat the last plan that was solved, shifted by one sample; its last values are held. */
static void repeat_plan(struct subsystem *body)
{
    memmove(body->poses[0], body->poses[1], N * sizeof body->poses[0]);
    memmove(&body->steerings[0], &body->steerings[1], (N - 1) * sizeof body->steerings[0]);
}

/* Make a plan of the solution, in the world's frame. */
static void make_plan(struct component *component, struct drawbar_body_plan *plan)
{
    struct subsystem *body = &component->subsystem;

    plan->steering = body_command(component);
    if (body->predicts)
        memcpy(body->successor, iteration_successor(&component->rti), sizeof body->successor);
    body_plan(component);
    if (FREE_INITIAL && POSE_STATES)
        place_in_world(body);
}

/* A body steers by a plan's first command and by the deviation of the estimate from its initial state. Where the solver failed
 * that is the last solved plan, if there has been one, and the deviation is zero. */
int UNIT(feedback)(struct component *component, const struct drawbar_estimate *estimate,
                   const struct drawbar_body_reference *reference, const struct drawbar_neighbour *neighbour,
                   struct drawbar_body_plan *plan, struct solver_resources *resources)
{
    struct subsystem *body = &component->subsystem;
    struct rti *solver = &component->rti;
    double *first = STATE(solver->z, 0);

    take_in(component, estimate, reference, neighbour);
    WATCHED(WATCHED_FEEDBACK, rti_feedback(solver, resources));
    plan->status = iteration_leave(&body->iteration, solver);
    body->predicts = plan->status == SOLVED;
    body->solved |= body->predicts;
    if (!body->predicts)                   /* only the initial state of a failed plan is valid */
        memcpy(first, iteration_begin(solver), NX * sizeof *first);
    if (body->predicts || !body->solved) {
        make_plan(component, plan);
    } else {
        repeat_plan(body);
        plan->steering = body_hold(component, body->steerings[0]);
    }
    state_deviation(body, FREE_INITIAL ? first : body->nominal);
    if (!body->predicts)
        memset(body->deviation, 0, sizeof body->deviation);
    plan->poses = (const double (*)[3])body->poses;
    plan->steerings = body->steerings;
    plan->deviation = body->deviation;
    plan->deviations = DEVIATIONS;
    return plan->status;
}

#define PLANNER subsystem
#include "plan_phases.h"

#endif

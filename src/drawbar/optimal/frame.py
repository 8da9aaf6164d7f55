"""Frame of C text around a problem's functions: the solver's unit, its table of fields, its phases."""

WORK = "struct rti *work"
ROWS = f"const {WORK}, double (*rows)[OLD_WIDTH]"
UNIT = """
#define N {horizon}
#define NX {states}
#define NU {inputs}
#define NP {parameters}
#define NY {outputs}
#define NB {bounds}
#define NS {still_states}
#define NC {constant_states}
#define CONSTANTS {constants}
#define CROSS {cross}
#define FREE_INITIAL {free}
#define LEAVING {leaving}
#define LEAST_STEP {added}
#define COLUMNS {columns}
#define IP_ITERATIONS {iterations}
#define LARGEST_INPUT {largest:g}
{held}#include "{header}"
{functions}
{names}{component}
"""
CARRIED = "double (*carried)[CARRIED]"
ADAPTIVE = """
#define ATTEMPTS {attempts}
#define FIRST_SHARE {first}
#define CARRIED_STATES {states}
#define CARRIED_COLUMNS {columns}
#include "adaptive.h"
"""
SOLVER_FIELDS = """
    {"rti.x", offsetof(struct component, rti.z), 0, {N + 1, NX, 0}, 0, 0},
    {"rti.u", offsetof(struct component, rti.z) + sizeof(double) * (N + 1) * NX, 0, {N, NU, 0}, 0, 0},
    RTI(p, 0, N + 1, NP > 0 ? NP : EMPTY, 0) RTI(y, 0, N + 1, NY, 0) SET(w, N + 1, NY)
    SET(constants, CONSTANTS, 0) RTI(initial, 0, NX, 0, 0) SET(lower, NB, 0) SET(upper, NB, 0) SET(root, NX, NX)
    RTI(prior, 0, NX, 0, 0) SET(process, NX, 0) SET(common, NX, 0) RTI(status, 1, 1, 0, 0)
    QP_FIELDS(component, rti.qp.)"""
"""entries of the table of fields (fields.h)"""
TABLE = """
#include "workspace.h"
const struct drawbar_field drawbar_fields[] = {%s COMPONENT_FIELDS END_OF_FIELDS};
"""
PHASES = """
int lay_down(struct rti *work) { rti_constants(work); return SOLVED; }
int prepare(struct rti *work) { return rti_prepare(work); }
int feedback(struct workspace *s)
{
    struct solver_resources resources = {&s->work, IP_ITERATIONS};
    return rti_feedback(&s->component.rti, &resources);
}
int shift(struct rti *work) { rti_shift(work); return SOLVED; }
int slope(struct rti *work) { rti_gradient(work); return SOLVED; }
int linearise(struct rti *work) { dynamics(work, 0, N); return SOLVED; }
int optimise(struct workspace *s)
{
    struct solver_resources resources = {&s->work, IP_ITERATIONS};
    s->component.rti.qp.factored = 0;
    return qp_optimise(&s->component.rti.qp, &resources);
}
"""
WINDOW_PHASES = """
int restart(struct component *component, const double *prior)
{
    return window_restart(&component->window, &component->rti, prior);
}
int slide(struct component *component) { return window_slide(&component->window, &component->rti); }
"""
BARE = "struct component { struct rti rti; };\n#define COMPONENT_FIELDS"
BARE_WINDOW = """struct component { struct rti rti; struct window window; };
#define COMPONENT_FIELDS WINDOW_FIELDS(component, window.)"""

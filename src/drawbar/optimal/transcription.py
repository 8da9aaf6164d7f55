"""Multiple shooting: from a problem declaration to the C source of its solver."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Self

import casadi as ca

from drawbar.codegen.emit import Input, Output, emit, emit_constants, emit_indices
from drawbar.optimal.problem import Bound, ControlProblem, EstimationProblem
from drawbar.vehicle.model import Constant, column, constant, runge_kutta, with_values

LEVENBERG = 1e-9
"""Added to the Hessian of every input: what no output sees (a missing steering sensor, say) stays where it is."""
CONTROL_ITERATIONS, ESTIMATION_ITERATIONS = 25, 8
"""Most iterations of the interior point in one feedback. In the robustness experiment's runs of the product (seeds 0 to
2) an answer passed the check after 23 at most in a controller, and after 2 in the estimator."""

_WORK = "struct rti *work"
_ROWS = f"const {_WORK}, double (*rows)[OLD_WIDTH]"
_UNIT = """
#define N {horizon}
#define NX {states}
#define NU {inputs}
#define NP {parameters}
#define NY {outputs}
#define NB {bounds}
#define NC {constant_states}
#define CONSTANTS {constants}
#define CROSS {cross}
#define FREE_INITIAL {free}
#define IP_ITERATIONS {iterations}
#include "{header}"
{functions}
{names}{component}
"""
SOLVER_FIELDS = """
    {"rti.x", offsetof(struct component, rti.z), 0, {N + 1, NX, 0}, 0, 0},
    {"rti.u", offsetof(struct component, rti.z) + sizeof(double) * (N + 1) * NX, 0, {N, NU, 0}, 0, 0},
    RTI(p, 0, N + 1, NP > 0 ? NP : EMPTY, 0) RTI(y, 0, N + 1, NY, 0) SET(w, N + 1, NY)
    SET(constants, CONSTANTS, 0) RTI(initial, 0, NX, 0, 0) SET(lower, NB, 0) SET(upper, NB, 0) SET(root, NX, NX)
    RTI(prior, 0, NX, 0, 0) SET(process, NX, 0) SET(common, NX, 0) RTI(status, 1, 1, 0, 0)
    QP_FIELDS(component, rti.qp.)"""
"""entries of the table of fields (fields.h)"""
_TABLE = """
#include "workspace.h"
const struct drawbar_field drawbar_fields[] = {%s COMPONENT_FIELDS END_OF_FIELDS};
"""
_PHASES = """
int lay_down(struct rti *work) { rti_constants(work); return SOLVED; }
int prepare(struct rti *work) { return rti_prepare(work); }
int feedback(struct workspace *s) { return rti_feedback(&s->component.rti, &s->work); }
int shift(struct rti *work) { rti_shift(work); return SOLVED; }
int linearise(struct rti *work) { dynamics(work, 0, N); return SOLVED; }
int optimise(struct workspace *s)
{
    s->component.rti.qp.factored = 0;
    return qp_optimise(&s->component.rti.qp, &s->work);
}
"""
_WINDOW_PHASES = """
int restart(struct component *component, const double *prior)
{
    return window_restart(&component->window, &component->rti, prior);
}
int slide(struct component *component) { return window_slide(&component->window, &component->rti); }
"""
_BARE = "struct component { struct rti rti; };\n#define COMPONENT_FIELDS"
_BARE_WINDOW = """struct component { struct rti rti; struct window window; };
#define COMPONENT_FIELDS WINDOW_FIELDS(component, window.)"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Transcription:
    """A discretised problem: F(x, u, p) and h(x, u, p), its constants, its sizes and its bounded variables."""

    name: str
    horizon: int
    x: Any
    u: Any
    p: Any
    next_state: Any
    """(nx, 1) SX: F(x, u, p)"""
    output: Any
    """(ny, 1) SX: h(x, u, p)"""
    constants: tuple[Constant, ...]
    """of the model, and the sample time: data of F and h"""
    constant_states: int
    """trailing states that do not change"""
    free_initial: bool
    """the first state is a variable"""
    arrival: bool
    """its cost sums up what the window has left behind"""
    bounds: tuple[tuple[int, Bound], ...]
    """(index into x_0 .. x_N, u_0 .. u_{N-1}; bound)"""
    names: Mapping[str, tuple[str, ...]]
    """what the elements of x, u, p and output are called, by the letters X, U, P and Y"""

    @property
    def input_outputs(self) -> tuple[bool, ...]:
        """Which outputs depend on an input, and so have no value at stage N."""
        return tuple(ca.which_depends(self.output, self.u, 1, True))

    @property
    def crosses(self) -> bool:
        """Whether an output depends on states and inputs, so that the cost has products of them."""
        states, inputs = (ca.jacobian(self.output, variables) for variables in (self.x, self.u))
        return bool(ca.mtimes(inputs.T, states).nnz())

    def numeric(self) -> Self:
        """Return the problem with the values of its constants in F and h."""
        step, output = with_values([self.next_state, self.output], self.constants)
        return replace(self, next_state=step, output=output, constants=())

    def source(self, component: str = "") -> str:
        """Return the C unit of this problem's solver.

        component: header that makes the solver a component of the autopilot. It defines `struct component`, which
            begins with the solver (an estimator's with solver and window), and its COMPONENT_FIELDS; empty: the
            solver is all there is.
        """
        nx, nu = self.x.numel(), self.u.numel()
        return _UNIT.format(
            horizon=self.horizon,
            states=nx,
            inputs=nu,
            parameters=self.p.numel(),
            outputs=self.output.numel(),
            bounds=len(self.bounds),
            constant_states=self.constant_states,
            constants=len(self.constants),
            cross=int(self.crosses),
            free=int(self.free_initial),
            iterations=ESTIMATION_ITERATIONS if self.arrival else CONTROL_ITERATIONS,
            header="window.h" if self.arrival else "rti.h",
            functions=self._functions(),
            names=self.indices() if component else "",
            component=f'#include "{component}"' if component else _BARE_WINDOW if self.arrival else _BARE,
        )

    def indices(self) -> str:
        """Return C enumerations of the indices into x, u, p and output: X_SPEED, for one."""
        return emit_indices(self.names)

    def introspection(self) -> str:
        """Return what a caller in another language needs besides the unit: fields by name, the solver's phases."""
        return _TABLE % SOLVER_FIELDS + _PHASES + (_WINDOW_PHASES if self.arrival else "")

    def _functions(self) -> str:
        nx = self.x.numel()
        moving = nx - self.constant_states
        w, y = (ca.SX.sym(name, self.output.numel()) for name in ("w", "y"))
        z = ca.vertcat(self.x, self.u)
        slope = ca.jacobian(self.next_state, z)
        jacobian = ca.jacobian(self.output, z)
        curvature = ca.mtimes([jacobian.T, ca.diag(w), jacobian])
        residual = ca.mtimes(jacobian.T, w * (self.output - y))
        inputs = [
            Input(place="STATE(work->z, {k})[{i}]", rows="(N + 1)", symbol=self.x),
            Input(place="INPUT(work->z, {k})[{i}]", rows="N", symbol=self.u),
            Input(place="work->p[{k}][{i}]", rows="(N + 1)", symbol=self.p),
            Input(place="rti_weight(work, {k}, {i})", rows="(N + 1)", symbol=w),
            Input(place="rti_target(work, {k}, {i})", rows="(N + 1)", symbol=y),
            Input(place="work->constants[{i}]", rows="", symbol=column(self.constants)),
        ]
        damping = LEVENBERG * ca.SX.eye(self.u.numel())
        step, slope = ca.cse([self.next_state, slope])
        functions = {
            "dynamics": [
                Output(place="work->qp.c[k]", rows="N", value=step),
                Output(place="((double *)work->qp.A[k])", rows="N", value=slope[:moving, :nx], stride="WIDTH"),
                Output(place="((double *)work->qp.B[k])", rows="N", value=slope[:moving, nx:]),
            ],
            "hessian": [
                Output(
                    place="((double *)work->qp.Q[k])",
                    rows="(N + 1)",
                    value=curvature[:nx, :nx],
                    stride="WIDTH",
                ),
                Output(place="((double *)work->qp.S[k])", rows="N", value=curvature[nx:, :nx], stride="WIDTH"),
                Output(place="((double *)work->qp.R[k])", rows="N", value=curvature[nx:, nx:] + damping),
            ],
            "gradient": [
                Output(place="STATE(work->qp.g, k)", rows="(N + 1)", value=residual[:nx]),
                Output(place="INPUT(work->qp.g, k)", rows="N", value=residual[nx:]),
            ],
        }
        every = [output for outputs in functions.values() for output in outputs]
        text = emit_constants("rti_constants", inputs, every, _WORK) + "".join(
            emit(name, inputs, outputs, _WORK) for name, outputs in functions.items()
        )
        if self.arrival:
            measured = [
                Output(place="((double *)rows)", rows="1", value=jacobian, stride="OLD_WIDTH"),
                Output(place="((double *)rows + OLD - 1)", rows="1", value=self.output, stride="OLD_WIDTH"),
            ]
            text += emit_constants("output_constants", inputs, measured, _ROWS)
            text += emit("outputs", inputs, measured, _ROWS)
        return text


def transcribe(problem: ControlProblem | EstimationProblem) -> Transcription:
    """Return the problem discretised by Runge-Kutta 4 over each sample."""
    model, estimation = problem.model, isinstance(problem, EstimationProblem)
    sample_time = constant("sample_time", "s", problem.sample_time)
    step = runge_kutta(model, sample_time.symbol, problem.integration_steps)
    names = model.names
    if estimation:
        names |= {"X": (*names["X"], *names["P"]), "P": ()}
    constant_states = len(model.parameters) if estimation else 0
    return Transcription(
        name=model.name,
        horizon=problem.horizon,
        x=ca.vertcat(model.x, model.p) if estimation else model.x,
        u=model.u,
        p=ca.SX(0, 1) if estimation else model.p,
        next_state=ca.vertcat(step, model.p) if estimation else step,
        output=model.output,
        constants=(*model.constants, sample_time),
        constant_states=constant_states,
        free_initial=isinstance(problem, EstimationProblem) or bool(problem.initial_weights),
        arrival=estimation,
        bounds=tuple(_bounded(problem, names["X"], names["U"], constant_states)),
        names=names,
    )


def _bounded(
    problem: ControlProblem | EstimationProblem,
    states: tuple[str, ...],
    inputs: tuple[str, ...],
    constant_states: int,
) -> list[tuple[int, Bound]]:
    """Return the bounded scalars: constant states only once, a given first state not at all.

    A controller's free first state comes before all others, with bounds of its own that are not known yet.
    """
    horizon, nx, nu = problem.horizon, len(states), len(inputs)
    first, found = 0, []
    if isinstance(problem, ControlProblem):
        first = 1
        found = [(j, Bound(lower=-math.inf, upper=math.inf)) for j in range(len(problem.initial_weights))]
    for j, name in enumerate(states):
        if name in problem.bounds:
            stages = range(first, horizon + 1) if j < nx - constant_states else range(1)
            found += [(k * nx + j, problem.bounds[name]) for k in stages]
    for a, name in enumerate(inputs):
        if name in problem.bounds:
            start = (horizon + 1) * nx + a
            found += [(start + k * nu, problem.bounds[name]) for k in range(horizon)]
    return found

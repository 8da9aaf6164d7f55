"""Solver's source: a transcribed problem as C, its functions at every stage included."""

import casadi as ca

from drawbar.codegen.emit import Output, emit, emit_constants
from drawbar.codegen.statements import Input
from drawbar.optimal.adaptive import way_of
from drawbar.optimal.frame import (
    BARE,
    BARE_WINDOW,
    PHASES,
    ROWS,
    SOLVER_FIELDS,
    TABLE,
    UNIT,
    WINDOW_PHASES,
    WORK,
)
from drawbar.optimal.given import LARGEST_INPUT
from drawbar.optimal.transcription import Transcription
from drawbar.vehicle.model import column

LEVENBERG = 1e-9
"""Added to the Hessian of every input: what no output sees (a missing steering sensor) stays where it is."""


def solver_source(t: Transcription, component: str = "") -> str:
    """Return the C unit of a problem's solver.

    Args:
        t: the transcribed problem.
        component: header that makes the solver a component of the autopilot. It defines `struct component`, which
            begins with the solver (an estimator's with solver and window), and its COMPONENT_FIELDS; empty: the
            solver is all there is.
    """
    return UNIT.format(
        horizon=t.intervals,
        held="" if t.held == 1 else f"#define INTERVALS {t.held}\n",
        states=t.x.numel(),
        inputs=t.u.numel(),
        parameters=t.p.numel(),
        outputs=t.output.numel(),
        bounds=len(t.bounds),
        still_states=t.still_states,
        constant_states=t.constant_states,
        constants=len(t.constants),
        cross=int(t.crosses),
        free=int(t.free_initial),
        leaving=int(t.arrival),
        added=int(t.added),
        columns=int(not t.uncoupled),
        iterations=t.iterations,
        largest=LARGEST_INPUT,
        header="window.h" if t.arrival else "rti.h",
        functions=_functions(t),
        names=t.indices() if component else "",
        component=f'#include "{component}"' if component else BARE_WINDOW if t.arrival else BARE,
    )


def introspection(t: Transcription) -> str:
    """Return what a caller in another language needs besides the unit: fields by name, the solver's phases."""
    return TABLE % SOLVER_FIELDS + PHASES + (WINDOW_PHASES if t.arrival else "")


def _functions(t: Transcription) -> str:
    """Return C: rti_constants, dynamics, hessian, gradient, and what an estimator has besides."""
    w, y = (ca.SX.sym(name, t.output.numel()) for name in ("w", "y"))
    z = ca.vertcat(t.x, t.u)
    jacobian = ca.jacobian(t.output, z)
    inputs = _inputs(t, w, y)
    slope, way = ca.jacobian(t.next_state, z), way_of(t.attempt, z) if t.attempt else None
    if way:
        slope += ca.mtimes(ca.jacobian(t.next_state, way.attempt.x), way.slope)
        inputs.append(way.read)
    costs = _costs(t, jacobian, w, y)
    dynamics = _dynamics(t, *ca.cse([t.next_state, slope]))
    every = [*dynamics, *(output for outputs in costs.values() for output in outputs)]
    text = emit_constants("rti_constants", inputs, every, WORK)
    text += way.text(inputs, dynamics) if way else emit("dynamics", inputs, dynamics, WORK)
    text += "".join(emit(name, inputs, outputs, WORK) for name, outputs in costs.items())
    if t.arrival:
        measured = [
            Output(place="((double *)rows)", rows="1", value=ca.horzcat(jacobian, t.output), stride="OLD_WIDTH")
        ]
        text += emit_constants("output_constants", inputs, measured, ROWS)
        text += emit("outputs", inputs, measured, ROWS)
    return text


def _inputs(t: Transcription, w: ca.SX, y: ca.SX) -> list[Input]:
    """Return what the functions read at a stage: trajectory, parameters, weights w and targets y (ny,), constants."""
    return [
        Input(place="STATE(work->z, {k})[{i}]", rows="(N + 1)", symbol=t.x),
        Input(place="INPUT(work->z, {k})[{i}]", rows="N", symbol=t.u),
        Input(place="work->p[{k}][{i}]", rows="(N + 1)", symbol=t.p),
        Input(place="work->p[{k} + 1][{i}]", rows="N", symbol=t.p_next),
        Input(place="rti_weight(work, {k}, {i})", rows="(N + 1)", symbol=w),
        Input(place="rti_target(work, {k}, {i})", rows="(N + 1)", symbol=y),
        Input(place="work->constants[{i}]", rows="", symbol=column(t.constants)),
        Input(place="({k}) % INTERVALS == 0", rows="N", symbol=t.begins),
    ]


def _costs(t: Transcription, jacobian: ca.SX, w: ca.SX, y: ca.SX) -> dict[str, list[Output]]:
    """Return the Gauss-Newton Hessian J' W J and the gradient J' W (h - y) of every stage, J (ny, nx + nu)."""
    nx = t.x.numel()
    hessian = ca.mtimes([jacobian.T, ca.diag(w), jacobian])
    gradient = ca.mtimes(jacobian.T, w * (t.output - y))
    damping = LEVENBERG * ca.SX.eye(t.u.numel())
    return {
        "hessian": [
            Output(place="((double *)work->qp.Q[k])", rows="(N + 1)", value=hessian[:nx, :nx], stride="WIDTH"),
            Output(place="((double *)work->qp.S[k])", rows="N", value=hessian[nx:, :nx], stride="WIDTH"),
            Output(place="((double *)work->qp.R[k])", rows="N", value=hessian[nx:, nx:] + damping),
        ],
        "gradient": [
            Output(place="STATE(work->qp.g, k)", rows="(N + 1)", value=gradient[:nx]),
            Output(place="INPUT(work->qp.g, k)", rows="N", value=gradient[nx:]),
        ],
    }


def _dynamics(t: Transcription, step: ca.SX, slope: ca.SX) -> list[Output]:
    """Return F, A and B of every stage; constant states have no rows in A and B."""
    nx, moving, rows = t.x.numel(), t.x.numel() - t.constant_states, "(N + LEAVING)"
    A, B = (f"((double *)work->qp.{name}[PLACE(work, k)])" for name in "AB")
    return [
        Output(place="work->qp.c[PLACE(work, k)]", rows=rows, value=step),
        Output(place=A, rows=rows, value=slope[:moving, :nx], stride="WIDTH"),
        Output(place=B, rows=rows, value=slope[:moving, nx:]),
    ]

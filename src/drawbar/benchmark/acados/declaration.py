"""Declaration of a problem of drawbar for acados: multiple shooting, Gauss-Newton, equal steps and bounds."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from drawbar.errors import DrawbarError
from drawbar.geometry import Floats
from drawbar.optimal.bound import Bound
from drawbar.optimal.transcription import Transcription
from drawbar.vehicle.model import with_values

_FLAGS = "-O3 -march=native"
"""of acados' generated functions"""
_ITERATIONS = 200
"""most of a quadratic program: an active set that begins empty needs more than the 50 of an interior point"""


@dataclass(frozen=True, slots=True, kw_only=True)
class QpSolver:
    """How acados solves its quadratic program."""

    name: str
    acados: str
    """its name there"""
    share: float = 1.0
    """of the stages that partial condensing leaves"""
    mode: str = "SPEED"
    """of HPIPM; SPEED_ABS is faster, and without condensing loses solutions where bounds are soft"""


QP_SOLVERS = (
    QpSolver(name="HPIPM", acados="PARTIAL_CONDENSING_HPIPM"),
    QpSolver(name="HPIPM, a third of the stages", acados="PARTIAL_CONDENSING_HPIPM", share=1.0 / 3.0),
    QpSolver(name="HPIPM, condensed", acados="FULL_CONDENSING_HPIPM"),
    QpSolver(name="HPIPM, condensed, absolute", acados="FULL_CONDENSING_HPIPM", mode="SPEED_ABS"),
    QpSolver(name="qpOASES, condensed", acados="FULL_CONDENSING_QPOASES"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Places:
    """Where the bounds of stages stand in the solver's `lower` and `upper`, in the order of the bounded variables."""

    states: dict[int, list[int]]
    inputs: dict[int, list[int]]


def places(transcription: Transcription) -> Places:
    """Return the rows of bounds by stage."""
    nx, nu = transcription.x.numel(), transcription.u.numel()
    first = (transcription.intervals + 1) * nx
    states, inputs = defaultdict[int, list[tuple[int, int]]](list), defaultdict[int, list[tuple[int, int]]](list)
    for row, (index, _) in enumerate(transcription.bounds):
        if index < first:
            states[index // nx].append((index % nx, row))
        else:
            inputs[(index - first) // nu].append(((index - first) % nu, row))
    return Places(states=_rows(states), inputs=_rows(inputs))


def _rows(found: dict[int, list[tuple[int, int]]]) -> dict[int, list[int]]:
    return {stage: [row for _, row in sorted(each)] for stage, each in found.items()}


def varying(transcription: Transcription, values: Floats) -> list[int]:
    """Return which constants of the model a run has changed: acados takes them for parameters of the stages."""
    return [i for i, each in enumerate(transcription.constants) if values[i] != each.value]


def declared(
    template: Any, transcription: Transcription, changed: Sequence[int], name: str, qp_solver: QpSolver
) -> Any:
    """Return the AcadosOcp; data that changes from sample to sample is zero, or open.

    Args:
        template: the module `acados_template`.
        transcription: of the problem.
        changed: the constants that the run changes.
        name: of the generated library; each needs its own.
        qp_solver: that solves the quadratic program.

    Raises:
        DrawbarError: the problem has something that is not declared here: adaptive integration, or several intervals
            in a sample.
    """
    if transcription.attempt is not None or transcription.held > 1:
        raise DrawbarError(f"{transcription.name}: acados is compared on problems with one equal step a sample only")
    constants = transcription.constants
    fixed = tuple(each for i, each in enumerate(constants) if i not in changed)
    step, output = with_values([transcription.next_state, transcription.output], fixed)
    p = ca.vertcat(transcription.p, *(constants[i].symbol for i in changed))
    t = replace(transcription, next_state=step, output=output, p=p, constants=())
    model, ocp = template.AcadosModel(), template.AcadosOcp()
    model.name, model.x, model.u, model.p, model.disc_dyn_expr = name, t.x, t.u, t.p, t.next_state
    ocp.model, ocp.dims.N, ocp.parameter_values = model, t.intervals, np.zeros(t.p.numel())
    _declare_cost(ocp, t)
    _declare_bounds(ocp, t)
    options = ocp.solver_options
    options.tf = float(t.intervals)  # acados weighs a stage by its time
    options.integrator_type, options.nlp_solver_type, options.hessian_approx = "DISCRETE", "SQP_RTI", "GAUSS_NEWTON"
    options.qp_solver, options.hpipm_mode, options.ext_fun_compile_flags = qp_solver.acados, qp_solver.mode, _FLAGS
    options.qp_solver_iter_max = _ITERATIONS
    options.qp_solver_cond_N = max(round(qp_solver.share * t.intervals), 1)
    return ocp


def _declare_cost(ocp: Any, t: Transcription) -> None:
    """Least squares; linear ones where the outputs are linear; a free first state is an output of the first stage."""
    last = ca.vertcat(*(row for row, on_input in zip(_split(t.output), t.input_outputs, strict=True) if not on_input))
    first = ca.vertcat(t.output, t.x) if t.free_initial else t.output
    for suffix, output in (("_0", first), ("", t.output), ("_e", last)):
        size = output.numel()
        setattr(ocp.cost, f"W{suffix}", np.eye(size))
        setattr(ocp.cost, f"yref{suffix}", np.zeros(size))
        matrices = _linear(output, t)
        setattr(ocp.cost, f"cost_type{suffix}", "NONLINEAR_LS" if matrices is None else "LINEAR_LS")
        if matrices is None:
            setattr(ocp.model, f"cost_y_expr{suffix}", output)
            continue
        setattr(ocp.cost, f"Vx{suffix}", matrices[0])
        if suffix != "_e":
            setattr(ocp.cost, f"Vu{suffix}", matrices[1])


def _split(column: Any) -> list[Any]:
    return [column[i] for i in range(column.numel())]


def _linear(output: Any, t: Transcription) -> tuple[Any, Any] | None:
    """Return the matrices of outputs that are linear in states and inputs, without a constant."""
    variables = ca.vertcat(t.x, t.u)
    slope = ca.jacobian(output, variables)
    if ca.symvar(slope):
        return None
    rest = ca.substitute(output, variables, ca.SX.zeros(variables.numel()))
    if ca.symvar(rest) or np.any(ca.DM(rest).full()):
        return None
    matrix = ca.DM(slope).full()
    return matrix[:, : t.x.numel()], matrix[:, t.x.numel() :]


def _declare_bounds(ocp: Any, t: Transcription) -> None:
    nx, nu = t.x.numel(), t.u.numel()
    start = (t.intervals + 1) * nx
    bounds = dict(t.bounds)
    inputs = [j for j in range(nu) if start + j in bounds]
    _set(ocp.constraints, "u", inputs)
    for suffix, stage in (("_0", 0), ("", 1), ("_e", t.intervals)):
        states = [j for j in range(nx) if stage * nx + j in bounds]
        _set(ocp.constraints, "x", states, suffix)
        if stage > 0:
            _soften(ocp, [bounds[stage * nx + j] for j in states], suffix)
    if not t.free_initial:
        ocp.constraints.x0 = np.zeros(nx)


def _set(constraints: Any, letter: str, variables: list[int], suffix: str = "") -> None:
    """Bound variables of a stage by something; each sample brings its own bounds."""
    if not variables:
        return
    setattr(constraints, f"idxb{letter}{suffix}", np.array(variables))
    setattr(constraints, f"lb{letter}{suffix}", np.full(len(variables), -1.0))
    setattr(constraints, f"ub{letter}{suffix}", np.full(len(variables), 1.0))


def _soften(ocp: Any, bounds: list[Bound], suffix: str) -> None:
    soft = [i for i, bound in enumerate(bounds) if np.isfinite(bound.linear_penalty)]
    if not soft:
        return
    setattr(ocp.constraints, f"idxsbx{suffix}", np.array(soft))
    linear, quadratic = (
        np.array([getattr(bounds[i], name) for i in soft]) for name in ("linear_penalty", "quadratic_penalty")
    )
    for side in ("l", "u"):
        setattr(ocp.cost, f"z{side}{suffix}", linear)
        setattr(ocp.cost, f"Z{side}{suffix}", quadratic)

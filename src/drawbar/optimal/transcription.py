"""Transcription by multiple shooting: from a problem declaration to what its solver is made of."""

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Self

import casadi as ca

from drawbar.codegen.emit import emit_indices
from drawbar.optimal.augmentation import Augmentation, augment, change_name
from drawbar.optimal.bound import Bound
from drawbar.optimal.problem import ControlProblem, EstimationProblem
from drawbar.vehicle.integrators import Attempt, Integrator, attempt, discretise
from drawbar.vehicle.model import Constant, by_name, constant, with_values

CONTROL_ITERATIONS, ESTIMATION_ITERATIONS, CONSTRAINED_ITERATIONS = 25, 8, 80
"""Most iterations of the interior point in one feedback; the solvers of a step share fewer (ITERATIONS of
step/build.py). Bounds on outputs and changes of inputs have as many as a quadratic program by itself."""
STANDARD_HORIZON, LONG_ITERATIONS = 20, 40
"""Samples; and as many in a controller that plans further ahead, where more bounds are active."""


def control_iterations(horizon: float) -> int:
    """Return the most iterations of a controller's interior point in one feedback, by its horizon in samples."""
    return CONTROL_ITERATIONS if horizon <= STANDARD_HORIZON else LONG_ITERATIONS


@dataclass(frozen=True, slots=True, kw_only=True)
class Transcription:
    """A discretised problem: F(x, u, p) and h(x, u, p), its constants, its sizes and its bounded variables."""

    name: str
    intervals: int
    """M, shooting intervals in the horizon"""
    held: int
    """shooting intervals over which an input is held: those of a sample"""
    begins: Any
    """(1, 1) SX symbol where held > 1: 1 in a sample's first interval, else 0; (0, 1) elsewhere"""
    x: Any
    u: Any
    p: Any
    p_next: Any
    """the parameters of the next stage"""
    next_state: Any
    """(nx, 1) SX: F(x, u, p) over one shooting interval; bounded outputs behind it depend on p_next as well; where the
    integrator is adaptive, the model's rows are the state that its attempts carry on"""
    output: Any
    """(ny, 1) SX: h(x, u, p)"""
    constants: tuple[Constant, ...]
    """of the model, and the sample time: data of F and h"""
    attempt: Attempt | None
    """of an adaptive integrator, in x, u, p and symbols of its own"""
    constant_states: int
    """trailing states that do not change"""
    free_initial: bool
    """the first state is a variable"""
    added: bool
    """there are states besides the model's and the parameters: bounds on outputs, inputs before"""
    arrival: bool
    """its cost sums up what the window has left behind"""
    bounded: tuple[tuple[str, range, Bound], ...]
    """(name, indices into x_0 .. x_M, u_0 .. u_{M-1}; bound), in the order of the solver's `lower` and `upper`; a free
    first state has no name"""
    names: Mapping[str, tuple[str, ...]]
    """what the elements of x, u, p and output are called, by the letters X, U, P and Y"""

    @property
    def bounds(self) -> tuple[tuple[int, Bound], ...]:
        """(index into x_0 .. x_M, u_0 .. u_{M-1}; bound) of every bounded variable."""
        return tuple((index, bound) for _, indices, bound in self.bounded for index in indices)

    @property
    def places(self) -> dict[str, slice]:
        """Where the stages of each bounded name stand in the solver's `lower` and `upper`."""
        first, found = 0, {}
        for name, indices, _ in self.bounded:
            found[name] = slice(first, first + len(indices))
            first += len(indices)
        found.pop("", None)
        return found

    @property
    def iterations(self) -> int:
        """Most iterations of the interior point in one feedback."""
        if self.arrival:
            return ESTIMATION_ITERATIONS
        return CONSTRAINED_ITERATIONS if self.added else control_iterations(self.intervals / self.held)

    @property
    def input_outputs(self) -> tuple[bool, ...]:
        """Which outputs depend on an input, and so have no value at stage M."""
        return tuple(ca.which_depends(self.output, self.u, 1, True))

    @property
    def crosses(self) -> bool:
        """Whether an output depends on states and inputs, so that the cost has products of them."""
        states, inputs = (ca.jacobian(self.output, variables) for variables in (self.x, self.u))
        return bool(ca.mtimes(inputs.T, states).nnz())

    @property
    def uncoupled(self) -> bool:
        """Whether no bound is coupled: each is on an input, or on a state that one input alone moves.

        As projected Newton (solver/projected_newton.h) needs it.
        """
        if self.free_initial or self.attempt is not None:
            return False
        moved = Counter(ca.jacobian(self.next_state, self.u).sparsity().row())
        nx = self.x.numel()
        inputs = (self.intervals + 1) * nx
        return all(index >= inputs or (index >= nx and moved[index % nx] == 1) for index, _ in self.bounds)

    @property
    def still_states(self) -> int:
        """Trailing states that only inputs move, constant ones included: their rows of dF/dx are the identity's."""
        rest = ca.jacobian(self.next_state, self.x) - ca.SX.eye(self.x.numel())
        moving = set(ca.sparsify(ca.simplify(rest)).sparsity().get_triplet()[0])
        return int(self.x.numel() - 1 - max(moving, default=-1))

    def numeric(self) -> Self:
        """Return the problem with the values of its constants in F and h."""
        step, output = with_values([self.next_state, self.output], self.constants)
        return replace(self, next_state=step, output=output, constants=())

    def indices(self) -> str:
        """Return C enumerations of the indices into x, u, p and output: X_SPEED, for one."""
        return emit_indices(self.names)


def transcribe(problem: ControlProblem | EstimationProblem) -> Transcription:
    """Return the problem discretised by its integrator over each shooting interval."""
    model = problem.model
    sample_time = constant("sample_time", "s", problem.sample_time)
    tolerance = constant("integration_tolerance", "1", problem.integration_tolerance)
    held = 1 if isinstance(problem, EstimationProblem) else problem.intervals_per_sample
    adaptive = problem.integrator == Integrator.ADAPTIVE
    interval, steps = sample_time.symbol / held, problem.integration_steps
    tried = attempt(model, interval, tolerance.symbol, steps) if adaptive else None
    step = tried.x if tried else discretise(model, interval, steps, problem.integrator)
    constants = (*model.constants, sample_time, *([tolerance] if adaptive else []))
    if isinstance(problem, EstimationProblem):
        return _estimation(problem, step, tried, constants)
    return _control(problem, step, tried, constants)


def _estimation(
    problem: EstimationProblem, step: Any, tried: Attempt | None, constants: tuple[Constant, ...]
) -> Transcription:
    """Let the parameters be states that do not change."""
    model, horizon, known = problem.model, problem.horizon, by_name(problem.model.parameters, problem.model.p)
    x = ca.vertcat(model.x, model.p)
    replaced = ca.vertcat(*(known[name] for name in problem.acting))
    step = ca.substitute(step, replaced, ca.vertcat(*problem.acting.values())) if problem.acting else step
    names = model.names | {"X": (*model.names["X"], *model.names["P"]), "P": ()}
    nx, moving = x.numel(), model.x.numel()
    states = [
        (name, range(j, (horizon + 1) * nx if j < moving else j + 1, nx), problem.bounds[name])
        for j, name in enumerate(names["X"])
        if name in problem.bounds
    ]
    return Transcription(
        name=model.name,
        intervals=horizon,
        held=1,
        begins=ca.SX(0, 1),
        x=x,
        u=model.u,
        p=ca.SX(0, 1),
        p_next=ca.SX(0, 1),
        next_state=ca.vertcat(step, model.p),
        output=model.output,
        constants=constants,
        attempt=tried,
        constant_states=nx - moving,
        free_initial=True,
        added=False,
        arrival=True,
        bounded=(*states, *_bounded_inputs(problem, (horizon + 1) * nx)),
        names=names,
    )


def _control(
    problem: ControlProblem, step: Any, tried: Attempt | None, constants: tuple[Constant, ...]
) -> Transcription:
    """Add the states of output bounds and of changes; a free first state is bounded before all others."""
    model, held = problem.model, problem.intervals_per_sample
    intervals = problem.horizon * held
    p_next = ca.SX.sym("p_next", model.p.numel())
    added = augment(problem, step, p_next)
    x = ca.vertcat(model.x, added.x)
    nx, free = x.numel(), len(problem.initial_weights)
    first = [("", range(free), Bound(lower=-math.inf, upper=math.inf))] if free else []
    next_state, output = ca.vertcat(step, added.next_state), ca.vertcat(model.output, added.output)
    if held > 1:
        next_state, output = ca.substitute([next_state, output], [model.u], [added.applied])
        tried = tried.with_input(model.u, added.applied) if tried else None
    return Transcription(
        name=model.name,
        intervals=intervals,
        held=held,
        begins=added.begins,
        x=x,
        u=model.u,
        p=model.p,
        p_next=p_next,
        next_state=next_state,
        output=output,
        constants=constants,
        attempt=tried,
        constant_states=0,
        free_initial=bool(free),
        added=bool(added.states),
        arrival=False,
        bounded=(
            *first,
            *_bounded_states(problem, added, nx),
            *_bounded_inputs(problem, (intervals + 1) * nx, held),
        ),
        names=_extended(model.names, added),
    )


def _bounded_states(problem: ControlProblem, added: Augmentation, nx: int) -> list[tuple[str, range, Bound]]:
    """Return name, places and bound of every bounded state behind the first stage; a change counts once a sample."""
    held, changes = problem.intervals_per_sample, {change_name(name) for name in problem.change_bounds}
    own = problem.model.states
    columns = [(j, each.name, problem.bounds.get(each.name)) for j, each in enumerate(own)]
    columns += [(len(own) + j, name, bound) for j, name, bound in added.bounds]
    end = (problem.horizon * held + 1) * nx
    return [
        (name, range(nx + j, end, nx * (held if name in changes else 1)), bound) for j, name, bound in columns if bound
    ]


def _extended(names: Mapping[str, tuple[str, ...]], added: Augmentation) -> dict[str, tuple[str, ...]]:
    return {**names, "X": (*names["X"], *added.states), "Y": (*names["Y"], *added.outputs)}


def _bounded_inputs(
    problem: ControlProblem | EstimationProblem, start: int, held: int = 1
) -> list[tuple[str, range, Bound]]:
    """Return the bounded inputs, which stand behind all states; those of a sample's first interval are applied."""
    nu = len(problem.model.inputs)
    return [
        (each.name, range(start + a, start + problem.horizon * held * nu, held * nu), problem.bounds[each.name])
        for a, each in enumerate(problem.model.inputs)
        if each.name in problem.bounds
    ]

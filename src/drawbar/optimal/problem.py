"""Optimal control and estimation problems as plain data."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from numbers import Integral, Real
from typing import Any

import casadi as ca

from drawbar.errors import SolverError, demand
from drawbar.vehicle.integrators import Integrator
from drawbar.vehicle.model import Model, Variable

LONGEST_HORIZON, MOST_INTERVALS = 10_000, 100
"""samples of a horizon, and integration steps in an interval; shooting intervals in a sample: code and memory grow with
them"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bound:
    """lower <= variable <= upper at every stage; hard unless a penalty is given."""

    lower: float
    upper: float
    linear_penalty: float = math.inf
    """cost of a violation, per unit, beside half the sum of squares; infinite: the bound is hard; zero: the bound gives
    way as far as the quadratic penalty lets it"""
    quadratic_penalty: float = 0.0
    """cost of a violation, per unit squared (half of it, as in 1/2 q v²)"""

    def __post_init__(self) -> None:
        _check_numbers(
            "A bound",
            lower=self.lower,
            upper=self.upper,
            linear_penalty=self.linear_penalty,
            quadratic_penalty=self.quadratic_penalty,
        )
        if not self.lower <= self.upper:
            raise SolverError(
                f"A bound needs lower <= upper, got lower = {self.lower} and upper = {self.upper}; give two numbers "
                f"in this order, infinite where there is no bound."
            )
        if self.lower == math.inf or self.upper == -math.inf:
            raise SolverError(
                f"A bound needs lower < infinity and upper > -infinity, got lower = {self.lower} and upper = "
                f"{self.upper}: no number lies between; give a finite one, or exchange the signs."
            )
        if not (self.linear_penalty >= 0.0 and 0.0 <= self.quadratic_penalty < math.inf):
            raise SolverError(
                f"A bound needs linear_penalty >= 0 (infinite: hard) and a finite quadratic_penalty >= 0, got "
                f"{self.linear_penalty} and {self.quadratic_penalty}."
            )
        if self.linear_penalty + self.quadratic_penalty == 0.0:
            raise SolverError(
                "A bound needs a linear_penalty or a quadratic_penalty above 0, got 0 for both: it would bound "
                "nothing; leave it out, or give one."
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlProblem:
    """min over u of the sum over stages of ||h(x,u,p) - y||²_W from a given state, by multiple shooting.

    The stages 0..M are the shooting nodes, M = N intervals_per_sample. Inputs are held over a sample, however
    many nodes it has.

    Any function of states, inputs and parameters can be bounded: make it an output of the model, with a weight of 0.0
    if it shall not count otherwise.

    Weights and bounds go by name. Every weight has to be given, 0.0 where an output shall not count: a name that is
    forgotten or misspelt is refused. Raises SolverError when the problem contradicts itself.
    """

    model: Model
    horizon: int
    """N, samples"""
    sample_time: float
    """s"""
    weights: Mapping[str, float]
    """by name of an output, all of them; on stages 0..M-1, divided by intervals_per_sample on each"""
    terminal_weights: Mapping[str, float]
    """by name of an output, on stage M; outputs that depend on an input have no value there and are left out, or 0.0"""
    bounds: Mapping[str, Bound] = field(default_factory=dict)
    """by name of a state (stages 1..M), of an input (samples 0..N-1), or of an output (stages 0..M-1 where it depends
    on an input, else 1..M)"""
    change_weights: Mapping[str, float] = field(default_factory=dict)
    """by name of an input: on u_n - u_{n-1}, samples n = 0..N-1"""
    change_bounds: Mapping[str, Bound] = field(default_factory=dict)
    """by name of an input: of u_n - u_{n-1}, per sample, likewise"""
    intervals_per_sample: int = 1
    """shooting intervals of equal length in a sample"""
    integrator: Integrator = Integrator.RUNGE_KUTTA
    integration_steps: int = 1
    """of the integrator, per shooting interval; the most that an adaptive one may try"""
    integration_tolerance: float = 1e-4
    """of an adaptive integrator: estimated error that a step may have, relative to one unit of a state plus its size"""
    initial_weights: Mapping[str, float] = field(default_factory=dict)
    """empty: the first state is given; else by name of a state, all of them: on the distance of a free first state from
    what it should be"""

    def __post_init__(self) -> None:
        _check_model(self.model)
        _check_time(self)
        _check_intervals(self.intervals_per_sample)
        model = self.model
        _check_values("weights", self.weights, model.outputs)
        depends = ca.which_depends(model.output, model.u, 1, True)
        of_inputs = [output for output, on_input in zip(model.outputs, depends, strict=True) if on_input]
        others = [output for output in model.outputs if output not in of_inputs]
        _check_values("terminal_weights", self.terminal_weights, model.outputs, required=others)
        weighed = [output.name for output in of_inputs if self.terminal_weights.get(output.name)]
        if weighed:
            raise SolverError(
                f"terminal_weights: {', '.join(map(repr, weighed))} of {model.name!r} depends on an input, which "
                f"the last stage does not have; leave it out, or give 0.0."
            )
        if self.initial_weights != {}:
            _check_values("initial_weights", self.initial_weights, model.states)
        _check_values("change_weights", self.change_weights, model.inputs, required=())
        _check_bounds(model, self.bounds, {"state": model.states, "input": model.inputs, "output": model.outputs})
        _check_bounds(model, self.change_bounds, {"input": model.inputs}, "change_bounds")
        self._refuse_ambiguous_outputs()
        if self.initial_weights and (self.changing or self.bounded_outputs):
            raise SolverError(
                f"A free first state (initial_weights) goes with bounds on states and inputs only; take "
                f"{', '.join(map(repr, (*self.bounded_outputs, *self.changing)))} out of bounds, change_weights and "
                f"change_bounds."
            )
        if self.initial_weights and self.intervals_per_sample > 1:
            raise SolverError(
                f"A free first state (initial_weights) goes with intervals_per_sample = 1 only, got "
                f"{self.intervals_per_sample}; take integration_steps for accuracy."
            )

    @property
    def remembered(self) -> tuple[str, ...]:
        """The inputs of which the value before is a state: those that change, and all where a sample holds them."""
        held = [each.name for each in self.model.inputs if self.intervals_per_sample > 1]
        return tuple(dict.fromkeys((*self.changing, *held)))

    @property
    def changing(self) -> tuple[str, ...]:
        """The inputs whose changes are weighed or bounded, in the model's order."""
        return tuple(
            each.name for each in self.model.inputs if each.name in {*self.change_weights, *self.change_bounds}
        )

    @property
    def bounded_outputs(self) -> tuple[str, ...]:
        """The bounded names that are neither state nor input, in the order of the model's outputs."""
        own = {each.name for each in (*self.model.states, *self.model.inputs)}
        return tuple(each.name for each in self.model.outputs if each.name in self.bounds and each.name not in own)

    def _refuse_ambiguous_outputs(self) -> None:
        """Refuse a bound on a name that is an output as well, but of something else."""
        model = self.model
        own = ca.vertcat(model.x, model.u)
        place = {each.name: i for i, each in enumerate((*model.states, *model.inputs))}
        for i, output in enumerate(model.outputs):
            known = place.get(output.name)
            if output.name in self.bounds and known is not None and not ca.is_equal(model.output[i], own[known]):
                raise SolverError(
                    f"bounds: {output.name!r} of {model.name!r} is a state or input, and an output that is something "
                    f"else ({model.output[i]}); rename the output."
                )
        changes = [f"{name}_change" for name in self.change_bounds]
        taken = sorted({*self.bounds} & {*changes})
        if taken:
            raise SolverError(f"bounds: {', '.join(map(repr, taken))} names the change of an input here; rename it.")


@dataclass(frozen=True, slots=True, kw_only=True)
class EstimationProblem:
    """min over x_0, p, u of the arrival cost plus the sum of ||h(x,u,p) - y||²_H over a window.

    The model's parameters become states that are constant within the window (and drift between windows by their
    process noise). Weights, deviations and bounds go by name; one that is forgotten or misspelt is refused. Raises
    SolverError when the problem contradicts itself.
    """

    model: Model
    horizon: int
    """N, sampling intervals in the window"""
    sample_time: float
    """s"""
    weights: Mapping[str, float]
    """diagonal of H by name of an output, all of them: the inverse variance of its measurement"""
    prior_deviation: Mapping[str, float]
    """standard deviation of the first prior, by name of a state or parameter, all of them"""
    process_deviation: Mapping[str, float]
    """standard deviation of the process noise per sample, by name of a state or parameter, all of them; 0 is allowed"""
    common_deviation: Mapping[str, float] = field(default_factory=dict)
    """the same of one more noise that moves all states and parameters named here at once"""
    bounds: Mapping[str, Bound] = field(default_factory=dict)
    """by name of a state, parameter or input"""
    acting: Mapping[str, Any] = field(default_factory=dict)
    """by name of a parameter: what acts in its place through a sample, a scalar SX of states, parameters and constants
    where the sample begins; outputs take the parameter itself"""
    integrator: Integrator = Integrator.RUNGE_KUTTA
    integration_steps: int = 1
    """of the integrator, per sample; the most that an adaptive one may try"""
    integration_tolerance: float = 1e-4
    """of an adaptive integrator: estimated error that a step may have, relative to one unit of a state plus its size"""

    def __post_init__(self) -> None:
        _check_model(self.model)
        _check_time(self)
        model, estimated = self.model, self.estimated
        _check_values("weights", self.weights, model.outputs)
        _check_values("prior_deviation", self.prior_deviation, estimated, advice="give how far off it may be at first")
        _check_values("process_deviation", self.process_deviation, estimated, advice="give 0.0 to what stays as it is")
        _check_values("common_deviation", self.common_deviation, estimated, required=())
        if not all(deviation > 0.0 for deviation in self.prior_deviation.values()):
            raise SolverError(f"prior_deviation must be positive, got {dict(self.prior_deviation)}.")
        kinds = {"state": model.states, "parameter": model.parameters, "input": model.inputs}
        _check_bounds(model, self.bounds, kinds)
        _check_acting(model, self.acting)
        if self.acting and self.integrator == Integrator.ADAPTIVE:
            raise SolverError(
                "acting goes with integrators of equal steps only, got Integrator.ADAPTIVE; take another."
            )

    @property
    def estimated(self) -> tuple[Variable, ...]:
        """The states, then the parameters: the order of every array (nx + np,)."""
        return (*self.model.states, *self.model.parameters)


def row(values: Mapping[str, float], declared: Iterable[Variable]) -> list[float]:
    """Return values given by name in the order in which variables are declared, 0 where one is not named."""
    return [values.get(variable.name, 0.0) for variable in declared]


def _check_numbers(what: str, **given: Any) -> None:
    """Refuse what is no number."""
    if wrong := [f"{name} = {value!r}" for name, value in given.items() if not isinstance(value, Real)]:
        raise SolverError(f"{what}: numbers are allowed, got {', '.join(wrong)}; give numbers.")


def _check_model(model: Any) -> None:
    demand("model", model, Model, "give one that declare() or Model(...) made", SolverError)


def _check_time(problem: ControlProblem | EstimationProblem) -> None:
    horizon, sample_time, steps = problem.horizon, problem.sample_time, problem.integration_steps
    if not (isinstance(horizon, Integral) and isinstance(steps, Integral)):
        raise SolverError(
            f"horizon and integration_steps must be whole numbers, got {horizon!r} and {steps!r}; give an int."
        )
    tolerance = problem.integration_tolerance
    _check_numbers("A problem", sample_time=sample_time, integration_tolerance=tolerance)
    if problem.integrator not in tuple(Integrator):
        allowed = ", ".join(f"Integrator.{each.name}" for each in Integrator)
        raise SolverError(f"integrator = {problem.integrator!r} is none of {allowed}; give one of these.")
    if horizon < 2 or steps < 1:
        raise SolverError(f"horizon must be at least 2 and integration_steps at least 1, got {horizon} and {steps}.")
    if horizon > LONGEST_HORIZON or steps > LONGEST_HORIZON:
        raise SolverError(
            f"horizon and integration_steps must be at most {LONGEST_HORIZON}, got {horizon} and {steps}; take longer "
            f"samples."
        )
    if problem.integrator == Integrator.ADAPTIVE and steps < 2:
        raise SolverError(
            f"An adaptive integrator needs integration_steps, the most that it may try, of at least 2, got {steps}; "
            f"give 100, for one."
        )
    if not 0.0 < sample_time < math.inf:
        raise SolverError(f"sample_time must be positive and finite, got {sample_time} s.")
    if not 0.0 < tolerance < 1.0:
        raise SolverError(f"integration_tolerance must lie between 0 and 1, got {tolerance}; give 1e-4, for one.")


def _check_intervals(intervals: Any) -> None:
    if not (isinstance(intervals, Integral) and 1 <= int(intervals) <= MOST_INTERVALS):
        raise SolverError(f"intervals_per_sample must be a whole number from 1 to {MOST_INTERVALS}, got {intervals!r}.")


def _check_values(
    what: str,
    values: Mapping[str, float],
    declared: Iterable[Variable],
    required: Iterable[Variable] | None = None,
    advice: str = "give 0.0 to what shall not count",
) -> None:
    """Refuse values that are not by name, of unknown names, not complete (required None: all), negative or infinite."""
    names = [variable.name for variable in declared]
    if not isinstance(values, Mapping):
        raise SolverError(
            f"{what} go by name, such as {{{names[0]!r}: 1.0}}, got {values!r}; the names are {', '.join(names)}."
        )
    unknown = [name for name in values if name not in names]
    if unknown:
        raise SolverError(f"{what}: there is no {', '.join(map(repr, unknown))}; the names are {', '.join(names)}.")
    _check_numbers(what, **values)
    needed = names if required is None else [variable.name for variable in required]
    missing = [name for name in needed if name not in values]
    if missing:
        raise SolverError(f"{what}: {', '.join(map(repr, missing))} is missing; {advice}.")
    if not all(0.0 <= value < math.inf for value in values.values()):
        raise SolverError(f"{what} must be finite and not negative, got {dict(values)}.")


def _check_bounds(model: Model, bounds: Any, kinds: Mapping[str, Iterable[Variable]], what: str = "bounds") -> None:
    names = [variable.name for kind in kinds.values() for variable in kind]
    if not isinstance(bounds, Mapping) or not all(isinstance(bound, Bound) for bound in bounds.values()):
        raise SolverError(
            f"{what} go by name, such as {{{names[0]!r}: Bound(lower=-1.0, upper=1.0)}}, got {bounds!r}; give a Bound "
            f"for each."
        )
    for name in bounds:
        if name not in names:
            raise SolverError(
                f"{what}: {name!r} is no {', '.join(kinds)} of {model.name!r}; there are "
                f"{', '.join(dict.fromkeys(names))}."
            )


def _check_acting(model: Model, acting: Mapping[str, Any]) -> None:
    names = [variable.name for variable in model.parameters]
    if unknown := [name for name in acting if name not in names]:
        raise SolverError(
            f"acting: {', '.join(map(repr, unknown))} is no parameter of {model.name!r}; there are {', '.join(names)}."
        )
    if wrong := [name for name, value in acting.items() if not isinstance(value, ca.SX) or not value.is_scalar()]:
        raise SolverError(f"acting: {', '.join(map(repr, wrong))} must be a scalar SX of the model's symbols.")
    known = {symbol.element_hash() for symbol in ca.symvar(ca.vertcat(model.x, model.p, model.c))}
    free = {str(s) for value in acting.values() for s in ca.symvar(value) if s.element_hash() not in known}
    if free:
        raise SolverError(
            f"acting uses symbols that are neither state, parameter nor constant of {model.name!r}: {sorted(free)}."
        )

"""Optimal control and estimation problems as plain data."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import casadi as ca

from drawbar.errors import SolverError
from drawbar.optimal.bound import Bound
from drawbar.optimal.problem_checks import (
    check_acting,
    check_bounds,
    check_intervals,
    check_model,
    check_time,
    check_values,
)
from drawbar.vehicle.integrators import Integrator
from drawbar.vehicle.model import Model, Variable


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
        check_model(self.model)
        check_time(self.horizon, self.sample_time, self.integrator, self.integration_steps, self.integration_tolerance)
        check_intervals(self.intervals_per_sample)
        model = self.model
        check_values("weights", self.weights, model.outputs)
        self._check_terminal_weights()
        if self.initial_weights != {}:
            check_values("initial_weights", self.initial_weights, model.states)
        check_values("change_weights", self.change_weights, model.inputs, required=())
        check_bounds(model, self.bounds, {"state": model.states, "input": model.inputs, "output": model.outputs})
        check_bounds(model, self.change_bounds, {"input": model.inputs}, "change_bounds")
        self._refuse_ambiguous_outputs()
        self._refuse_with_a_free_first_state()

    def _check_terminal_weights(self) -> None:
        model = self.model
        depends = ca.which_depends(model.output, model.u, 1, True)
        of_inputs = [output for output, on_input in zip(model.outputs, depends, strict=True) if on_input]
        others = [output for output in model.outputs if output not in of_inputs]
        check_values("terminal_weights", self.terminal_weights, model.outputs, required=others)
        weighed = [output.name for output in of_inputs if self.terminal_weights.get(output.name)]
        if weighed:
            raise SolverError(
                f"terminal_weights: {', '.join(map(repr, weighed))} of {model.name!r} depends on an input, which "
                f"the last stage does not have; leave it out, or give 0.0."
            )

    def _refuse_with_a_free_first_state(self) -> None:
        """Refuse what a problem with a free first state cannot have."""
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
        check_model(self.model)
        check_time(self.horizon, self.sample_time, self.integrator, self.integration_steps, self.integration_tolerance)
        model, estimated = self.model, self.estimated
        check_values("weights", self.weights, model.outputs)
        check_values("prior_deviation", self.prior_deviation, estimated, advice="give how far off it may be at first")
        check_values("process_deviation", self.process_deviation, estimated, advice="give 0.0 to what stays as it is")
        check_values("common_deviation", self.common_deviation, estimated, required=())
        if not all(deviation > 0.0 for deviation in self.prior_deviation.values()):
            raise SolverError(f"prior_deviation must be positive, got {dict(self.prior_deviation)}.")
        kinds = {"state": model.states, "parameter": model.parameters, "input": model.inputs}
        check_bounds(model, self.bounds, kinds)
        check_acting(model, self.acting)
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

"""The extended Kalman filter: states and parameters jointly, one sample at a time, clipped to their bounds.

The arithmetic is C: extended_kalman.h, on the square-root filter of square_root_filter.h.
"""

from ctypes import byref
from time import perf_counter

import casadi as ca
import numpy as np

from drawbar.codegen.component import Component
from drawbar.codegen.emit import Input, Output, emit, emit_constants
from drawbar.errors import ModelError
from drawbar.estimation.description import EstimationModel, no_position
from drawbar.estimation.estimator import Estimator
from drawbar.exchange import CCommand, CEstimate, CMeasurement
from drawbar.geometry import Floats
from drawbar.optimal import EstimationProblem
from drawbar.optimal.transcription import Transcription, transcribe
from drawbar.signals import Command, Estimate, Measurement, SolverStatus, SolveTimes
from drawbar.vehicle.model import column

_FILTER = "struct filter *work"
_UNIT = """
#define NX {states}
#define NU {inputs}
#define NY {outputs}
#define CONSTANTS {constants}
#define LANES 1
{indices}#include "{model}_estimation.h"
#include "extended_kalman.h"
{functions}
"""


class ExtendedKalmanFilter(Estimator):
    """Corrects by what was measured, clips to the bounds (Simon 2010, section 2.4), then predicts the next sample.

    Discretisation, weights, prior and process noise are those of the model's window problem: H^-1 is the covariance of
    the measurements. The inputs are measured too; their errors enter the prediction as noise through dF/du.
    """

    def __init__(self, model: EstimationModel, first: Measurement) -> None:
        """Start from the first measurement.

        Raises:
            HardwareError: the first measurement lacks a position.
            ModelError: an input of the model is not measured.
            CompilerError: the model could not be compiled.
        """
        discrete = transcribe(model.problem)
        _require_measured_inputs(discrete)
        self.component = Component(f"{model.name}_filter", _source(discrete, model.name))
        self._fill_in(model.problem, discrete)
        model.configure(self.component)
        self._update, self._ready = (
            self.component.function("update", pointers=3),
            self.component.function("ready", pointers=1),
        )
        self._measurement, self._estimate, self._command = CMeasurement(), CEstimate(), CCommand()
        self._prepare_time = self._feedback_time = 0.0
        self.state: Floats = self.component.array("filter.x")
        """(nx + np,) states, then parameters: the estimate after update(), its prediction after prepare()"""
        self.root: Floats = self.component.array("filter.R").T
        """(nx + np, nx + np) S, a square root of the state's covariance S S', lower triangular"""
        self._measurement.write(first)
        if self.component.function("begin", pointers=1)(byref(self._measurement)) != SolverStatus.SOLVED:
            raise no_position(first)

    def _fill_in(self, problem: EstimationProblem, discrete: Transcription) -> None:
        """Tell the filter its settings."""
        field = self.component.array
        field("filter.constants")[:] = [each.value for each in discrete.constants]
        field("filter.prior")[:], field("filter.drift")[:] = problem.prior_deviation, problem.process_deviation
        field("filter.common")[:] = problem.common_deviation or 0.0
        field("filter.noise")[:] = np.power(problem.weights, -0.5)
        field("filter.lower")[:], field("filter.upper")[:] = _bounds(problem)
        field("filter.input_row")[:] = np.flatnonzero(discrete.input_outputs)

    @property
    def deviation(self) -> Floats:
        """Standard deviations (nx + np,) of the state as it is now."""
        deviation: Floats = np.linalg.norm(self.root, axis=1)
        return deviation

    def update(self, measurement: Measurement) -> Estimate:
        """Return the estimate at the measurement's time.

        When the result is not finite the estimate is the prediction, and its status says so; a failure of the
        prediction before it shows here too. A missing input keeps its last measured value.
        """
        self._measurement.write(measurement)
        start = perf_counter()
        self._update(byref(self._measurement), byref(self._estimate), self.component.work)
        self._feedback_time = perf_counter() - start
        return self._estimate.read()

    def prepare(self, command: Command | None = None) -> None:
        """Predict state and covariance one sample ahead; should that fail, the covariance is the first one again."""
        if command is not None:
            self._command.write(command)
        start = perf_counter()
        self._ready(None if command is None else byref(self._command))
        self._prepare_time = perf_counter() - start

    @property
    def times(self) -> SolveTimes:
        """Wall-clock time of the last correction (feedback) and prediction (prepare), s."""
        return SolveTimes(prepare=self._prepare_time, feedback=self._feedback_time)


def _source(discrete: Transcription, model: str) -> str:
    """Return the C unit of the filter on a discretised model, whose header is named."""
    inputs = [
        Input(place="work->x[{k}][{i}]", rows="1", symbol=discrete.x),
        Input(place="work->u[{k}][{i}]", rows="1", symbol=discrete.u),
        Input(place="work->constants[{i}]", rows="", symbol=column(discrete.constants)),
    ]
    F, A, B, h, C = _linearised(discrete)
    functions = {
        "transition": [_vector("F", F), _matrix("A", A), _matrix("B", B)],
        "output": [_vector("h", h), _matrix("C", C)],
    }
    every = [result for results in functions.values() for result in results]
    return _UNIT.format(
        states=discrete.x.numel(),
        inputs=discrete.u.numel(),
        outputs=discrete.output.numel(),
        constants=len(discrete.constants),
        indices=discrete.indices(),
        model=model,
        functions=emit_constants("filter_constants", inputs, every, _FILTER)
        + "".join(emit(name, inputs, results, _FILTER) for name, results in functions.items()),
    )


def _linearised(discrete: Transcription) -> tuple[ca.SX, ...]:
    """Return F, dF/dx, dF/du, h, dh/dx."""
    x, u, step, output = discrete.x, discrete.u, discrete.next_state, discrete.output
    return (
        *ca.cse([step, ca.jacobian(step, x), ca.jacobian(step, u)]),
        *ca.cse([output, ca.jacobian(output, x)]),
    )


def _vector(field: str, value: ca.SX) -> Output:
    return Output(place=f"work->{field}[k]", rows="1", value=value)


def _matrix(field: str, value: ca.SX) -> Output:
    return Output(place=f"((double *)work->{field}[k])", rows="1", value=value)


def _require_measured_inputs(discrete: Transcription) -> None:
    """Refuse a model whose inputs are not, each by itself and in order, among its outputs."""
    rows = [row for row, depends in enumerate(discrete.input_outputs) if depends]
    measured = ca.vertcat(*(discrete.output[row] for row in rows))
    if not (measured.shape == discrete.u.shape and ca.is_equal(measured, discrete.u, 1)):
        raise ModelError(
            f"The extended Kalman filter needs every input of {discrete.name!r} as an output by itself; there are "
            f"inputs {discrete.u} and outputs {discrete.output}. Declare the missing ones, or use moving_horizon."
        )


def _bounds(problem: EstimationProblem) -> tuple[Floats, Floats]:
    """Return lower and upper bounds (nx + np,) of states and parameters, infinite where there is none."""
    names = [variable.name for variable in (*problem.model.states, *problem.model.parameters)]
    bounds = [problem.bounds.get(name) for name in names]
    lower = np.array([bound.lower if bound else -np.inf for bound in bounds])
    upper = np.array([bound.upper if bound else np.inf for bound in bounds])
    return lower, upper

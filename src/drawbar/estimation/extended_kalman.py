"""The extended Kalman filter: states and parameters jointly, one sample at a time, clipped to their bounds.

In square-root array form (Kaminski, Bryson, Schmidt 1971; Kailath, Sayed, Hassibi 2000, chapter 12): the covariance is
S S', and one QR factorisation moves S through each of the two phases, so that S S' cannot lose its definiteness.
"""

from time import perf_counter

import casadi as ca
import numpy as np
from scipy.linalg import qr

from drawbar.codegen import CompiledFunction
from drawbar.errors import ModelError
from drawbar.estimation.description import EstimationModel
from drawbar.estimation.estimator import Estimator
from drawbar.estimation.screening import Screened, Screening
from drawbar.geometry import Floats
from drawbar.optimal import EstimationProblem
from drawbar.optimal.transcription import Transcription, transcribe
from drawbar.signals import Command, Estimate, Measurement, SolverStatus, SolveTimes


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
        problem = model.problem
        discrete = transcribe(problem)
        self._model = model
        self._screening = Screening(model.screening, model.position_deviation)
        self._of_input = np.array(discrete.input_outputs)
        _require_measured_inputs(discrete)
        self._transition = _linearised(discrete, "transition", discrete.next_state)
        self._output = _linearised(discrete, "output", discrete.output)
        self._noise = np.power(problem.weights, -0.5)
        self._drift = np.diag(problem.process_deviation)
        self._lower, self._upper = _bounds(problem)
        self._input = np.zeros(discrete.u.numel())
        self._predicted = SolverStatus.SOLVED
        self._prepare_time = self._feedback_time = 0.0
        self.state: Floats = model.first_guess(first)
        """(nx + np,) states, then parameters: the estimate after update(), its prediction after prepare()"""
        self._prior = np.diag(problem.prior_deviation)
        self.root: Floats = self._prior
        """(nx + np, nx + np) S, a square root of the state's covariance S S'"""

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
        seen = self._screen(measurement)
        start = perf_counter()
        y = np.array(self._model.outputs(seen.measurement))
        of_input = y[self._of_input]
        self._input = np.where(np.isnan(of_input), self._input, of_input)
        status = self._correct(y)
        self._feedback_time = perf_counter() - start
        if status is SolverStatus.SOLVED:
            status = self._predicted
        return seen.mark(self._model.estimate(self.state.tolist(), seen.measurement, status))

    def prepare(self, command: Command | None = None) -> None:
        """Predict state and covariance one sample ahead; should that fail, the covariance is the first one again."""
        start = perf_counter()
        if command is not None:
            rates = self._model.steering_rates(self.state.tolist(), command)
            self._input[self._input.size - len(rates) :] = rates
        self._predicted = self._predict()
        if self._predicted is not SolverStatus.SOLVED:
            self.root = self._prior
        self._prepare_time = perf_counter() - start

    @property
    def times(self) -> SolveTimes:
        """Wall-clock time of the last correction (feedback) and prediction (prepare), s."""
        return SolveTimes(prepare=self._prepare_time, feedback=self._feedback_time)

    def _screen(self, measurement: Measurement) -> Screened:
        """Judge the newest fixes, and start anew where both overrule the prediction."""
        seen = self._screening.screen(measurement, self._model.antennas(self.state.tolist()))
        if seen.restart:
            self.state, self.root = self._model.new_guess(measurement, self.state), self._prior
        return seen

    @np.errstate(over="ignore", invalid="ignore")  # _accept looks
    def _correct(self, y: Floats) -> SolverStatus:
        """Move state and covariance by the outputs y (ny,) that are there."""
        h, C, _ = self._evaluate(self._output)
        seen = ~(np.isnan(y) | self._of_input)
        count, n = int(seen.sum()), self.state.size
        array = np.zeros((count + n, count + n))  # [V, C S; 0, S], V the noise; its triangle is [X, 0; K X, S+]
        array[:count, :count] = np.diag(self._noise[seen])
        array[:count, count:] = C[seen] @ self.root
        array[count:, count:] = self.root
        triangle = _triangle(array)
        gain = triangle[count:, :count]
        state = self.state + gain @ np.linalg.solve(triangle[:count, :count], y[seen] - h[seen])
        return self._accept(np.clip(state, self._lower, self._upper), triangle[count:, count:])

    @np.errstate(over="ignore", invalid="ignore")
    def _predict(self) -> SolverStatus:
        """Move state and covariance by one sample."""
        state, A, B = self._evaluate(self._transition)
        noise_of_input = B * self._noise[self._of_input]
        array = np.hstack([A @ self.root, noise_of_input, self._drift])
        return self._accept(state, _triangle(array))

    def _evaluate(self, function: CompiledFunction) -> tuple[Floats, Floats, Floats]:
        """Return the function's value and its Jacobians by state and input, at the present state and input."""
        function.inputs[0][:], function.inputs[1][:] = self.state, self._input
        function()
        value, by_state, by_input = function.outputs
        rows = value.size
        return value.copy(), by_state.reshape(-1, rows).T, by_input.reshape(-1, rows).T

    def _accept(self, state: Floats, root: Floats) -> SolverStatus:
        if not (np.isfinite(state).all() and np.isfinite(root).all()):
            return SolverStatus.NOT_FINITE
        self.state, self.root = state, root
        return SolverStatus.SOLVED


def _triangle(array: Floats) -> Floats:
    """Return the lower triangular L with L L' = M M' of an array M (n, m), n <= m."""
    upper: Floats = qr(array.T, mode="r", check_finite=False)[0][: len(array)]
    return upper.T


def _linearised(discrete: Transcription, what: str, expression: ca.SX) -> CompiledFunction:
    """Return the expression and its Jacobians by state and input as machine code."""
    x, u = discrete.x, discrete.u
    results = ca.cse([expression, ca.jacobian(expression, x), ca.jacobian(expression, u)])
    return CompiledFunction(ca.Function(f"{discrete.name}_{what}", [x, u], results))


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

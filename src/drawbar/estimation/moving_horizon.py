"""Moving horizon estimation: one Gauss-Newton iteration per sample over a sliding window (equation mhe)."""

import math
from time import perf_counter

from drawbar.estimation.description import EstimationModel
from drawbar.estimation.deviation import newest_deviation
from drawbar.estimation.estimator import Estimator
from drawbar.estimation.screening import Screened, Screening
from drawbar.geometry import Floats
from drawbar.optimal import EstimationSolver
from drawbar.signals import Command, Estimate, Measurement, SolverStatus, SolveTimes


class MovingHorizonEstimator(Estimator):
    """The window fills from the first measurement on; once full, its oldest stage moves into the arrival cost."""

    def __init__(self, model: EstimationModel, first: Measurement) -> None:
        """Start from the first measurement.

        Raises:
            HardwareError: the first measurement lacks a position.
            CompilerError: the solver could not be compiled.
        """
        self._model = model
        self._screening = Screening(model.screening, model.position_deviation)
        self.solver = EstimationSolver(model.problem, model.first_guess(first))
        self._prepared = SolverStatus.SOLVED
        self._prepare_time = self._feedback_time = 0.0

    def update(self, measurement: Measurement) -> Estimate:
        """Return the estimate at the window's newest stage.

        When the solver fails the estimate is the prediction, and its status says so; a failure of the preparation
        before it shows here too.
        """
        solver, model = self.solver, self._model
        seen = self._screen(measurement)
        newest = solver.newest
        solver.y[newest] = model.outputs(seen.measurement)
        start = perf_counter()
        status = SolverStatus(solver.feedback())
        self._feedback_time = perf_counter() - start
        if status is SolverStatus.SOLVED:
            status = self._prepared
        return seen.mark(model.estimate(solver.x[newest].tolist(), seen.measurement, status))

    def prepare(self, command: Command | None = None) -> None:
        """Slide the window by one sample and linearise along the predicted trajectory."""
        if command is not None:
            self._expect(command)
        start = perf_counter()
        self._prepared = self.solver.advance()
        self._prepare_time = perf_counter() - start

    def _expect(self, command: Command) -> None:
        """Let the newest stage know what the command does to the steering until the next sample."""
        row = self.solver.newest
        rates = self._model.steering_rates(self.solver.x[row].tolist(), command)
        self.solver.y[row, self.solver.y.shape[1] - len(rates) :] = rates

    def _screen(self, measurement: Measurement) -> Screened:
        """Judge the newest fixes, and let the window forget what they show to have been wrong."""
        solver, model = self.solver, self._model
        expected = solver.x[solver.newest]
        seen = self._screening.screen(measurement, model.antennas(expected.tolist()))
        if seen.restart:
            solver.restart(model.new_guess(measurement, expected))
        if seen.exposed is not None:
            first, column = max(solver.newest - model.screening.memory, 0), 2 * seen.exposed
            solver.y[first : solver.newest, column : column + 2] = math.nan
        return seen

    @property
    def deviation(self) -> Floats:
        """Standard deviations (nx + np,) of states and parameters as they are now; takes milliseconds."""
        return newest_deviation(self.solver)

    @property
    def times(self) -> SolveTimes:
        """Wall-clock time of the last two phases, s."""
        return SolveTimes(prepare=self._prepare_time, feedback=self._feedback_time)

"""Moving horizon estimation: one Gauss-Newton iteration per sample over a sliding window (equation mhe)."""

from time import perf_counter

from drawbar.estimation.description import EstimationModel
from drawbar.estimation.estimator import Estimator
from drawbar.optimal import EstimationSolver
from drawbar.signals import Estimate, Measurement, SolverStatus, SolveTimes


class MovingHorizonEstimator(Estimator):
    """The window fills from the first measurement on; once full, its oldest stage moves into the arrival cost."""

    def __init__(self, model: EstimationModel, first: Measurement) -> None:
        """Start from the first measurement.

        Raises:
            HardwareError: the first measurement lacks a position.
            CompilerError: the solver could not be compiled.
        """
        self._model = model
        self.solver = EstimationSolver(model.problem, model.first_guess(first))
        self._prepare_time = self._feedback_time = 0.0

    def update(self, measurement: Measurement) -> Estimate:
        """Return the estimate at the window's newest stage.

        When the solver fails the estimate is the prediction, and its status says so.
        """
        solver, newest = self.solver, self.solver.newest
        solver.y[newest] = self._model.outputs(measurement)
        start = perf_counter()
        status = solver.feedback()
        self._feedback_time = perf_counter() - start
        return self._model.estimate(solver.x[newest].tolist(), measurement, SolverStatus(status))

    def prepare(self) -> None:
        """Slide the window by one sample and linearise along the predicted trajectory."""
        start = perf_counter()
        self.solver.advance()
        self._prepare_time = perf_counter() - start

    @property
    def times(self) -> SolveTimes:
        """Wall-clock time of the last two phases, s."""
        return SolveTimes(prepare=self._prepare_time, feedback=self._feedback_time)

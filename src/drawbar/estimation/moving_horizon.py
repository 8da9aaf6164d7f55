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
        self._prepared = SolverStatus.SOLVED
        self._prepare_time = self._feedback_time = 0.0

    def update(self, measurement: Measurement) -> Estimate:
        """Return the estimate at the window's newest stage.

        When the solver fails the estimate is the prediction, and its status says so; a failure of the preparation
        before it shows here too.
        """
        solver, newest = self.solver, self.solver.newest
        solver.y[newest] = self._model.outputs(measurement)
        start = perf_counter()
        status = SolverStatus(solver.feedback())
        self._feedback_time = perf_counter() - start
        if status is SolverStatus.SOLVED:
            status = self._prepared
        return self._model.estimate(solver.x[newest].tolist(), measurement, status)

    def prepare(self) -> None:
        """Slide the window by one sample and linearise along the predicted trajectory."""
        start = perf_counter()
        self._prepared = self.solver.advance()
        self._prepare_time = perf_counter() - start

    @property
    def times(self) -> SolveTimes:
        """Wall-clock time of the last two phases, s."""
        return SolveTimes(prepare=self._prepare_time, feedback=self._feedback_time)

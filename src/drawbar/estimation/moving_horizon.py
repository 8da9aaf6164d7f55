"""Moving horizon estimation: one Gauss-Newton iteration per sample over a sliding window (equation mhe)."""

from ctypes import byref
from time import perf_counter

from drawbar.estimation.description import EstimationModel, no_position
from drawbar.estimation.deviation import newest_deviation
from drawbar.estimation.estimator import Estimator
from drawbar.exchange import CCommand, CEstimate, CMeasurement
from drawbar.geometry import Floats
from drawbar.optimal import EstimationSolver
from drawbar.signals import Command, Estimate, Measurement, SolverStatus, SolveTimes


class MovingHorizonEstimator(Estimator):
    """The window fills from the first measurement on; once full, its oldest stage moves into the arrival cost.

    What surrounds the solver is moving_horizon.h, which also tells what becomes of fixes that are not to be believed.
    """

    def __init__(self, model: EstimationModel, first: Measurement) -> None:
        """Start from the first measurement.

        Raises:
            HardwareError: the first measurement lacks a position.
            CompilerError: the solver could not be compiled.
        """
        self.solver = EstimationSolver(model.problem, None, component=f"{model.name}_moving_horizon.h")
        workspace = self.solver.workspace
        model.configure(workspace)
        self._enter, self._leave = workspace.function("enter", pointers=1), workspace.function("leave", pointers=1)
        self._expect, self._judge = workspace.function("expect", pointers=1), workspace.function("judge")
        self._measurement, self._estimate, self._acting = CMeasurement(), CEstimate(), CCommand()
        self._prepare_time = self._feedback_time = 0.0
        self._measurement.write(first)
        if workspace.function("begin", pointers=1)(byref(self._measurement)) != SolverStatus.SOLVED:
            raise no_position(first)

    def update(self, measurement: Measurement) -> Estimate:
        """Return the estimate at the window's newest stage.

        When the solver fails the estimate is the prediction, and its status says so; a failure of the preparation
        before it shows here too.
        """
        self._measurement.write(measurement)
        self._enter(byref(self._measurement))
        start = perf_counter()
        self.solver.feedback()
        self._feedback_time = perf_counter() - start
        self._leave(byref(self._estimate))
        return self._estimate.read()

    def prepare(self, command: Command | None = None) -> None:
        """Slide the window by one sample and linearise along the predicted trajectory."""
        if command is not None:
            self._acting.write(command)
            self._expect(byref(self._acting))
        start = perf_counter()
        self.solver.slide()
        self.solver.prepare()
        self._prepare_time = perf_counter() - start
        self._judge()

    @property
    def deviation(self) -> Floats:
        """Standard deviations (nx + np,) of states and parameters as they are now; takes milliseconds."""
        return newest_deviation(self.solver)

    @property
    def times(self) -> SolveTimes:
        """Wall-clock time of the last two phases, s."""
        return SolveTimes(prepare=self._prepare_time, feedback=self._feedback_time)

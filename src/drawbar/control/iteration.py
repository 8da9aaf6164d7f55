"""A controller's compiled solver from sample to sample: its two phases, timed."""

from time import perf_counter

from drawbar.optimal import ControlSolver
from drawbar.signals import SolveTimes


class TimedIteration:
    """The two phases of a control solver, timed."""

    def __init__(self, solver: ControlSolver) -> None:
        """Take the solver."""
        self._solver = solver
        self._prepare_time = self._feedback_time = 0.0

    def feedback(self) -> None:
        """Solve for the data that the solver holds."""
        start = perf_counter()
        self._solver.feedback()
        self._feedback_time = perf_counter() - start

    def prepare(self) -> None:
        """Shift the plan by one sample and linearise along it."""
        start = perf_counter()
        self._solver.advance()
        self._prepare_time = perf_counter() - start

    @property
    def times(self) -> SolveTimes:
        """Wall-clock time of the last two phases, s."""
        return SolveTimes(prepare=self._prepare_time, feedback=self._feedback_time)

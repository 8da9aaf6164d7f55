"""A controller's compiled solver from sample to sample: started anew where it must be, judged and timed."""

from collections.abc import Callable
from time import perf_counter

import numpy as np

from drawbar.optimal import ControlSolver
from drawbar.signals import SolverStatus, SolveTimes

_TORN = 0.5
"""Gap between two intervals of a plan, m or rad, from which on a full Gauss-Newton step cannot be believed."""


class RealTimeIteration:
    """The two phases of a control solver, with the memory of whether its last plan can be gone on from."""

    def __init__(self, solver: ControlSolver, guess: Callable[[], None]) -> None:
        """Take the solver, and what makes it linearise along a first guess."""
        self._solver, self._guess = solver, guess
        self._usable = False
        self._torn = False
        self._prepare_time = self._feedback_time = 0.0

    def feedback(self) -> SolverStatus:
        """Solve for the data that the solver holds, from the last plan or, where that is none, from the guess."""
        if not self._usable:
            self._guess()
        start = perf_counter()
        status = SolverStatus(self._solver.feedback())
        self._feedback_time = perf_counter() - start
        self._usable = status is SolverStatus.SOLVED
        return SolverStatus.CHECK_FAILED if self._torn else status

    def prepare(self) -> None:
        """Shift the plan by one sample and linearise along it.

        A plan whose intervals do not nearly meet is none: the next one starts afresh, and says so in its status.
        """
        start = perf_counter()
        self._solver.advance()
        self._prepare_time = perf_counter() - start
        self._torn = not np.abs(self._solver.defects).max() <= _TORN
        self._usable &= not self._torn

    @property
    def times(self) -> SolveTimes:
        """Wall-clock time of the last two phases, s."""
        return SolveTimes(prepare=self._prepare_time, feedback=self._feedback_time)

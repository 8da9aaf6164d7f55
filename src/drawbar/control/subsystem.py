"""One body's nominal controller: what all of them share."""

from abc import ABC, abstractmethod
from time import perf_counter

import numpy as np

from drawbar.geometry import Floats
from drawbar.optimal import ControlProblem, ControlSolver
from drawbar.signals import BodyPlan, BodyReference, Estimate, SolverStatus, SolveTimes

_TORN = 0.5
"""Gap between two intervals of a plan, m or rad, from which on a full Gauss-Newton step cannot be believed."""


class SubsystemController(ABC):
    """Solves one subsystem's problem by the real-time iteration; a subclass fills in what its model needs."""

    def __init__(self, problem: ControlProblem) -> None:
        """Compile the solver and prepare it at rest.

        Raises:
            SolverError: the problem contradicts itself.
            CompilerError: no compiler, or it refused the code.
        """
        self.solver = ControlSolver(problem)
        self._usable = False
        self._torn = False
        self._prepare_time = self._feedback_time = 0.0

    @abstractmethod
    def _fill(self, estimate: Estimate, reference: BodyReference, neighbour: BodyPlan | None) -> None:
        """Write initial state, parameters and references into the solver."""

    @abstractmethod
    def _steering(self) -> float:
        """Return the nominal command of the plan's first sample, rad."""

    @abstractmethod
    def _steerings(self) -> Floats:
        """Return the planned steering angles (N,), rad."""

    @abstractmethod
    def _poses(self) -> Floats:
        """Return the predicted antenna poses (N+1, 3): x, y (m), yaw (rad)."""

    def feedback(self, estimate: Estimate, reference: BodyReference, neighbour: BodyPlan | None = None) -> BodyPlan:
        """Return the plan from the estimate along the reference.

        Args:
            estimate: where the vehicle is.
            reference: this body's path samples, one per stage.
            neighbour: the other body's plan, where the coupling is planned.
        """
        solver = self.solver
        self._fill(estimate, reference, neighbour)
        if not self._usable:
            self._guess(reference)
        start = perf_counter()
        status = SolverStatus(solver.feedback())
        self._feedback_time = perf_counter() - start
        self._usable = status is SolverStatus.SOLVED
        return BodyPlan(
            steering=self._steering(),
            poses=self._poses(),
            steerings=self._steerings(),
            status=SolverStatus.CHECK_FAILED if self._torn else status,
        )

    def prepare(self) -> None:
        """Shift the plan by one sample and linearise along it.

        A plan whose intervals do not nearly meet is none: the next one starts afresh, and says so in its status.
        """
        start = perf_counter()
        self.solver.advance()
        self._prepare_time = perf_counter() - start
        self._torn = not np.abs(self.solver.defects).max() <= _TORN
        self._usable &= not self._torn

    def _guess(self, reference: BodyReference) -> None:
        """Linearise along a first guess: standing still."""
        self.solver.start()

    @property
    def times(self) -> SolveTimes:
        """Wall-clock time of the last two phases, s."""
        return SolveTimes(prepare=self._prepare_time, feedback=self._feedback_time)

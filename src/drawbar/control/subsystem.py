"""One body's nominal controller: what all of them share (subsystem.h)."""

from collections.abc import Mapping
from ctypes import byref
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from drawbar.control.iteration import TimedIteration
from drawbar.control.settings import Coupling, Nominal
from drawbar.control.tube.inner_box import initial_choice
from drawbar.control.tube.tube import SubsystemTube
from drawbar.exchange import CBodyPlan, CBodyReference, CEstimate
from drawbar.geometry import Floats
from drawbar.optimal import ControlProblem, ControlSolver
from drawbar.signals import BodyPlan, BodyReference, Estimate, SolveTimes

_PULL = 1e-3
"""Weight on what parts a chosen first state from where the nominal model got to: decides what nothing else does."""


class SubsystemController:
    """Solves one subsystem's problem by the real-time iteration; a subclass says which, and by which C.

    The arithmetic around the solver's phases is that of the component's header; here the phases are called and timed.
    """

    def __init__(
        self, problem: ControlProblem, tube: SubsystemTube, component: str, settings: Mapping[str, ArrayLike]
    ) -> None:
        """Compile the controller.

        Args:
            problem: with the bounds that the tube leaves, starting from a given state.
            tube: says where the problem starts at each sample.
            component: header of the runtime.
            settings: the component's own, by name.

        Raises:
            ConfigurationError: the nominal state shall be optimised, but there is no set to choose it from.
            SolverError: the problem contradicts itself.
            CompilerError: no compiler, or it refused the code.
        """
        states = [variable.name for variable in problem.model.states]
        start: dict[str, ArrayLike] = {"subsystem.restarts": tube.nominal is Nominal.PREDICTED}
        if tube.nominal is Nominal.OPTIMISED:
            problem = replace(problem, initial_weights=dict.fromkeys(states, _PULL))
            start |= _box(initial_choice(tube), len(states))
        self.solver = ControlSolver(problem, component)
        self._iteration = TimedIteration(self.solver)
        workspace = self.solver.workspace
        workspace.write({**settings, **start})
        self._enter = workspace.function("enter", pointers=3)
        self._leave = workspace.function("leave", pointers=1)
        self._judge = workspace.function("judge")
        self._estimate, self._reference = CEstimate(), CBodyReference()
        self._neighbour, self._plan = CBodyPlan(), CBodyPlan()

    def feedback(self, estimate: Estimate, reference: BodyReference, neighbour: BodyPlan | None = None) -> BodyPlan:
        """Return the plan from the estimate along the reference.

        Args:
            estimate: where the vehicle is.
            reference: this body's path samples, one per stage.
            neighbour: the other body's plan, where the coupling is planned.
        """
        self._estimate.write(estimate)
        self._reference.write(reference, self.solver.problem.horizon + 1)
        if neighbour is not None:
            self._neighbour.write(neighbour)
        self._enter(
            byref(self._estimate), byref(self._reference), None if neighbour is None else byref(self._neighbour)
        )
        self._iteration.feedback()
        self._leave(byref(self._plan))
        return self._plan.read(self.solver.problem.horizon)

    def prepare(self) -> None:
        """Shift the plan by one sample and linearise along it."""
        self._iteration.prepare()
        self._judge()

    @property
    def times(self) -> SolveTimes:
        """Wall-clock time of the last two phases, s."""
        return self._iteration.times


def coupling_settings(coupling: Coupling) -> dict[str, int]:
    """Return the setting of a trailer's coupling: enum coupling has the same order."""
    return {"coupling": list(Coupling).index(coupling)}


def _box(choice: Floats, states: int) -> dict[str, Floats]:
    """Return the settings of optimised_start.h.

    Args:
        choice: half-widths of the box that the first state may be chosen from, see initial_choice.
        states: of the model; one more than half-widths is the one along the path: it is the estimate's.
    """
    reach = np.concatenate([np.full(states - len(choice), np.inf), choice])
    return {"subsystem.reach": reach, "subsystem.half_widths": np.where(np.isfinite(reach), reach, 0.0)}

"""Centralised control: one problem for both bodies (the paper's CeNMPC)."""

from drawbar.control.both_bodies import BothBodies
from drawbar.control.iteration import TimedIteration
from drawbar.control.nominal import NO_SOLVER, NominalController
from drawbar.control.settings import Nominal
from drawbar.control.tube.tube import Tubes
from drawbar.errors import ConfigurationError
from drawbar.optimal import ControlProblem, ControlSolver
from drawbar.signals import Estimate, Plan, Reference, SolveTimes


class CentralisedController(NominalController):
    """Solves the whole vehicle's problem by the real-time iteration; a subclass states the problem.

    The coupling needs no assumption here: the model holds it. What goes on around the solver's phases is C,
    centralised_phases.h, with what a model needs in a header of its own.
    """

    def __init__(self, component: str, problem: ControlProblem, tubes: Tubes) -> None:
        """Compile the controller.

        Args:
            component: header of the model.
            problem: with the bounds that the tubes leave.
            tubes: what both bodies are held by.

        Raises:
            ConfigurationError: the tubes' nominal state is not the predicted one.
            SolverError: the problem contradicts itself.
            CompilerError: no compiler, or it refused the code.
        """
        if tubes.tractor.nominal is not Nominal.PREDICTED:
            raise ConfigurationError(
                f'tube.nominal = "{tubes.tractor.nominal}" needs one nominal problem per body; with '
                f'controller.structure = "centralised" only "predicted" is possible'
            )
        self.solver = ControlSolver(problem, component)
        self._iteration = TimedIteration(self.solver)
        self._bodies = BothBodies(problem.horizon)
        function = self.solver.workspace.function
        self._enter, self._leave, self._judge = function("enter", 3), function("leave", 2), function("judge")

    def feedback(self, estimate: Estimate, reference: Reference) -> Plan:
        """Return both bodies' plans from the newest estimate; they share one status."""
        self._bodies.write(estimate, reference)
        self._enter(*self._bodies.given)
        self._iteration.feedback()
        self._leave(*self._bodies.plans)
        return self._bodies.plan(estimate.time)

    def prepare(self) -> None:
        """Prepare the solver for the next sample."""
        self._iteration.prepare()
        self._judge()

    @property
    def times(self) -> tuple[SolveTimes, SolveTimes]:
        """Wall-clock time of the last two phases, s: the one solver's as the tractor's, the trailer's are NaN."""
        return self._iteration.times, NO_SOLVER

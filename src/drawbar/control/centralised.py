"""Centralised control: one problem for both bodies (the paper's CeNMPC)."""

from abc import abstractmethod

from drawbar.control.iteration import RealTimeIteration
from drawbar.control.nominal import NO_SOLVER, NominalController
from drawbar.control.settings import Nominal
from drawbar.control.tube.tube import Tubes
from drawbar.errors import ConfigurationError
from drawbar.geometry import Floats
from drawbar.optimal import ControlProblem, ControlSolver
from drawbar.signals import BodyPlan, Estimate, Plan, Reference, SolverStatus, SolveTimes


class CentralisedController(NominalController):
    """Solves the whole vehicle's problem by the real-time iteration; a subclass fills in what its model needs.

    The coupling needs no assumption here: the model holds it.
    """

    def __init__(self, problem: ControlProblem, tubes: Tubes) -> None:
        """Compile the solver.

        Args:
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
        self.solver = ControlSolver(problem)
        self._iteration = RealTimeIteration(self.solver, self._guess)
        self._predicted: Floats | None = None

    @abstractmethod
    def _state(self, estimate: Estimate) -> Floats:
        """Return the estimate (nx,) in the model's states."""

    @abstractmethod
    def _fill(self, estimate: Estimate, reference: Reference) -> None:
        """Write parameters and references into the solver."""

    @abstractmethod
    def _guess(self) -> None:
        """Linearise along a first guess, made of what was filled in."""

    @abstractmethod
    def _steering(self) -> tuple[float, float]:
        """Return both nominal commands of the plan's first sample, rad; let the plan's first input be what they do."""

    @abstractmethod
    def _steerings(self) -> Floats:
        """Return the planned steering angles (N, 2) of tractor and trailer, rad."""

    @abstractmethod
    def _poses(self) -> tuple[Floats, Floats]:
        """Return the predicted antenna poses of tractor and trailer, (N+1, 3) each: x, y (m), yaw (rad)."""

    @abstractmethod
    def _deviations(self, estimated: Floats, predicted: Floats, reference: Reference) -> tuple[Floats, Floats]:
        """Return x̂ - x̄ of tractor and trailer in the coordinates of their ancillary laws."""

    def feedback(self, estimate: Estimate, reference: Reference) -> Plan:
        """Return both bodies' plans from the newest estimate; they share one status."""
        estimated = self._state(estimate)
        predicted = estimated if self._predicted is None else self._predicted
        self.solver.initial[:] = estimated
        self._fill(estimate, reference)
        status = self._iteration.feedback()
        commands = self._steering()
        self._predicted = self.solver.successor() if status is SolverStatus.SOLVED else None
        deviations = self._deviations(estimated, predicted, reference)
        tractor, trailer = (
            BodyPlan(steering=command, poses=poses, steerings=steerings, deviation=deviation, status=status)
            for command, poses, steerings, deviation in zip(
                commands, self._poses(), self._steerings().T, deviations, strict=True
            )
        )
        return Plan(time=estimate.time, tractor=tractor, trailer=trailer)

    def prepare(self) -> None:
        """Prepare the solver for the next sample."""
        self._iteration.prepare()

    @property
    def times(self) -> tuple[SolveTimes, SolveTimes]:
        """Wall-clock time of the last two phases, s: the one solver's as the tractor's, the trailer's are NaN."""
        return self._iteration.times, NO_SOLVER

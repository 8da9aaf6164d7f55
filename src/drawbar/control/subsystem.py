"""One body's nominal controller: what all of them share."""

from abc import ABC, abstractmethod
from dataclasses import replace

from drawbar.control.iteration import RealTimeIteration
from drawbar.control.nominal_state import beside, pose_deviation
from drawbar.control.optimised_start import OptimisedStart
from drawbar.control.settings import Nominal
from drawbar.control.tube.inner_box import initial_choice
from drawbar.control.tube.tube import SubsystemTube
from drawbar.geometry import Floats
from drawbar.optimal import ControlProblem, ControlSolver
from drawbar.signals import BodyPlan, BodyReference, Estimate, SolverStatus, SolveTimes


class SubsystemController(ABC):
    """Solves one subsystem's problem by the real-time iteration; a subclass fills in what its model needs.

    The states of a subclass are a pose and what follows it, unless it overrides `_beside` and `_deviation`.
    """

    def __init__(self, problem: ControlProblem, tube: SubsystemTube) -> None:
        """Compile the solver.

        Args:
            problem: with the bounds that the tube leaves, starting from a given state.
            tube: says where the problem starts at each sample.

        Raises:
            ConfigurationError: the nominal state shall be optimised, but there is no set to choose it from.
            SolverError: the problem contradicts itself.
            CompilerError: no compiler, or it refused the code.
        """
        self._restarts = tube.nominal is Nominal.PREDICTED
        self._choice: OptimisedStart | None = None
        if tube.nominal is Nominal.OPTIMISED:
            self._choice = OptimisedStart(initial_choice(tube), len(problem.model.states))
            problem = replace(problem, initial_weights=self._choice.weights)
        self.solver = ControlSolver(problem)
        self._iteration = RealTimeIteration(self.solver, self._guess)
        self._successor: Floats | None = None

    @abstractmethod
    def _state(self, estimate: Estimate) -> Floats:
        """Return the estimate (nx,) in the states of this body's model."""

    @abstractmethod
    def _fill(self, estimate: Estimate, reference: BodyReference, neighbour: BodyPlan | None) -> None:
        """Write parameters and references into the solver."""

    @abstractmethod
    def _steering(self) -> float:
        """Return the nominal command of the plan's first sample, rad; let the plan's first input be what it does."""

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
        if self._choice is not None:
            estimate, reference = self._enter(self._choice, estimate, reference)
        estimated = self._state(estimate)
        nominal = estimated if self._successor is None else self._beside(self._successor, reference)
        self._begin(estimated, nominal)
        self._fill(estimate, reference, neighbour)
        status = self._iteration.feedback()
        if status is not SolverStatus.SOLVED:
            self.solver.x[0] = self.solver.initial  # of a plan that failed only its begin is known
        steering = self._steering()
        self._successor = self.solver.successor() if status is SolverStatus.SOLVED else None
        return BodyPlan(
            steering=steering,
            poses=self._poses() if self._choice is None else self._choice.placed(self._poses()),
            steerings=self._steerings(),
            deviation=self._deviation(estimated, nominal if self._choice is None else self.solver.x[0]),
            status=status,
        )

    def _begin(self, estimated: Floats, nominal: Floats) -> None:
        """Let the problem start where the tube wants it to: all its states are (nx,)."""
        self.solver.initial[:] = estimated if self._restarts else nominal
        if self._choice is not None:
            self.solver.initial_lower[:], self.solver.initial_upper[:] = self._choice.between(estimated, nominal)

    def prepare(self) -> None:
        """Shift the plan by one sample and linearise along it."""
        self._iteration.prepare()

    def _enter(
        self, choice: OptimisedStart, estimate: Estimate, reference: BodyReference
    ) -> tuple[Estimate, BodyReference]:
        """State the problem, and all that is remembered of it, in the frame in which its start is chosen."""
        old = choice.enter(reference)
        self.solver.x[:] = choice.seen_again(old, self.solver.x)
        if self._successor is not None:
            self._successor = choice.seen_again(old, self._successor[None])[0]
        self.solver.prepare()
        return choice.seen(estimate, reference)

    def _beside(self, state: Floats, reference: BodyReference) -> Floats:
        """Return the nominal state (nx,) without what separates it from the estimate along the path."""
        return beside(state, reference.closest)

    def _deviation(self, estimated: Floats, nominal: Floats) -> Floats:
        """Return x̂ - x̄ in the coordinates in which the ancillary law acts."""
        return pose_deviation(estimated, nominal)

    def _guess(self) -> None:
        """Linearise along a first guess, made of what was filled in: standing still."""
        self.solver.start()

    @property
    def times(self) -> SolveTimes:
        """Wall-clock time of the last two phases, s."""
        return self._iteration.times

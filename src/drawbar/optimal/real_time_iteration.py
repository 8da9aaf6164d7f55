"""Real-time iteration, compiled: arrays to fill and read, phases to call; what control and estimation share."""

from collections.abc import Callable

from drawbar.codegen import Workspace, build
from drawbar.geometry import Floats
from drawbar.optimal.problem import ControlProblem, EstimationProblem
from drawbar.optimal.residuals import Residuals, Solution, residuals
from drawbar.optimal.settings import write_settings
from drawbar.optimal.solver_source import introspection, solver_source
from drawbar.optimal.transcription import transcribe
from drawbar.optimal.views import Guarded, StageBounds
from drawbar.signals import SolverStatus

Phase = Callable[[], int]
"""A C function bound to its workspace; returns a SolverStatus."""


class RealTimeIteration(Guarded):
    """What control and estimation share: the workspace and the phases prepare, feedback and shift.

    The arrays are views of the compiled solver's own memory: write into them (`solver.y[...] = values`), read from
    them. Binding another array to their names raises SolverError. N samples have M shooting intervals: M = N, unless a
    ControlProblem has several in each.
    """

    def __init__(self, problem: ControlProblem | EstimationProblem) -> None:
        transcription = transcribe(problem)
        self.source = solver_source(transcription)
        """C unit of the solver"""
        self.workspace = Workspace(build(transcription.name, self.source + introspection(transcription)))
        write_settings(self.workspace, problem, transcription)
        self.workspace.function("lay_down")()
        array = self.workspace.array
        states = len(problem.estimated if isinstance(problem, EstimationProblem) else problem.model.states)
        outputs = len(problem.model.outputs)
        self.x: Floats = array("x")[:, :states]
        """(M+1, nx) state trajectory"""
        self.u: Floats = array("u")[:: transcription.held]
        """(N, nu) input trajectory"""
        self.y: Floats = array("y")[:, :outputs]
        """(M+1, ny) references or measurements"""
        self.w: Floats = array("w")[:, :outputs]
        """(M+1, ny) weights, zero or more; new ones count from the next prepare() or advance(). With a negative one, or
        NaN, the phases return BAD_INPUT and move nothing"""
        places = transcription.places
        self._free_initial = transcription.free_initial
        self.lower = StageBounds({name: array("lower")[place] for name, place in places.items()})
        """(stages,) lower bounds by name of a bounded variable: the problem's at first"""
        self.upper = StageBounds({name: array("upper")[place] for name, place in places.items()})
        """(stages,) upper bounds, likewise"""
        self.prepare: Phase = self.workspace.function("prepare")
        """the preparation phase: linearise along the trajectory and factorise; returns a SolverStatus"""
        self.feedback: Phase = self.workspace.function("feedback")
        """the feedback phase: solve for the newest data, and move the trajectory; returns a SolverStatus"""
        self.shift: Phase = self.workspace.function("shift")
        """move trajectory and data by one sample"""

    def residuals(self) -> Residuals:
        """Return by how much the trajectory misses the optimum of the nonlinear problem; linearises along it again."""
        self.prepare()
        self.workspace.function("slope")()
        return residuals(self.workspace.array, self._free_initial)

    def solve(self, tolerance: float = 1e-6, most: int = 50) -> Solution:
        """Repeat preparation and feedback until the nonlinear problem is solved for the data that the arrays hold.

        Every step is a full one: from a start that is far off, the iteration may circle or run away. A solution is the
        best start of the next solve: it stays in `x` and `u`.

        Args:
            tolerance: largest residual allowed, in the problem's own units.
            most: of the steps.

        Returns:
            What was found. Look at `solved`; `status` is the result of the last quadratic program.
        """
        steps, status, left = 0, SolverStatus.SOLVED, self.residuals()
        while steps < most and status == SolverStatus.SOLVED and not (steps and left.largest <= tolerance):
            steps += 1
            status = SolverStatus(self.prepare() or self.feedback())
            left = self.residuals()
        return Solution(
            status=status,
            solved=status == SolverStatus.SOLVED and left.largest <= tolerance,
            steps=steps,
            x=self.x.copy(),
            u=self.u.copy(),
            residuals=left,
        )

    @property
    def status(self) -> SolverStatus:
        """Outcome of the last phase."""
        return SolverStatus(int(self.workspace.array("status")[0]))

    @property
    def iterations(self) -> int:
        """Interior-point iterations of the last feedback; 0 when no bound was in the way."""
        return int(self.workspace.array("qp.iterations")[0])

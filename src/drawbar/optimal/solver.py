"""The compiled real-time iteration: arrays to fill and read, phases to call."""

import numpy as np

from drawbar.codegen import Workspace, build
from drawbar.geometry import Floats
from drawbar.optimal.problem import ControlProblem, EstimationProblem
from drawbar.optimal.transcription import Transcription, transcribe
from drawbar.signals import SolverStatus


def write_settings(
    workspace: Workspace, problem: ControlProblem | EstimationProblem, transcription: Transcription
) -> None:
    """Write a problem's numbers into its solver's fields: bounds, weights, and what its cost has besides."""
    array, weights = workspace.array, workspace.array("w")
    array("constants")[:] = [each.value for each in transcription.constants]
    for i, (index, bound) in enumerate(transcription.bounds):
        array("qp.bound")[i] = index
        array("lower")[i], array("upper")[i] = bound.lower, bound.upper
        array("qp.soft_linear")[i], array("qp.soft_quadratic")[i] = bound.linear_penalty, bound.quadratic_penalty
    weights[:] = problem.weights
    if isinstance(problem, EstimationProblem):
        weights[-1, list(transcription.input_outputs)] = 0.0
        array("process")[:], array("window.deviation")[:] = problem.process_deviation, problem.prior_deviation
        array("common")[:] = problem.common_deviation or 0.0
        return
    weights[-1] = problem.terminal_weights
    if problem.initial_weights:
        array("root")[:] = np.diag(np.sqrt(problem.initial_weights))


class _RealTimeIteration:
    """What control and estimation share: the workspace and the phases prepare, feedback and shift."""

    def __init__(self, problem: ControlProblem | EstimationProblem, transcription: Transcription) -> None:
        self.source = transcription.source()
        """C unit of the solver"""
        self.workspace = Workspace(build(transcription.name, self.source + transcription.introspection()))
        write_settings(self.workspace, problem, transcription)
        self.workspace.function("lay_down")()
        array = self.workspace.array
        self.x: Floats = array("x")
        """(N+1, nx) state trajectory"""
        self.u: Floats = array("u")
        """(N, nu) input trajectory"""
        self.y: Floats = array("y")
        """(N+1, ny) references or measurements"""
        self.w: Floats = array("w")
        """(N+1, ny) weights"""
        self.prepare = self.workspace.function("prepare")
        self.feedback = self.workspace.function("feedback")
        self.shift = self.workspace.function("shift")

    @property
    def status(self) -> SolverStatus:
        """Outcome of the last phase."""
        return SolverStatus(int(self.workspace.array("status")[0]))

    @property
    def iterations(self) -> int:
        """Interior-point iterations of the last feedback; 0 when no bound was in the way."""
        return int(self.workspace.array("qp.iterations")[0])

    @property
    def kkt(self) -> float:
        """Relative KKT residual of the last quadratic program."""
        return float(self.workspace.array("qp.kkt")[0])


class ControlSolver(_RealTimeIteration):
    """Real-time iteration for a ControlProblem.

    Before the first sample: write `initial` and `p`, then start(). Each sample: write `initial`, `p`, `y`; feedback();
    apply u[0]; then advance().
    """

    def __init__(self, problem: ControlProblem) -> None:
        """Compile the problem's solver (or take it from the cache).

        Raises:
            SolverError: the problem contradicts itself.
            CompilerError: no compiler, or it refused the code.
        """
        self.problem = problem
        transcription = transcribe(problem)
        super().__init__(problem, transcription)
        self.p: Floats = self.workspace.array("p")
        """(N+1, np) known parameters"""
        free = bool(problem.initial_weights)
        self.initial: Floats = self.workspace.array("prior" if free else "initial")
        """(nx,) the current state, or what a free first state should be"""
        size = len(problem.initial_weights)
        self.initial_lower: Floats = self.workspace.array("lower")[:size]
        """(nx,) least first state where it is free; infinite at first"""
        self.initial_upper: Floats = self.workspace.array("upper")[:size]
        """(nx,) largest first state where it is free; infinite at first"""
        self.defects: Floats = self.workspace.array("qp.c")
        """(N, nx) by how much the trajectory's intervals do not meet, after prepare()"""

    def start(self) -> None:
        """Linearise along a trajectory that rests at `initial` under zero input."""
        self.x[:], self.u[:] = self.initial, 0.0
        self.prepare()

    def advance(self) -> None:
        """Move the plan on by one sample and prepare the next feedback."""
        self.shift()
        self.prepare()


class EstimationSolver(_RealTimeIteration):
    """Real-time iteration for an EstimationProblem.

    Each sample: write row `newest` of `y`, NaN where a value is missing; feedback(); read row `newest` of `x`; then
    advance(). The window fills from its first row on.
    """

    def __init__(self, problem: EstimationProblem, prior: Floats) -> None:
        """Compile the problem's solver (or take it from the cache) and start it at the prior.

        Args:
            problem: the problem.
            prior: (nx + np,) first guess of states and parameters.

        Raises:
            SolverError: the problem contradicts itself.
            CompilerError: no compiler, or it refused the code.
        """
        transcription = transcribe(problem)
        self.problem = problem
        super().__init__(problem, transcription)
        array = self.workspace.array
        self.slide = self.workspace.function("slide")
        self._restart = self.workspace.function("restart", pointers=1)
        self._newest = array("window.newest")
        self.root: Floats = array("root")
        """(nx, nx) upper triangular R of the arrival cost ||R (x_0 - prior)||²"""
        self.prior: Floats = array("prior")
        """(nx,) what the window's first state should be"""
        self.restart(prior)

    @property
    def newest(self) -> int:
        """Row of the newest measurement: grows until the window is full."""
        return int(self._newest[0])

    def restart(self, prior: Floats) -> SolverStatus:
        """Begin an empty window at a first guess (nx + np,) of states and parameters; say how its preparation went."""
        contiguous = np.ascontiguousarray(prior, np.float64)
        return SolverStatus(self._restart(contiguous.ctypes.data))

    def advance(self) -> SolverStatus:
        """Slide the window on by one sample, once it is full, and prepare the next feedback.

        Returns SOLVED, or what went wrong. When the oldest stage cannot be absorbed, the arrival cost starts anew: the
        first prior's deviations around the present estimate of the window's new first state.
        """
        absorbed = self.slide()
        prepared = self.prepare()
        return SolverStatus(absorbed or prepared)

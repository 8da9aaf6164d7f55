"""The compiled real-time iteration: arrays to fill and read, phases to call."""

import numpy as np

from drawbar.codegen import Workspace, build
from drawbar.geometry import Floats
from drawbar.optimal.problem import ControlProblem, EstimationProblem
from drawbar.optimal.transcription import Transcription, transcribe
from drawbar.signals import SolverStatus


class _RealTimeIteration:
    """What control and estimation share: the workspace and the phases prepare, feedback and shift."""

    def __init__(self, transcription: Transcription, part: str) -> None:
        source = transcription.source(part) + transcription.introspection()
        self.workspace = Workspace(build(transcription.name, source))
        self.workspace.function("reset")()
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
        self._set_bounds(transcription)

    def _set_bounds(self, transcription: Transcription) -> None:
        array = self.workspace.array
        for i, (index, bound) in enumerate(transcription.bounds):
            array("qp.bound")[i] = index
            array("lower")[i], array("upper")[i] = bound.lower, bound.upper
            array("qp.soft_linear")[i], array("qp.soft_quadratic")[i] = (
                bound.linear_penalty,
                bound.quadratic_penalty,
            )

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

    def __init__(self, problem: ControlProblem, part: str = "") -> None:
        """Compile the problem's solver (or take it from the cache).

        Args:
            problem: the problem.
            part: header of the runtime that makes the solver a part of the autopilot, see Transcription.source.

        Raises:
            SolverError: the problem contradicts itself.
            CompilerError: no compiler, or it refused the code.
        """
        self.problem = problem
        super().__init__(transcribe(problem), part)
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
        self._predict = self.workspace.function("predict")
        self._predicted: Floats = self.workspace.array("F")
        self.w[:-1] = problem.weights
        self.w[-1] = problem.terminal_weights
        if free:
            self.workspace.array("root")[:] = np.diag(np.sqrt(problem.initial_weights))

    def start(self) -> None:
        """Linearise along a trajectory that rests at `initial` under zero input."""
        self.x[:], self.u[:] = self.initial, 0.0
        self.prepare()

    def successor(self) -> Floats:
        """Return F(x_0, u_0, p_0) (nx,), where the model gets by the first sample's state, input and parameters.

        Between feedback() and advance() only: it takes the place of the first interval's linearisation.
        """
        self._predict()
        successor: Floats = self._predicted[0].copy()
        return successor

    def advance(self) -> None:
        """Move the plan on by one sample and prepare the next feedback."""
        self.shift()
        self.prepare()


class EstimationSolver(_RealTimeIteration):
    """Real-time iteration for an EstimationProblem.

    Each sample: write row `newest` of `y`, NaN where a value is missing; feedback(); read row `newest` of `x`; then
    advance(). The window fills from its first row on.
    """

    def __init__(self, problem: EstimationProblem, prior: Floats, part: str = "") -> None:
        """Compile the problem's solver (or take it from the cache) and start it at the prior.

        Args:
            problem: the problem.
            prior: (nx + np,) first guess of states and parameters.
            part: header of the runtime that makes the solver a part of the autopilot, see Transcription.source.

        Raises:
            SolverError: the problem contradicts itself.
            CompilerError: no compiler, or it refused the code.
        """
        transcription = transcribe(problem)
        self.problem = problem
        super().__init__(transcription, part)
        array = self.workspace.array
        self.absorb = self.workspace.function("absorb")
        self.newest = 0
        """row of the newest measurement: grows until the window is full"""
        self.root: Floats = array("root")
        """(nx, nx) upper triangular R of the arrival cost ||R (x_0 - prior)||²"""
        self.prior: Floats = array("prior")
        """(nx,) what the window's first state should be"""
        self.w[:] = problem.weights
        self.w[-1, list(transcription.input_outputs)] = 0.0
        array("process")[:] = problem.process_deviation
        self.restart(prior)

    def restart(self, prior: Floats) -> None:
        """Begin an empty window at a first guess (nx + np,) of states and parameters."""
        self._forget(prior)
        self.newest = 0
        self.x[:], self.u[:], self.y[:] = prior, 0.0, np.nan
        self.prepare()

    def advance(self) -> SolverStatus:
        """Slide the window on by one sample, once it is full, and prepare the next feedback.

        Returns SOLVED, or what went wrong. When the oldest stage cannot be absorbed, the arrival cost starts anew: the
        first prior's deviations around the present estimate of the window's new first state.
        """
        absorbed = int(SolverStatus.SOLVED)
        if self.newest < self.problem.horizon:
            self.newest += 1
        else:
            absorbed = self.absorb()
            if absorbed != SolverStatus.SOLVED:
                self._forget(self.x[1])
            self.shift()
        prepared = self.prepare()
        return SolverStatus(absorbed or prepared)

    def _forget(self, prior: Floats) -> None:
        """Let the arrival cost be the first prior's, around another point (nx + np,)."""
        self.root[:] = np.diag(1.0 / np.asarray(self.problem.prior_deviation))
        self.prior[:] = prior

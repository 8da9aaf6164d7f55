"""The compiled real-time iteration: arrays to fill and read, phases to call."""

from collections.abc import Callable

import numpy as np

from drawbar.codegen import Workspace, build
from drawbar.errors import SolverError
from drawbar.geometry import Floats
from drawbar.optimal.given import given_array
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


class ControlSolver(RealTimeIteration):
    """Real-time iteration for a ControlProblem.

    Before the first sample: write `initial` and `p`, then start(). Each sample: write `initial`, `p`, `y`; feedback();
    apply u[0]; then advance(). `lower` and `upper` hold the bounds of each bounded variable: (M,) of a state or output,
    on the stages of ControlProblem, (N,) of an input or its change: the input's name with `_change` behind it.
    """

    def __init__(self, problem: ControlProblem) -> None:
        """Compile the problem's solver (or take it from the cache).

        Raises:
            SolverError: the problem is none of control.
            CompilerError: no compiler, or it refused the code.
        """
        _check_kind(problem, ControlProblem)
        self.problem = problem
        super().__init__(problem)
        self.p: Floats = self.workspace.array("p")
        """(M+1, np) known parameters"""
        free = bool(problem.initial_weights)
        states = len(problem.model.states)
        initial = self.workspace.array("prior" if free else "initial")
        self.initial: Floats = initial[:states]
        """(nx,) the current state, or what a free first state should be"""
        self.before: Floats = initial[states : states + len(problem.changing)]
        """(changing inputs,) what is applied before u[0], of those inputs whose changes count; advance() takes it from
        the plan: write what was applied where that is something else"""
        size = len(problem.initial_weights)
        self.initial_lower: Floats = self.workspace.array("lower")[:size]
        """(nx,) least first state where it is free; infinite at first"""
        self.initial_upper: Floats = self.workspace.array("upper")[:size]
        """(nx,) largest first state where it is free; infinite at first"""
        self.defects: Floats = self.workspace.array("qp.c")[:, :states]
        """(M, nx) by how much the trajectory's intervals do not meet, after prepare()"""
        places = [each.name for each in problem.model.inputs]
        self._changing = [places.index(name) for name in problem.changing]
        self._remembered = [places.index(name) for name in problem.remembered]
        self._applied: Floats = self.workspace.array("x")[1:, states : states + len(self._remembered)]
        self.prepare, self.feedback, self.shift = self._first_preparation, self._not_started, self._not_started

    def start(self, x: Floats | None = None, u: Floats | None = None) -> None:
        """Linearise along a first trajectory.

        Args:
            x: (M+1, nx) states, such as those of an earlier Solution; None: at rest at `initial`.
            u: (N, nu) inputs, likewise; None: zero.

        Raises:
            SolverError: a trajectory of another size; one, `initial` or `p` holds what is not finite or beyond 1e12.
        """
        initial = given_array("start() needs initial written, which", self.initial, self.initial.shape)
        given_array("start() needs p written, which", self.p, self.p.shape)
        first_x = np.tile(initial, (len(self.x), 1)) if x is None else given_array("start(): x", x, self.x.shape)
        first_u = np.zeros_like(self.u) if u is None else given_array("start(): u", u, self.u.shape)
        self.x[:], self.u[:] = first_x, first_u
        self.workspace.array("qp.kept")[:] = 0
        self._applied[:] = np.repeat(self.u[:, self._remembered], self.problem.intervals_per_sample, axis=0)
        self.prepare()

    def residuals(self) -> Residuals:
        """Return by how much the trajectory misses the optimum; see RealTimeIteration.

        Raises:
            SolverError: there is no trajectory: start() comes first.
        """
        if self.feedback == self._not_started:
            self._not_started()
        return super().residuals()

    def advance(self) -> None:
        """Move the plan on by one sample and prepare the next feedback."""
        self.before[:] = self.u[0, self._changing]
        self.shift()
        self.prepare()

    def _first_preparation(self) -> int:
        """Prepare; from now on all phases are the C functions themselves."""
        function = self.workspace.function
        self.prepare, self.feedback, self.shift = function("prepare"), function("feedback"), function("shift")
        return self.prepare()

    def _not_started(self) -> int:
        raise SolverError(
            "The solver has no trajectory to start from: write initial and p, then call start() before the first "
            "feedback(), advance() or solve() (or write a trajectory into x and u and call prepare())."
        )


class EstimationSolver(RealTimeIteration):
    """Real-time iteration for an EstimationProblem.

    Each sample: write row `newest` of `y`, NaN where a value is missing; feedback(); read row `newest` of `x`; then
    advance(). The window fills from its first row on. A value beyond 1e12 is refused: feedback() returns BAD_INPUT and
    moves nothing, advance() takes the value for missing. What is smaller is used, however wrong, and a nonlinear
    model may never find back: write NaN in the place of a value that is further from what row `newest` of `x` expects
    than it can be, and restart with restart() where one got in (docs/tutorial.md). `lower` and `upper` hold
    the bounds of each bounded variable: (N+1,) of a state, (1,) of a parameter, (N,) of an input.
    """

    def __init__(self, problem: EstimationProblem, prior: Floats) -> None:
        """Compile the problem's solver (or take it from the cache) and start it at the prior.

        Args:
            problem: the problem.
            prior: (nx + np,) first guess of states and parameters.

        Raises:
            SolverError: the problem is none of estimation; the prior is missing, of another size, not finite, or
                beyond 1e12.
            CompilerError: no compiler, or it refused the code.
        """
        _check_kind(problem, EstimationProblem)
        if prior is None:
            raise SolverError(f"An estimator needs a prior: a first guess of {_names(problem)}.")
        self.problem = problem
        super().__init__(problem)
        array = self.workspace.array
        self.slide: Phase = self.workspace.function("slide")
        """move the window on by one sample, once it is full; returns a SolverStatus"""
        self._restart = self.workspace.function("restart", pointers=1)
        self._newest = array("window.newest")
        self.root: Floats = _read_only(array("root"))
        """(nx + np, nx + np) upper triangular R of the arrival cost ||R (x_0 - prior)||²; read only"""
        self.prior: Floats = _read_only(array("prior"))
        """(nx + np,) what the window's first state should be; read only"""
        if self.restart(prior) != SolverStatus.SOLVED:
            raise SolverError(f"The model cannot be linearised at the prior {self.prior.tolist()}; give another.")

    @property
    def newest(self) -> int:
        """Row of the newest measurement: grows until the window is full."""
        return int(self._newest[0])

    def restart(self, prior: Floats) -> SolverStatus:
        """Begin an empty window at a first guess, whose standard deviations are `prior_deviation`.

        Args:
            prior: (nx + np,) states, then parameters.

        Returns:
            How the preparation of the first feedback went.

        Raises:
            SolverError: the prior is of another size, not finite, or beyond 1e12.
        """
        contiguous = self._checked(prior)
        return SolverStatus(self._restart(contiguous.ctypes.data))

    def set_arrival_cost(self, prior: Floats, root: Floats) -> SolverStatus:
        """Let the arrival cost be ||R (x_0 - prior)||², in place of what the window has gathered so far.

        Args:
            prior: (nx + np,) what the window's first state should be.
            root: (nx + np, nx + np) R, upper triangular; R'R is the inverse covariance of the prior.

        Returns:
            How the preparation of the next feedback went.

        Raises:
            SolverError: prior or root are of another size, not finite, beyond 1e12; the root is not upper triangular.
        """
        upper = given_array("root", root, self.root.shape, "upper triangular")
        if np.tril(upper, -1).any():
            raise SolverError(f"root must be upper triangular, got {upper.tolist()}; give R of R'R by Cholesky.")
        self.workspace.write({"prior": self._checked(prior), "root": upper})
        return SolverStatus(self.prepare())

    def advance(self) -> SolverStatus:
        """Slide the window on by one sample, once it is full, and prepare the next feedback.

        Returns SOLVED, or what went wrong. When the oldest stage cannot be absorbed, the arrival cost restarts: the
        first prior's deviations around the present estimate of the window's new first state.
        """
        absorbed = self.slide()
        prepared = self.prepare()
        return SolverStatus(absorbed or prepared)

    def _checked(self, prior: Floats) -> Floats:
        return given_array("The prior", prior, self.prior.shape, _names(self.problem))


def _check_kind(problem: object, kind: type) -> None:
    """Refuse what is no problem of this kind."""
    if not isinstance(problem, kind):
        other = type(problem).__name__
        raise SolverError(f"A problem must be of type {kind.__name__} for this solver, got {other}; give such a one.")


def _names(problem: EstimationProblem) -> str:
    return ", ".join(variable.name for variable in problem.estimated)


def _read_only(array: Floats) -> Floats:
    view = array.view()
    view.flags.writeable = False
    return view

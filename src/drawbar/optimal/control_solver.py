"""Control solver: the compiled real-time iteration of a ControlProblem."""

import numpy as np

from drawbar.errors import SolverError
from drawbar.geometry import Floats
from drawbar.optimal.given import check_kind, given_array
from drawbar.optimal.problem import ControlProblem
from drawbar.optimal.real_time_iteration import RealTimeIteration
from drawbar.optimal.residuals import Residuals


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
        check_kind(problem, ControlProblem)
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

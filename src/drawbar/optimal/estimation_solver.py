"""Estimation solver: the compiled real-time iteration of an EstimationProblem, over a window that fills and slides."""

import numpy as np

from drawbar.errors import SolverError
from drawbar.geometry import Floats
from drawbar.optimal.given import check_kind, given_array
from drawbar.optimal.problem import EstimationProblem
from drawbar.optimal.real_time_iteration import Phase, RealTimeIteration
from drawbar.optimal.views import read_only
from drawbar.signals import SolverStatus


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
        check_kind(problem, EstimationProblem)
        if prior is None:
            raise SolverError(f"An estimator needs a prior: a first guess of {_names(problem)}.")
        self.problem = problem
        super().__init__(problem)
        array = self.workspace.array
        self.slide: Phase = self.workspace.function("slide")
        """move the window on by one sample, once it is full; returns a SolverStatus"""
        self._restart = self.workspace.function("restart", pointers=1)
        self._newest = array("window.newest")
        self.root: Floats = read_only(array("root"))
        """(nx + np, nx + np) upper triangular R of the arrival cost ||R (x_0 - prior)||²; read only"""
        self.prior: Floats = read_only(array("prior"))
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


def _names(problem: EstimationProblem) -> str:
    return ", ".join(variable.name for variable in problem.estimated)

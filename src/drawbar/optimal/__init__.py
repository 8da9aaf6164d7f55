"""Optimal control and estimation: problems as data, and the compiled real-time iteration that solves them."""

from drawbar.optimal.bound import Bound
from drawbar.optimal.control_solver import ControlSolver
from drawbar.optimal.estimation_solver import EstimationSolver
from drawbar.optimal.problem import ControlProblem, EstimationProblem
from drawbar.optimal.quadratic_program import QuadraticProgram, Sizes
from drawbar.optimal.real_time_iteration import RealTimeIteration
from drawbar.optimal.residuals import Residuals, Solution
from drawbar.optimal.unit import SolverUnit, solver_unit
from drawbar.optimal.views import StageBounds

__all__ = [
    "Bound",
    "ControlProblem",
    "ControlSolver",
    "EstimationProblem",
    "EstimationSolver",
    "QuadraticProgram",
    "RealTimeIteration",
    "Residuals",
    "Sizes",
    "Solution",
    "SolverUnit",
    "StageBounds",
    "solver_unit",
]

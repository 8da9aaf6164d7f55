"""Optimal control and estimation: problems as data, and the compiled real-time iteration that solves them."""

from drawbar.optimal.problem import Bound, ControlProblem, EstimationProblem
from drawbar.optimal.solver import ControlSolver, EstimationSolver
from drawbar.optimal.unit import SolverUnit, solver_unit

__all__ = [
    "Bound",
    "ControlProblem",
    "ControlSolver",
    "EstimationProblem",
    "EstimationSolver",
    "SolverUnit",
    "solver_unit",
]

"""Optimal control and estimation: problems as data, and the compiled real-time iteration that solves them."""

from drawbar.optimal.problem import Bound, ControlProblem, EstimationProblem
from drawbar.optimal.quadratic_program import QuadraticProgram, Sizes
from drawbar.optimal.solver import ControlSolver, EstimationSolver, RealTimeIteration
from drawbar.optimal.views import StageBounds

__all__ = [
    "Bound",
    "ControlProblem",
    "ControlSolver",
    "EstimationProblem",
    "EstimationSolver",
    "QuadraticProgram",
    "RealTimeIteration",
    "Sizes",
    "StageBounds",
]

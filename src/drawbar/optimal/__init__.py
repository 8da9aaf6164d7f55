"""Optimal control and estimation: problems as data, and the compiled real-time iteration that solves them."""

from drawbar.optimal.problem import Bound, ControlProblem, EstimationProblem
from drawbar.optimal.solver import ControlSolver, EstimationSolver

__all__ = ["Bound", "ControlProblem", "ControlSolver", "EstimationProblem", "EstimationSolver"]

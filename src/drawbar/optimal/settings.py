"""Settings: a problem's numbers, written into its compiled solver."""

import numpy as np

from drawbar.codegen import Workspace
from drawbar.optimal.problem import ControlProblem, EstimationProblem, row
from drawbar.optimal.transcription import Transcription


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
    weights[:, : len(problem.model.outputs)] = row(problem.weights, problem.model.outputs)
    if isinstance(problem, EstimationProblem):
        weights[-1, list(transcription.input_outputs)] = 0.0
        estimated = problem.estimated
        array("process")[:] = row(problem.process_deviation, estimated)
        array("window.deviation")[:] = row(problem.prior_deviation, estimated)
        array("common")[:] = row(problem.common_deviation, estimated)
        return
    weights /= transcription.held
    weights[:, len(problem.model.outputs) :] = [
        problem.change_weights[name] for name in problem.changing if name in problem.change_weights
    ]
    weights[-1] = 0.0
    weights[-1, : len(problem.model.outputs)] = row(problem.terminal_weights, problem.model.outputs)
    if problem.initial_weights:
        array("root")[:] = np.diag(np.sqrt(row(problem.initial_weights, problem.model.states)))

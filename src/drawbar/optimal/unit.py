"""A solver with what surrounds it, as a unit of the control step."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from numpy.typing import ArrayLike

from drawbar.codegen import Unit, Workspace
from drawbar.optimal.frame import SOLVER_FIELDS
from drawbar.optimal.problem import ControlProblem, EstimationProblem
from drawbar.optimal.settings import write_settings
from drawbar.optimal.solver_source import solver_source
from drawbar.optimal.transcription import transcribe


@dataclass(frozen=True, slots=True, kw_only=True)
class SolverUnit(Unit):
    """A component whose structure begins with the solver of a problem."""

    problem: ControlProblem | EstimationProblem


def solver_unit(
    name: str,
    problem: ControlProblem | EstimationProblem,
    header: str,
    settings: Mapping[str, ArrayLike] | Callable[[Workspace], None],
) -> SolverUnit:
    """Return the unit of a problem's solver.

    Args:
        name: of the unit.
        problem: the problem.
        header: that makes the solver a component, see solver_source.
        settings: the component's own, by name, or what writes them.

    Raises:
        SolverError: the problem contradicts itself.
    """
    transcription = transcribe(problem)

    def configure(workspace: Workspace) -> None:
        write_settings(workspace, problem, transcription)
        if callable(settings):
            settings(workspace)
        else:
            workspace.write(settings)

    return SolverUnit(
        name=name,
        source=solver_source(transcription, header),
        configure=configure,
        fields=SOLVER_FIELDS,
        constants="rti_constants(&component->rti)",
        problem=problem,
    )

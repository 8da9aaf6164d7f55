"""Centralised control: one problem for both bodies (the paper's CeNMPC; centralised.h)."""

from collections.abc import Mapping

from numpy.typing import ArrayLike

from drawbar.codegen import Unit
from drawbar.control.settings import Nominal
from drawbar.control.tube.tube import Tubes
from drawbar.errors import ConfigurationError
from drawbar.optimal import ControlProblem, solver_unit


def centralised_unit(
    header: str, problem: ControlProblem, tubes: Tubes, settings: Mapping[str, ArrayLike] | None = None
) -> Unit:
    """Return the controller that solves the whole vehicle's problem by the real-time iteration.

    The coupling needs no assumption here: the model holds it.

    Args:
        header: of the model.
        problem: with the bounds that the tubes leave.
        tubes: what both bodies are held by.
        settings: the model's own, by name.

    Raises:
        ConfigurationError: the tubes' nominal state is not the predicted one.
        SolverError: the problem contradicts itself.
    """
    if tubes.tractor.nominal is not Nominal.PREDICTED:
        raise ConfigurationError(
            f'tube.nominal = "{tubes.tractor.nominal}" needs one nominal problem per body; with '
            f'controller.structure = "centralised" only "predicted" is possible'
        )
    return solver_unit("controller", problem, header, settings or {})

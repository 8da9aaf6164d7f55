"""Subsystem: what the nominal controllers of either body share (subsystem.h)."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from drawbar.codegen import Unit
from drawbar.control.settings import Coupling, Nominal
from drawbar.control.tube.inner_box import initial_choice
from drawbar.control.tube.tube import SubsystemTube
from drawbar.geometry import Floats
from drawbar.optimal import ControlProblem, solver_unit

_PULL = 1e-3
"""Weight on what parts a chosen first state from where the nominal model got to: decides what nothing else does."""


def subsystem_unit(
    name: str, problem: ControlProblem, tube: SubsystemTube, header: str, settings: Mapping[str, ArrayLike]
) -> Unit:
    """Return the controller that solves one subsystem's problem by the real-time iteration.

    Args:
        name: of the unit.
        problem: with the bounds that the tube leaves, starting from a given state.
        tube: determines where the problem starts at each sample.
        header: of the body.
        settings: the body's own, by name.

    Raises:
        ConfigurationError: the nominal state shall be optimised, but there is no set to choose it from.
        SolverError: the problem contradicts itself.
    """
    states = [variable.name for variable in problem.model.states]
    start: dict[str, ArrayLike] = {"subsystem.restarts": tube.nominal is Nominal.PREDICTED}
    if tube.nominal is Nominal.OPTIMISED:
        problem = replace(problem, initial_weights=dict.fromkeys(states, _PULL))
        start |= _box(initial_choice(tube), len(states))
    return solver_unit(name, problem, header, {**settings, **start})


def coupling_settings(coupling: Coupling) -> dict[str, int]:
    """Return the setting of a trailer's coupling: enum coupling has the same order."""
    return {"coupling": list(Coupling).index(coupling)}


def _box(choice: Floats, states: int) -> dict[str, Floats]:
    """Return the settings of optimised_start.h.

    Args:
        choice: half-widths of the box that the first state may be chosen from, see initial_choice.
        states: of the model; one more than half-widths is the one along the path: it is the estimate's.
    """
    reach = np.concatenate([np.full(states - len(choice), np.inf), choice])
    return {"subsystem.reach": reach, "subsystem.half_widths": np.where(np.isfinite(reach), reach, 0.0)}

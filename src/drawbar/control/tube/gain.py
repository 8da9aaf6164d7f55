"""The gain K of an ancillary law: given, or of the discrete LQR at the nominal operating point."""

from collections.abc import Iterable

import numpy as np
from numpy.linalg import LinAlgError

from drawbar.control.matrix_equations import regulator_gain
from drawbar.control.settings import AncillaryGain, BodyTubeSettings
from drawbar.control.tube.error_model import ErrorModel
from drawbar.errors import ConfigurationError, TubeError
from drawbar.geometry import Floats

COMMAND = "command"


def gain_of(body: str, model: ErrorModel, settings: BodyTubeSettings) -> Floats:
    """Return K (n,): command (rad) per error of each state, such that u = ū + K e.

    Raises:
        ConfigurationError: a gain or weight belongs to no state of this model, or both are given.
        TubeError: the weights have no regulator.
    """
    given = {name: getattr(settings, name) for name in AncillaryGain.model_fields if getattr(settings, name)}
    if not settings.lqr:
        check_names(f"tube.{body}", given, model.states)
        return np.array([given.get(state, 0.0) for state in model.states])
    if given:
        raise ConfigurationError(
            f"tube.{body} gives {', '.join(given)} and lqr weights as well; a gain is either given or follows from "
            f"weights: leave one out"
        )
    check_names(f"tube.{body}.lqr", settings.lqr, (*model.states, COMMAND))
    if COMMAND not in settings.lqr:
        raise ConfigurationError(f"tube.{body}.lqr gives no weight of the {COMMAND}; give one, 1/rad²")
    return regulator(body, model, [settings.lqr.get(name, 0.0) for name in (*model.states, COMMAND)])


def regulator(body: str, model: ErrorModel, weights: list[float]) -> Floats:
    """Return K (n,) of the linear quadratic regulator with these weights, of every state (n) and then of the command.

    Raises:
        TubeError: no regulator is found.
    """
    A, B = model.A[0], model.B[0][:, None]
    *Q, R = weights
    try:
        return np.asarray(-regulator_gain(A, B, np.diag(Q), np.array([[R]]))[0])
    except LinAlgError as error:
        raise TubeError(
            f"tube.{body}.lqr has no regulator ({error}); give every state that does not decay by itself a weight, "
            f"and weights that differ by fewer orders of magnitude"
        ) from error


def check_names(section: str, given: Iterable[str], known: tuple[str, ...]) -> None:
    """Refuse names that the model of this body does not have.

    Raises:
        ConfigurationError: names which, and which there are.
    """
    unknown = [name for name in given if name not in known]
    if unknown:
        raise ConfigurationError(
            f"{section} has no {', '.join(unknown)} with this controller's model; it has: {', '.join(known)}"
        )

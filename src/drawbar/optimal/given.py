"""Given problems, numbers and arrays, checked: their kind, their count, and no more than can be computed with."""

from collections.abc import Sequence
from numbers import Real
from typing import Any

import numpy as np

from drawbar.errors import SolverError
from drawbar.geometry import Floats

LARGEST_INPUT = 1e12
"""magnitude of measurements, references, parameters and first states: with squares of what is more no number in a
trajectory would count any longer; solver/rti.h refuses it too"""


def check_numbers(what: str, **given: Any) -> None:
    """Raise SolverError for what is no number."""
    if wrong := [f"{name} = {value!r}" for name, value in given.items() if not isinstance(value, Real)]:
        raise SolverError(f"{what}: numbers are allowed, got {', '.join(wrong)}; give numbers.")


def check_kind(problem: object, kind: type) -> None:
    """Refuse what is no problem of this kind."""
    if not isinstance(problem, kind):
        other = type(problem).__name__
        raise SolverError(f"A problem must be of type {kind.__name__} for this solver, got {other}; give such a one.")


def given_array(what: str, values: Any, shape: Sequence[int], names: str = "") -> Floats:
    """Return what a caller gives, as contiguous numbers of this shape; `names` is what they are of, for the message.

    Raises SolverError when it is something else, or holds what is not finite or beyond LARGEST_INPUT.
    """
    try:
        array = np.ascontiguousarray(values, np.float64)
    except (TypeError, ValueError):
        array = None
    if array is None or array.shape != tuple(shape) or not (np.abs(array) <= LARGEST_INPUT).all():
        raise SolverError(
            f"{what} must be {_size(shape)} within ±{LARGEST_INPUT:g}{f', {names}' if names else ''}; got "
            f"{_shown(values, array)}."
        )
    return array


def _size(shape: Sequence[int]) -> str:
    return f"{shape[0]} finite numbers" if len(shape) == 1 else f"an array {tuple(shape)} of finite numbers"


def _shown(values: Any, array: Floats | None) -> str:
    """Return what was given, long arrays by their shape and what is wrong in them."""
    if array is None:
        return repr(values)[:100]
    wrong = array[~(np.abs(array) <= LARGEST_INPUT)]
    if array.size <= 20:
        return str(array.tolist())
    return f"shape {array.shape}" + (f" with {wrong[0]}" if wrong.size else "")

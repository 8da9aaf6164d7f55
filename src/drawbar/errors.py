"""The errors drawbar raises at its edges; inside the control loop a status is returned instead."""

import os
from numbers import Real
from pathlib import Path
from reprlib import repr as short


class DrawbarError(Exception):
    """Base of every error a user is meant to read: names what was given, what is allowed and what to do."""


class ConfigurationError(DrawbarError):
    """A configuration has an unknown, missing, duplicate or impossible value."""


class TubeError(ConfigurationError):
    """The declared disturbances leave nothing of a bound, or have no invariant set."""


class ModelError(DrawbarError):
    """A vehicle model is declared wrongly."""


class PathError(DrawbarError):
    """A path cannot be read, or cannot be driven by this vehicle."""


class SolverError(DrawbarError):
    """A solver was asked for something it cannot do, or failed outside the control loop."""


class CompilerError(DrawbarError):
    """No C compiler was found, or it refused the generated code."""


class SignalError(DrawbarError):
    """A signal holds something that is no number, or one that its field cannot hold."""


class StorageError(DrawbarError):
    """A log or report cannot be written, or not any further: the disk is full or gone."""


class HardwareError(DrawbarError):
    """A machine did not answer as its interface promises."""


def demand(what: str, value: object, kind: type, advice: str, error: type[DrawbarError] = DrawbarError) -> None:
    """Raise an error where an argument is of another type than is needed."""
    if not isinstance(value, kind):
        raise error(f"{what} must be a {kind.__name__}, got {short(value)}; {advice}.")


def demand_number(what: str, value: object, advice: str, error: type[DrawbarError] = DrawbarError) -> None:
    """Raise an error where an argument is no number."""
    if not isinstance(value, Real):
        raise error(f"{what} must be a number, got {short(value)}; {advice}.")


def demand_path(what: str, value: object, error: type[DrawbarError] = DrawbarError) -> Path:
    """Return the path of a file or folder that is given as text or path; raise an error for anything else."""
    if not isinstance(value, str | bytes | os.PathLike):
        raise error(f"{what} must be the name of a file or folder, got {short(value)}; give a text or a Path.")
    return Path(os.fsdecode(value))

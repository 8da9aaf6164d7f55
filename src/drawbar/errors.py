"""The errors drawbar raises at its edges; inside the control loop a status is returned instead."""


class DrawbarError(Exception):
    """Base of every error a user is meant to read: says what was given, what is allowed and what to do."""


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

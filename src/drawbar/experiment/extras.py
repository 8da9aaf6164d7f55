"""Extras: packages that experiments need beyond a plain installation."""

from importlib.util import find_spec

from drawbar.errors import DrawbarError
from drawbar.extras import install_command


def require_extras() -> None:
    """Raise DrawbarError, with the command that helps, when a library that experiments need is not installed."""
    missing = [name for name in ("distributed", "matplotlib", "optuna") if find_spec(name) is None]
    if missing:
        raise DrawbarError(
            f"experiments need {' and '.join(missing)}, not installed here. Run: {install_command('experiments')}"
        )

"""Extras of drawbar: what each brings, and the command that installs them into this very Python."""

import re
import shlex
import sys
from importlib.metadata import PackageNotFoundError, distribution, requires

from drawbar.errors import DrawbarError

_OF_EXTRA = re.compile(r"""(?P<requirement>[^;]+);.*\bextra\s*==\s*['"](?P<extra>[\w-]+)['"]""")
_NAME = re.compile(r"[\w.-]+")


def require_extra(who: str, *extras: str) -> None:
    """Raise DrawbarError, with the command that helps, where a package of extras is not installed.

    Args:
        who: needs them, as a sentence begins; e.g. "drawbar drive".
        extras: of pyproject.toml, e.g. "machine".
    """
    missing = [name for name in map(_package, _requirements(*extras)) if not _is_installed(name)]
    if missing:
        command = install_command(*extras)
        raise DrawbarError(f"{who} needs what is not installed here ({', '.join(missing)}); install it with: {command}")


def install_command(*extras: str) -> str:
    """Return the command that installs what extras of drawbar bring, wherever drawbar itself came from."""
    # the extra's own name would need drawbar from a registry, where it may not be
    return f"{shlex.quote(sys.executable)} -m pip install {' '.join(map(shlex.quote, _requirements(*extras)))}"


def _requirements(*extras: str) -> list[str]:
    """Return what extras ask for, each with its least version."""
    found = (_OF_EXTRA.fullmatch(line.strip()) for line in requires("drawbar") or [])
    return [each["requirement"].strip() for each in found if each and each["extra"] in extras]


def _package(requirement: str) -> str:
    """Return a requirement's package, without version and options."""
    found = _NAME.match(requirement)
    assert found is not None
    return found[0]


def _is_installed(package: str) -> bool:
    try:
        distribution(package)
    except PackageNotFoundError:
        return False
    return True

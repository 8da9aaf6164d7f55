"""Extras of drawbar: what each brings, and the command that installs them into this very Python."""

import re
import shlex
import sys
from importlib.metadata import requires

_OF_EXTRA = re.compile(r"""(?P<requirement>[^;]+);.*\bextra\s*==\s*['"](?P<extra>[\w-]+)['"]""")


def install_command(extra: str) -> str:
    """Return the command that installs what an extra of drawbar brings, wherever drawbar itself came from."""
    found = (_OF_EXTRA.fullmatch(line.strip()) for line in requires("drawbar") or [])
    named = [each["requirement"].strip() for each in found if each and each["extra"] == extra]
    # the extra's own name would need drawbar from a registry, where it may not be
    return f"{shlex.quote(sys.executable)} -m pip install {' '.join(shlex.quote(name) for name in named)}"

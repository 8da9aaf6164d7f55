"""Supervisor: watches what the controllers cannot mend (supervisor.h)."""

from drawbar.codegen import Unit
from drawbar.safety.sanity import SanitySettings

_SETTINGS = ("lost", "blind", "blind_way")


def supervisor_unit(sanity: SanitySettings) -> Unit:
    """Return the supervisor, which watches a run from its first step on."""
    settings = {name: getattr(sanity, name) for name in _SETTINGS}
    return Unit(
        name="supervisor", source='#include "supervisor.h"', configure=lambda workspace: workspace.write(settings)
    )

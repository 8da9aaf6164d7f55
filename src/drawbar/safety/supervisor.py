"""The supervisor watches what the controllers cannot mend (supervisor.h)."""

from drawbar.codegen import Unit

LOST = 5.0
"""Distance of the tractor from the path at which a run is given up, m."""
BLIND = 15.0
"""Time without a fix of either antenna after which a run is given up, s: dead reckoning is off by then."""
BLIND_WAY = 15.0
"""Way without one after which it is, m: a wrong heading leads the farther off, the farther it goes."""


def supervisor_unit() -> Unit:
    """Return the supervisor, which watches a run from its first step on."""
    settings = {"lost": LOST, "blind": BLIND, "blind_way": BLIND_WAY}
    return Unit(
        name="supervisor", source='#include "supervisor.h"', configure=lambda workspace: workspace.write(settings)
    )

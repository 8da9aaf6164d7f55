"""The ancillary law of tube-based control: u = ū + K (x - x̄) (equation robustcontrollaw; ancillary.h)."""

from drawbar.codegen import Unit, Workspace
from drawbar.control.tube.tube import SubsystemTube


def ancillary_unit(name: str, tube: SubsystemTube | None, limit: float) -> Unit:
    """Return the law that holds one body to its nominal state, and watches its tube.

    While the deviation is in the tube, and the plan within its tightened bounds, the sum respects the bound on the
    command by itself. Outside, or where no tube is declared, it is clipped to the bound and the clip is reported.

    Args:
        name: of the unit.
        tube: gain and sets; None: no law.
        limit: largest steering angle that may be commanded, rad.
    """

    def configure(workspace: Workspace) -> None:
        array = workspace.array
        array("limit")[:] = limit
        if tube is not None:
            count, facets = len(tube.gain), len(tube.heights)
            array("count")[:], array("facet_count")[:] = count, facets
            array("gain")[:count] = tube.gain
            array("facets")[:facets, :count], array("heights")[:facets] = tube.facets, tube.heights

    return Unit(name=name, source='#include "ancillary.h"', configure=configure)

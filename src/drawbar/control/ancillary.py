"""The ancillary law of tube-based control: u = ū + K (x - x̄) (equation robustcontrollaw)."""

from ctypes import byref

from drawbar.codegen.component import Component
from drawbar.control.tube.tube import SubsystemTube
from drawbar.exchange import CBodyPlan, CBodySteering
from drawbar.signals import BodyPlan, BodySteering


class AncillaryLaw:
    """Holds one body to its nominal state, whatever the neighbour and the ground did, and watches its tube.

    While the deviation is in the tube, and the plan within its tightened bounds, the sum respects the bound on the
    command by itself. Outside, or where no tube is declared, it is clipped to the bound and the clip is reported. The
    arithmetic is that of ancillary.h.
    """

    def __init__(self, tube: SubsystemTube | None, limit: float) -> None:
        """Take gain and tube (None: no law), and the largest steering angle that may be commanded, rad."""
        self.component = Component("ancillary", '#include "ancillary.h"')
        array = self.component.array
        array("limit")[:] = limit
        if tube is not None:
            count, facets = len(tube.gain), len(tube.heights)
            array("count")[:], array("facet_count")[:] = count, facets
            array("gain")[:count] = tube.gain
            array("facets")[:facets, :count], array("heights")[:facets] = tube.facets, tube.heights
        self._apply = self.component.function("apply", pointers=2)
        self._plan, self._steering = CBodyPlan(), CBodySteering()

    def apply(self, plan: BodyPlan) -> BodySteering:
        """Return the steering to command now, from the newest nominal plan and the deviation that it states."""
        self._plan.write(plan)
        self._apply(byref(self._plan), byref(self._steering))
        return self._steering.read()

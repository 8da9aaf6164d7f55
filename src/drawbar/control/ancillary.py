"""The ancillary law of tube-based control: u = ū + K (x - x̄) (equation robustcontrollaw)."""

import math

from drawbar.control.tube.tube import SubsystemTube
from drawbar.signals import BodyPlan, BodySteering


class AncillaryLaw:
    """Holds one body to its nominal state, whatever the neighbour and the ground did, and watches its tube.

    While the deviation is in the tube, and the plan within its tightened bounds, the sum respects the bound on the
    command by itself. Outside, or where no tube is declared, it is clipped to the bound and the clip is reported.
    """

    def __init__(self, tube: SubsystemTube | None, limit: float) -> None:
        """Take gain and tube (None: no law), and the largest steering angle that may be commanded, rad."""
        self._tube, self._limit = tube, limit

    def apply(self, plan: BodyPlan) -> BodySteering:
        """Return the steering to command now, from the newest nominal plan and the deviation that it states."""
        tube, ancillary, margin = self._tube, 0.0, math.nan
        if tube is not None and plan.deviation.size:
            ancillary, margin = float(tube.gain @ plan.deviation), tube.margin(plan.deviation)
        total = plan.steering + ancillary
        # what is not finite is no command to clip: it goes on to the gate, which refuses it
        command = min(max(total, -self._limit), self._limit) if math.isfinite(total) else total
        return BodySteering(
            nominal=plan.steering,
            ancillary=ancillary,
            command=command,
            saturated=abs(total) > self._limit,
            margin=margin,
        )

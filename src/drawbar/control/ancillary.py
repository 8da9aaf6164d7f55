"""The ancillary law of tube-based control: u = ū + K (x - x̄) (equation robustcontrollaw)."""

import math

from drawbar.control.settings import AncillaryGain
from drawbar.geometry import wrap
from drawbar.signals import BodyPlan, BodySteering, Pose


class AncillaryLaw:
    """Holds one body to what was predicted for it one sample ago, whatever the neighbour and the ground did.

    The error acts in the predicted heading's frame, which is the paper's "linear time varying" remark. The sum may
    exceed the bounds that the nominal plan respects; it is clipped to them and the clip is reported.
    """

    def __init__(self, gain: AncillaryGain, limit: float) -> None:
        """Take the gain and the largest steering angle that may be commanded, rad."""
        self._gain, self._limit = gain, limit
        self._predicted: tuple[float, float, float] | None = None

    def apply(self, plan: BodyPlan, pose: Pose) -> BodySteering:
        """Return the steering to command now, and remember the plan's prediction for the next sample.

        Args:
            plan: the newest nominal plan.
            pose: the estimated pose now.
        """
        ancillary = self._correction(pose)
        x, y, yaw = plan.poses[1].tolist()
        self._predicted = (x, y, yaw)
        total = plan.steering + ancillary
        # what is not finite is no command to clip: it goes on to the gate, which refuses it
        command = min(max(total, -self._limit), self._limit) if math.isfinite(total) else total
        saturated = abs(total) > self._limit
        return BodySteering(nominal=plan.steering, ancillary=ancillary, command=command, saturated=saturated)

    def _correction(self, pose: Pose) -> float:
        if self._predicted is None:
            return 0.0
        x, y, yaw = self._predicted
        lateral = math.cos(yaw) * (pose.y - y) - math.sin(yaw) * (pose.x - x)
        return self._gain.lateral * lateral + self._gain.yaw * wrap(pose.yaw - yaw)

"""Wrong yaw rate: the tractor's yaw-rate sensor contradicts the antennas or the wheels, as the control step has found.

The step (estimation/yaw_rate_sensor.h) excludes it for a minute. But the estimate has followed it before: its yaw is
some degrees wrong, so that the tractor's antenna is rejected for seconds, in which the vehicle is steered beside its
line. So the last samples are computed again without it (rollback.py).
"""

from drawbar.signals import Measurement
from drawbar.step.autopilot import Autopilot


class WrongYawRate:
    """For how long the step still excludes the yaw rate."""

    def __init__(self, autopilot: Autopilot) -> None:
        """Begin with a sensor that is right; the exclusion is read from the autopilot."""
        self._remaining = autopilot.library.components["alignment"].live.array("yaw_rate.exclusion")  # s
        self._newest = 0.0

    def update(self) -> bool:
        """Update with the newest step; return whether it has excluded the sensor."""
        before, self._newest = self._newest, float(self._remaining[0])
        return before == 0.0 < self._newest

    def excluded(self, measurement: Measurement) -> Measurement:
        """Exclude the sensor in the autopilot, as it is now, for as long as the step did; return the measurement."""
        self._remaining[0] = self._newest
        return measurement

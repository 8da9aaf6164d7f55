"""Course error: the tractor's antenna moves in another direction than the estimate says.

A receiver finds its velocity from the carrier's Doppler shift, apart from its positions. Where both agree and the
estimate does not, the estimate is astray: it has followed a wrong angle, and rejects correct fixes.
"""

import math
from collections import deque

from drawbar.driving.fault_detection.running_rms import RunningRms
from drawbar.geometry import wrap
from drawbar.messages import Fixes
from drawbar.nanoseconds import seconds
from drawbar.signals import StepRecord

_LEAST_SPEED = 0.7
"""below which noise turns a velocity, m/s"""
_LIMIT, _FACTOR = math.radians(6.0), 4.0
"""error that is too large: rad, and root mean squares, which are larger where masts swing"""
_EPOCHS = 3
"""in a row that have one"""
_PRIOR, _PRIOR_TIME = math.radians(2.0), 5.0
"""prior root mean square and its weight: rad, s"""
_KEPT, _BEYOND = 1.0, 0.1
"""for which estimates are kept, as an epoch is older than its step, and how much newer it may be, by clocks: s"""


class CourseError:
    """The error at the last epochs."""

    def __init__(self, forward: float, sample_time: float) -> None:
        """Begin without an epoch; `forward` of the tractor's antenna from the rear axle in m, `sample_time` in s."""
        self._forward = forward
        self._epoch = math.nan, math.nan  # the newest that is not judged: time, s; course, rad
        self._estimates = deque[tuple[float, float, float]]()  # times, s; yaws; directions of the antenna, rad
        self._rms = RunningRms(sample_time, prior=_PRIOR, prior_time=_PRIOR_TIME)  # rad
        self._in_a_row = 0
        """epochs with too large an error to the same side: positive, to the left"""

    @property
    def is_large(self) -> bool:
        """Whether it is too large for ground and noise."""
        return abs(self._in_a_row) >= _EPOCHS

    def clear(self) -> None:
        """Forget the estimates: they are computed again, or there are none."""
        self._estimates.clear()
        self._in_a_row = 0

    def receive_fixes(self, fixes: Fixes) -> None:
        """Take in an epoch."""
        known = fixes.tractor.speed >= _LEAST_SPEED and math.isfinite(fixes.tractor.course)
        self._epoch = (seconds(fixes.epoch), fixes.tractor.course) if known else (math.nan, math.nan)

    def update(self, record: StepRecord) -> None:
        """Update with a step."""
        estimate, (time, course) = record.estimate, self._epoch
        if not math.isfinite(estimate.time):  # there is none
            self.clear()
            return
        self._add(estimate.time, estimate.tractor.yaw, estimate.tractor_crab, estimate.speed)
        if not math.isfinite(time):
            return
        direction = self._direction(time)
        self._epoch = math.nan, math.nan
        if not math.isfinite(direction):
            return
        error = wrap(course - direction)
        sign = 0 if abs(error) < max(_LIMIT, _FACTOR * self._rms.value) else 1 if error > 0.0 else -1
        self._in_a_row = self._in_a_row + sign if self._in_a_row * sign > 0 else sign
        self._rms.add_clipped(abs(error))

    def _add(self, time: float, yaw: float, crab: float, speed: float) -> None:
        """Add an estimate; its antenna moves sideways as the yaw turns."""
        turned = 0.0
        if self._estimates and speed >= _LEAST_SPEED:
            before = self._estimates[-1]
            rate = wrap(yaw - before[1]) / (time - before[0]) if time > before[0] else 0.0
            turned = math.atan(self._forward * rate / speed)
        self._estimates.append((time, yaw, yaw + crab + turned))
        while time - self._estimates[0][0] > _KEPT:
            self._estimates.popleft()

    def _direction(self, time: float) -> float:
        """Return the estimated direction at a time, rad; NaN: it is too far from the estimates."""
        pairs = zip(list(self._estimates)[-2::-1], reversed(self._estimates), strict=False)
        for (before, _, first), (after, _, second) in pairs:
            if before <= time <= after + _BEYOND and after > before:
                return first + (time - before) / (after - before) * wrap(second - first)
        return math.nan

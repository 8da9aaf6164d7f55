"""Stuck hitch sensor: one that repeats an angle although the estimate turns.

As estimation/frozen_signal.h, by which the control step decides, a sample earlier.
"""

import math

from drawbar.driving.fault_detection.confirmation import Confirmation
from drawbar.geometry import wrap

_TURNED = 0.5
"""share of the limit of a single hitch angle by which the estimate turns while a stuck sensor does not"""
_SHIFTED = math.radians(0.7)
"""the same beside the resolution of a sensor that rarely repeats a value, rad"""
_SIMULATED = math.radians(0.5)
"""the same of the angle by wheels and joint: an estimate that follows a stuck sensor hardly turns, rad"""
_FINE, _MARGIN, _SAMPLES = 4, 4, 50
"""of such a one: longest sequence of repetitions, repetitions beyond twice that, samples until it is representative"""


class _Turn:
    """How far an angle has turned since it was begun anew."""

    def __init__(self) -> None:
        """Begin with an unknown angle."""
        self._least = self._most = math.nan

    def begin(self, angle: float) -> None:
        """Begin anew at an angle, rad; NaN: unknown."""
        self._least = self._most = angle

    def add(self, angle: float) -> float:
        """Add an angle, rad; return how far it has turned, NaN: it was unknown meanwhile."""
        if math.isnan(angle):
            self.begin(angle)
        self._least, self._most = min(self._least, angle), max(self._most, angle)
        return self._most - self._least


class StuckHitchSensor:
    """Repetitions of the newest angle, and how far the estimate, and wheels and joint, have turned it meanwhile."""

    def __init__(self, hitch_limit: float) -> None:
        """Begin without a sample; `hitch_limit` of a single hitch angle's residual in rad."""
        self._limit, self._value, self._resolution = _TURNED * hitch_limit, math.nan, math.inf
        self._estimated, self._simulated = _Turn(), _Turn()
        self._repeated = self._longest = self._moving = 0
        self._turned_away = Confirmation()

    def update(self, measured: float, estimated: float, simulated: float, *, moves: bool) -> bool:
        """Update with all three angles, rad, NaN: unknown; return whether it is stuck."""
        self._moving += moves
        if measured == self._value:
            self._repeated += moves
        else:  # also when it is missing
            if (change := abs(measured - self._value)) < self._resolution:
                self._resolution = change
            self._longest = max(self._longest, self._repeated)
            self._value, self._repeated = measured, 0
            self._estimated.begin(estimated)
            self._simulated.begin(simulated)
        turned, difference = self._estimated.add(estimated), abs(wrap(estimated - measured))
        self._turned_away.update(holds=turned > self._limit and difference > 0.5 * self._limit)
        resolution = min(self._resolution, _SHIFTED)
        is_shifted = turned > _SHIFTED + resolution or self._simulated.add(simulated) > _SIMULATED + resolution
        return self._turned_away.is_confirmed or (is_shifted and self._repeats_too_often)

    @property
    def _repeats_too_often(self) -> bool:
        """Whether a sensor of fine resolution has repeated a value more often than is plausible."""
        fine = self._moving >= _SAMPLES and self._longest <= _FINE
        return fine and self._repeated >= 2 * self._longest + _MARGIN

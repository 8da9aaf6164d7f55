"""Hand drive: a log of driving by hand, prepared for calibration, and its usable stretches."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from operator import attrgetter
from typing import Self

import numpy as np
from numpy.typing import NDArray

from drawbar.geometry import Floats
from drawbar.machine.calibration.zero import FAST, SLOW, STRAIGHT_WAY
from drawbar.recording.log import RunLog
from drawbar.signals import StepRecord

_STRAIGHT = 0.02
"""largest |curvature| of a stretch that may count as straight, 1/m"""
_TURNS = 0.03
"""least |curvature| of a circle, 1/m"""
_HELD = np.radians(1.0)
"""by which a steering that is held may differ within a second, rad"""
_CIRCLE = 6.0
"""least time of a circle, s"""
_GAP = 1.0
"""longest time between two steps of one stretch, s"""
_COLUMNS = {
    "times": "measurement.time",
    "x": "estimate.tractor.x",
    "y": "estimate.tractor.y",
    "antenna_x": "measurement.tractor_x",
    "antenna_y": "measurement.tractor_y",
    "roll": "measurement.tractor_roll",
    "trailer_yaw": "estimate.trailer.yaw",
    "trailer_antenna_x": "measurement.trailer_x",
    "trailer_antenna_y": "measurement.trailer_y",
    "trailer_roll": "measurement.trailer_roll",
    "wheel_speed": "measurement.speed",
    "front_wheels": "measurement.tractor_steering",
    "joint": "measurement.trailer_steering",
    "hitch": "measurement.hitch_angle",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class HandDrive:
    """A drive of n steps; what was not measured is NaN."""

    times: Floats
    """s"""
    x: Floats
    """of the tractor's point on the ground, m"""
    y: Floats
    yaw: Floats
    """of the tractor, rad, continuous"""
    antenna_x: Floats
    """of the tractor's antenna, m"""
    antenna_y: Floats
    roll: Floats
    """of the tractor, as its sensor shows it, rad"""
    trailer_yaw: Floats
    """rad"""
    trailer_antenna_x: Floats
    """m"""
    trailer_antenna_y: Floats
    trailer_roll: Floats
    """as its sensor shows it, rad"""
    wheel_speed: Floats
    """m/s"""
    front_wheels: Floats
    """measured, rad"""
    joint: Floats
    """measured, rad"""
    hitch: Floats
    """measured, rad"""

    @classmethod
    def of(cls, log: RunLog) -> Self:
        """Take it from the log of a drive."""
        return cls._from(log.column)

    @classmethod
    def of_records(cls, records: Sequence[StepRecord]) -> Self:
        """Take it from the steps of a drive."""
        return cls._from(lambda name: np.array([attrgetter(name)(record) for record in records], float))

    @classmethod
    def _from(cls, column: Callable[[str], Floats]) -> Self:
        columns = {field: column(name) for field, name in _COLUMNS.items()}
        return cls(yaw=np.unwrap(column("estimate.tractor.yaw")), **columns)

    def part(self, chosen: slice) -> Self:
        """Return a stretch of it."""
        return type(self)(**{field.name: getattr(self, field.name)[chosen] for field in fields(self)})

    @property
    def yaw_rates(self) -> Floats:
        """(n,) rad/s."""
        return np.asarray(np.gradient(self.yaw, self.times), float)

    @property
    def speeds(self) -> Floats:
        """(n,) over ground, forward positive, m/s."""
        east, north = np.gradient(self.x, self.times), np.gradient(self.y, self.times)
        return np.asarray(east * np.cos(self.yaw) + north * np.sin(self.yaw), float)

    @property
    def far_from_line(self) -> float:
        """Share of the steps in which nothing was estimated, although the antenna's position was known."""
        return float(np.mean(np.isfinite(self.antenna_x) & ~np.isfinite(self.x)))

    @property
    def way(self) -> float:
        """Length, m."""
        return float(np.hypot(np.diff(self.x), np.diff(self.y)).sum())

    def straights(self) -> list[Self]:
        """Return the stretches that are straight and long enough."""
        return [part for part in self._stretches(np.abs(self._curvature()) <= _STRAIGHT) if part.way >= STRAIGHT_WAY]

    def circles(self) -> list[Self]:
        """Return the stretches in which the steering was held in a curve."""
        near = np.pad(self.front_wheels, self._second // 2, mode="edge")
        around = np.lib.stride_tricks.sliding_window_view(near, 2 * (self._second // 2) + 1)
        held = np.ptp(around, axis=1) <= _HELD
        parts = self._stretches(held & (np.abs(self._curvature()) >= _TURNS))
        return [part for part in parts if part.times[-1] - part.times[0] >= _CIRCLE]

    def _curvature(self) -> Floats:
        """Return (n,) 1/m, averaged over about a second; NaN where it is too slow or too fast."""
        speeds = self.speeds
        usable = (np.abs(speeds) >= SLOW) & (np.abs(speeds) <= FAST)
        raw = np.where(usable, self.yaw_rates / np.where(usable, speeds, 1.0), np.nan)
        return np.convolve(raw, np.ones(self._second) / self._second, mode="same")

    @property
    def _second(self) -> int:
        """Steps in about a second, as many as there are at most."""
        return max(1, min(round(1.0 / max(float(np.median(np.diff(self.times))), 1e-3)), len(self.times)))

    def _stretches(self, chosen: NDArray[np.bool_]) -> list[Self]:
        """Return the stretches in which all steps are chosen and none is missing."""
        breaks = np.diff(self.times, prepend=self.times[0]) > _GAP
        ends = np.flatnonzero(np.diff(np.concatenate([[False], chosen, [False]]).astype(int)))
        stretches: list[Self] = []
        for start, stop in ends.reshape(-1, 2).tolist():
            cuts = [start, *(start + 1 + np.flatnonzero(breaks[start + 1 : stop])).tolist(), stop]
            stretches += [self.part(slice(a, b)) for a, b in pairwise(cuts) if b - a >= 3]
        return stretches

"""Driven line: the configured line or one beside it, in the direction in which the vehicle faces, and nudged. Pure.

A line beside the configured one is a path of its own, however far it is. A nudge is an offset that the autopilot keeps
from that path (line_offset.h).
"""

import math
from dataclasses import dataclass, replace
from typing import Self

from drawbar.config import Configuration
from drawbar.driving.loop.curve_limits import demand_slow_curves
from drawbar.geometry import wrap
from drawbar.guidance.demands import demand_steering
from drawbar.guidance.path import Path
from drawbar.signals import Measurement

_AWAY = math.radians(120.0)
"""from the line's direction; farther, the vehicle drives it the other way, rad"""


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivenLine:
    """A line beside the configured one. Where there are parallel lines, each is driven in both directions."""

    configuration: Configuration
    base: Path
    """the configured line"""
    path: Path
    """to drive along, or beside where it is nudged"""
    offset: float = 0.0
    """of the path, to the left of the configured line, m"""
    nudge: float = 0.0
    """from the path, to the left as the configured line leads, m"""
    against: bool = False
    """the path leads against the configured line's direction"""

    @classmethod
    def first(cls, configuration: Configuration, path: Path) -> Self:
        """Return the configured line itself.

        Raises:
            PathError: the gate would not let it be driven at the set speed.
        """
        demand_slow_curves(path, configuration)
        return cls(configuration=configuration, base=path, path=path)

    def beside(self, offset: float) -> Self:
        """Return the line so far to the left of the configured one, m, without a nudge.

        Raises:
            PathError: the vehicle cannot drive it.
        """
        path = self._drivable(offset)
        return replace(self, path=path.reversed() if self.against else path, offset=offset, nudge=0.0)

    def nudged(self, nudge: float) -> Self:
        """Return the line nudged so far to the left, m.

        Raises:
            PathError: the vehicle cannot drive it.
        """
        self._drivable(self.offset + nudge)
        return replace(self, nudge=nudge)

    @property
    def left(self) -> float:
        """To which distance the path is nudged to the left as it is driven, m."""
        return -self.nudge if self.against else self.nudge

    def _drivable(self, offset: float) -> Path:
        """Return the path so far to the left of the configured line, m. Raises PathError: it cannot be driven."""
        path = self.base.beside(offset)
        demand_slow_curves(path, self.configuration)
        demand_steering(
            path,
            self.configuration.vehicle,
            speed=self.configuration.speed,
            tolerance=self.configuration.guidance.path_tolerance,
        )
        return path

    @property
    def both_ways(self) -> bool:
        """Whether it is driven in the direction in which the vehicle faces."""
        return self.configuration.path.both_ways

    def faces_away(self, measurement: Measurement, yaw: float) -> bool:
        """Return whether this line is to be turned round for a vehicle that is seen there.

        Args:
            measurement: with both antennas or the tractor's yaw; without, the line stays as it is.
            yaw: of the line beside the vehicle, rad.
        """
        return self.both_ways and abs(wrap(_faces(measurement) - yaw)) > _AWAY

    def nearest(self, measurement: Measurement) -> tuple[Self, float]:
        """Return this line in the direction in which the vehicle faces, and the nearest arc length on it, m."""
        x, y, reach = measurement.tractor_x, measurement.tractor_y, self.configuration.guidance.maximum_start_distance
        progress, against = self.path.nearest(x, y, _faces(measurement), reach=reach, both_ways=self.both_ways)
        if self.both_ways and against:
            return replace(self, path=self.path.reversed(), against=not self.against), self.path.length - progress
        return self, progress


def _faces(measurement: Measurement) -> float:
    """Return where a vehicle faces, from the trailer's antenna to the tractor's, or by its yaw; else NaN, rad."""
    ahead = measurement.tractor_x - measurement.trailer_x, measurement.tractor_y - measurement.trailer_y
    return measurement.tractor_yaw if math.isnan(sum(ahead)) else math.atan2(ahead[1], ahead[0])

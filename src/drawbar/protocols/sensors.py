"""Sensors of wheel angle and wheel speed: from counts or volts to SI, with the fault of each. Pure, without numpy.

Left is positive, whatever the sensor's own direction. A fault is a value of `SensorFault` beside NaN; exceptions
are for a calibration that cannot be one.
"""

import math
from bisect import bisect_right
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise

from drawbar.errors import ConfigurationError

MARGIN = 0.02
"""of a potentiometer's range that its counts may lie beyond it, before it is an electrical fault"""
TABLE_POINTS = range(5, 17)
"""how many points a potentiometer's table may have"""
STILL_AFTER = 0.5
"""s without a pulse, after which a wheel stands"""
COUNTED_PULSES = 3
"""pulses between two reports, below which the time of the pulses is more precise than their number"""


class SensorFault(Enum):
    """What is wrong with a reading; the text of each is what the operator is to do."""

    NONE = "none"
    NOT_FINITE = "reports no number; check its cable"
    ELECTRICAL = "is outside its electrical range; check for a broken or shorted cable"
    TIME = "reports with a time stamp that does not increase; check its board"
    IMPOSSIBLE = "counts more pulses than a wheel can turn; check its cable for noise"


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """What a sensor reports at one instant."""

    value: float
    """rad or m/s; NaN with a fault"""
    fault: SensorFault = SensorFault.NONE


def _failed(fault: SensorFault) -> Reading:
    return Reading(value=math.nan, fault=fault)


def _fault_of(counts: float, lowest: float, highest: float) -> Reading | None:
    """Return the reading of counts that no intact sensor gives; None: they are in its range."""
    if not math.isfinite(counts):
        return _failed(SensorFault.NOT_FINITE)
    return None if lowest <= counts <= highest else _failed(SensorFault.ELECTRICAL)


@dataclass(frozen=True, slots=True, kw_only=True)
class Potentiometer:
    """A potentiometer or Hall sensor: counts to angle by a table, piecewise linear.

    Raises ConfigurationError where the table has too few or too many points, is not finite, or not monotone.
    """

    counts: tuple[float, ...]
    """(n,) increasing"""
    angles: tuple[float, ...]
    """(n,) there, rad, left positive; rising or falling throughout"""
    deviation: float = 0.0
    """standard deviation of an angle, rad"""

    def __post_init__(self) -> None:
        """Refuse what is no table."""
        if len(self.counts) != len(self.angles) or len(self.counts) not in TABLE_POINTS:
            raise ConfigurationError(
                f"a potentiometer's table has counts: {len(self.counts)}, angles: {len(self.angles)}; give as many of "
                f"both, from {TABLE_POINTS[0]} to {TABLE_POINTS[-1]}, from lock to lock."
            )
        if not all(map(math.isfinite, (*self.counts, *self.angles))) or not self.deviation >= 0.0:
            raise ConfigurationError("a potentiometer's table holds a value that is not finite; record it again.")
        steps = {
            math.copysign(1.0, after - before) if after != before else 0.0 for before, after in pairwise(self.angles)
        }
        if not all(before < after for before, after in pairwise(self.counts)) or len(steps) != 1 or 0.0 in steps:
            raise ConfigurationError(
                f"a potentiometer's counts must increase and its angles all rise or all fall; counts {self.counts}, "
                f"angles {self.angles} do not. Record them again, in one sweep from lock to lock."
            )

    @property
    def lowest(self) -> float:
        """Least counts that are no electrical fault."""
        return self.counts[0] - MARGIN * (self.counts[-1] - self.counts[0])

    @property
    def highest(self) -> float:
        """Largest counts that are no electrical fault."""
        return self.counts[-1] + MARGIN * (self.counts[-1] - self.counts[0])

    def read(self, counts: float) -> Reading:
        """Return the angle, rad."""
        if fault := _fault_of(counts, self.lowest, self.highest):
            return fault
        i = min(max(bisect_right(self.counts, counts), 1), len(self.counts) - 1)
        share = (counts - self.counts[i - 1]) / (self.counts[i] - self.counts[i - 1])
        return Reading(value=self.angles[i - 1] + share * (self.angles[i] - self.angles[i - 1]))


@dataclass(frozen=True, slots=True, kw_only=True)
class InductiveSensor:
    """An inductive sensor: volts or counts to angle by a polynomial of degree 3 at most.

    Raises ConfigurationError where it is not finite, or has no inverse over its range: its derivative changes its sign.
    """

    coefficients: tuple[float, float, float, float]
    """c0 ... c3 of angle = c0 + c1 n + c2 n² + c3 n³, rad"""
    lowest: float
    """least counts that are no electrical fault"""
    highest: float
    """largest counts that are no electrical fault"""
    deviation: float = 0.0
    """standard deviation of an angle, its hysteresis included, rad"""

    def __post_init__(self) -> None:
        """Refuse what has no inverse."""
        if not all(map(math.isfinite, (*self.coefficients, self.lowest, self.highest))) or not self.deviation >= 0.0:
            raise ConfigurationError("an inductive sensor's polynomial or range is not finite; fit it again.")
        if not self.lowest < self.highest:
            raise ConfigurationError(
                f"an inductive sensor's range {self.lowest} to {self.highest} is empty; swap them."
            )
        slopes = [self.slope(n) for n in (self.lowest, self.highest, *self._vertex())]
        if not min(slopes) * max(slopes) > 0.0:
            raise ConfigurationError(
                f"an inductive sensor's polynomial rises and falls between {self.lowest} and {self.highest} (slopes "
                f"{min(slopes):.3g} to {max(slopes):.3g} rad per count): one reading would mean two angles. Fit a "
                f"lower degree, or move the sensor so that its signal rises throughout."
            )

    def _vertex(self) -> tuple[float, ...]:
        """Return where the slope is extreme within the range."""
        _, _, c2, c3 = self.coefficients
        vertex = -c2 / (3.0 * c3) if c3 != 0.0 else math.nan
        return (vertex,) if self.lowest < vertex < self.highest else ()

    def slope(self, counts: float) -> float:
        """Return the derivative, rad per count."""
        _, c1, c2, c3 = self.coefficients
        return c1 + counts * (2.0 * c2 + 3.0 * c3 * counts)

    def read(self, counts: float) -> Reading:
        """Return the angle, rad."""
        if fault := _fault_of(counts, self.lowest, self.highest):
            return fault
        c0, c1, c2, c3 = self.coefficients
        return Reading(value=c0 + counts * (c1 + counts * (c2 + counts * c3)))


AngleSensor = Potentiometer | InductiveSensor


@dataclass(frozen=True, slots=True, kw_only=True)
class Encoder:
    """A wheel encoder's constants. Raises ConfigurationError where they cannot be any."""

    pulses_per_metre: float
    """of the wheel's way, above 0; negative: it counts down on the way forwards"""
    bits: int = 16
    """of its counter, which wraps: 16 or 32"""
    largest_speed: float = 15.0
    """m/s; more is a fault"""
    deviation: float = 0.0
    """standard deviation of a speed, m/s"""

    def __post_init__(self) -> None:
        """Refuse what no encoder has."""
        if not (math.isfinite(self.pulses_per_metre) and abs(self.pulses_per_metre) >= 1e-3):
            raise ConfigurationError(
                f"pulses_per_metre = {self.pulses_per_metre}; count the pulses of 100 m and divide."
            )
        if self.bits not in (16, 32):
            raise ConfigurationError(f"an encoder's counter has {self.bits} bits; drawbar knows those of 16 and 32.")
        if not (0.0 < self.largest_speed < math.inf) or not self.deviation >= 0.0:
            raise ConfigurationError(
                f"largest_speed = {self.largest_speed} m/s, deviation = {self.deviation} m/s; give finite ones above 0."
            )


class WheelSpeed:
    """The speed of one wheel from an encoder's reports: counter and the sensor's own time stamp.

    With three pulses or more since the last report it is their number by the time between the two stamps. With fewer it
    is reckoned back to the report three pulses ago, but no further than half a second, so that a slow wheel does not
    flicker between 0 and one pulse a report; and as long as none comes the speed cannot be more than one pulse in that
    time. After half a second without a pulse the wheel stands.
    """

    def __init__(self, encoder: Encoder) -> None:
        """Take the encoder's constants; the first report only begins."""
        self._encoder = encoder
        self._counter = 0
        self._newest = -math.inf
        self._speed = 0.0
        self._moved: list[tuple[float, int]] = []
        """(stamp, pulses in all) of the last reports with pulses, over three pulses or half a second"""

    def read(self, stamp: float, counter: int) -> Reading:
        """Return the speed, m/s, forwards positive; NaN with the first report.

        Args:
            stamp: the sensor's own time of the report, s.
            counter: pulses since its start, as it comes: it wraps.
        """
        if not math.isfinite(stamp):
            return _failed(SensorFault.NOT_FINITE)
        if not stamp > self._newest:
            return _failed(SensorFault.TIME)
        before, self._newest = self._newest, stamp
        pulses = self._difference(counter)
        self._counter = counter
        if before == -math.inf:
            self._moved = [(stamp, 0)]
            return Reading(value=math.nan)
        most = abs(self._encoder.pulses_per_metre) * self._encoder.largest_speed * (stamp - before) + 1.0
        if not abs(pulses) <= most:
            self._moved, self._speed = [(stamp, 0)], 0.0
            return _failed(SensorFault.IMPOSSIBLE)
        self._speed = self._over(before, stamp, pulses) if pulses else self._at_most(stamp - self._moved[-1][0])
        return Reading(value=self._speed)

    def _difference(self, counter: int) -> int:
        """Return the pulses since the last report, across a wrap, in either direction."""
        half = 1 << (self._encoder.bits - 1)
        return (counter - self._counter + half) % (2 * half) - half

    def _over(self, before: float, stamp: float, pulses: int) -> float:
        """Return the speed when pulses have come since the report before."""
        total = self._moved[-1][1] + pulses
        self._moved.append((stamp, total))
        while len(self._moved) > 2 and abs(total - self._moved[1][1]) >= COUNTED_PULSES:
            del self._moved[0]
        while len(self._moved) > 1 and stamp - self._moved[0][0] > STILL_AFTER:
            del self._moved[0]
        since, counted = self._moved[0] if len(self._moved) > 1 else (before, total - pulses)
        return (total - counted) / self._encoder.pulses_per_metre / (stamp - since)

    def _at_most(self, silence: float) -> float:
        """Return the speed after so many seconds without a pulse."""
        if silence >= STILL_AFTER:
            return 0.0
        most = 1.0 / (abs(self._encoder.pulses_per_metre) * silence)
        return math.copysign(min(abs(self._speed), most), self._speed)

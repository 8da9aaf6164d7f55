"""Solution of one epoch, out of the contents of its messages: the best of each kind, with its deviation; or none."""

import datetime
import math
from dataclasses import dataclass
from typing import TypeVar

from drawbar.protocols.gnss.attitude import body_attitude, choose_attitude
from drawbar.protocols.gnss.messages import Accuracy, Content, Date, Latency, Position, Turn, Velocity
from drawbar.protocols.gnss.settings import EpochSettings
from drawbar.signals import FixQuality

SIGMA = {
    FixQuality.FIXED: 0.02,
    FixQuality.FLOAT: 0.4,
    FixQuality.DIFFERENTIAL: 0.8,
    FixQuality.SINGLE: 2.5,
    FixQuality.UNKNOWN: 2.5,
}
"""standard deviation of each coordinate by quality, where the receiver reports none, m"""
SIGMA_FLOOR = 0.01
"""no fix is better than this, whatever the receiver reports, m"""
_COARSE = 1e-5 / 60.0 * 1.001
"""largest step of a fixed position, degrees: 5 decimals of minutes, 1.9 cm; with 4 it is 19 cm"""
SLOWEST_COURSE = 0.3
"""below this speed a velocity has no direction, m/s"""

_Kind = TypeVar("_Kind")


@dataclass(frozen=True, slots=True, kw_only=True)
class Solution:
    """What an epoch's messages contain together, before it is known which epochs came before it."""

    quality: FixQuality
    """of this epoch alone"""
    position: Position
    """NaN where there is no fix to drive by"""
    sigma: tuple[float, float] | None
    """reported standard deviation east and north, m; None: not reported"""
    impossible: bool
    """a position comes with a deviation that is none"""
    velocity: Velocity
    attitude: dict[str, float]
    """fields of an epoch"""
    yaw_rate: float
    """that the receiver reports, rad/s"""
    day: datetime.date | None
    latency: float
    """that the receiver reports, s"""
    refused: str
    """why there is no heading although one came; empty: nothing to report"""


def solve(contents: list[Content], settings: EpochSettings) -> Solution:
    """Return what the messages of one epoch contain together."""
    positions = sorted(_all(contents, Position), key=lambda each: (not math.isfinite(each.latitude), -each.rank))
    quality = _quality(positions)
    accuracy = max(_all(contents, Accuracy), key=lambda each: each.rank, default=Accuracy())
    velocity = max(_all(contents, Velocity), key=_completeness, default=Velocity())
    fixed = quality is FixQuality.FIXED
    attitude, refused = choose_attitude(contents, settings.antennas, position_is_fixed=fixed)
    position = _merged(positions, is_fix=quality is not FixQuality.NONE)
    return Solution(
        quality=quality,
        position=position,
        sigma=None if math.isnan(accuracy.east + accuracy.north) else (accuracy.east, accuracy.north),
        impossible=accuracy.impossible and math.isfinite(position.latitude),
        velocity=velocity if velocity.speed >= SLOWEST_COURSE else Velocity(speed=velocity.speed),
        attitude=body_attitude(attitude, contents, settings.antennas),
        yaw_rate=_first([each.yaw_rate for each in _all(contents, Turn)]),
        day=next((each.day for each in _all(contents, Date)), None),
        latency=max((each.seconds for each in _all(contents, Latency)), default=0.0),
        refused=refused,
    )


def sigma(reported: tuple[float, float] | None, quality: FixQuality, inflation: float) -> tuple[float, float]:
    """Return the standard deviation east and north (m): reported ones inflated, else by quality; NaN without fix."""
    if quality not in SIGMA:
        return math.nan, math.nan
    if reported is None:
        return SIGMA[quality], SIGMA[quality]
    east, north = (max(inflation * axis, SIGMA_FLOOR) for axis in reported)
    return east, north


def _all(contents: list[Content], kind: type[_Kind]) -> list[_Kind]:
    return [content for content in contents if isinstance(content, kind)]


def _completeness(velocity: Velocity) -> tuple[bool, bool]:
    return math.isfinite(velocity.speed), math.isfinite(velocity.course)


def _quality(positions: list[Position]) -> FixQuality:
    """Return the quality of the best message that has one; NONE where there is no position beside it.

    A fixed one whose position comes in coarse steps counts as float.
    """
    if not positions:
        return FixQuality.UNKNOWN
    if math.isnan(positions[0].latitude):
        return FixQuality.NONE
    said = [each.quality for each in positions if each.quality is not FixQuality.UNKNOWN]
    quality = said[0] if said else FixQuality.UNKNOWN
    return min(quality, FixQuality.FLOAT) if positions[0].resolution > _COARSE else quality


def _merged(positions: list[Position], *, is_fix: bool) -> Position:
    """Return the best position, with what only the others contain of it."""
    best = positions[0] if positions else Position()
    return Position(
        latitude=best.latitude if is_fix else math.nan,
        longitude=best.longitude if is_fix else math.nan,
        height=_first([each.height for each in positions]),
        resolution=best.resolution,
        satellites=next((each.satellites for each in positions if each.satellites is not None), None),
        hdop=_first([each.hdop for each in positions]),
        correction_age=_first([each.correction_age for each in positions]),
        station=next((each.station for each in positions if each.station is not None), None),
    )


def _first(values: list[float]) -> float:
    """Return the first that is not missing."""
    return next((value for value in values if not math.isnan(value)), math.nan)

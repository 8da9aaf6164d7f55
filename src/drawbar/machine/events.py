"""Events that may happen to the simulated machine during a run: time-stamped faults of the ground and of the GPS."""

from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from drawbar.geometry import Floats
from drawbar.settings import Angle, NonNegative, Positive, Settings

Crab = Annotated[Angle, Field(gt=-0.5, lt=0.5)]
"""A side-slip or offset angle, rad; at half a radian a kinematic vehicle model has long lost its meaning."""
SlipFactor = Annotated[float, Field(gt=0.0, le=1.0)]
Antenna = Literal["tractor", "trailer", "both"]
COLUMNS: dict[Antenna, slice] = {"tractor": slice(0, 2), "trailer": slice(2, 4), "both": slice(0, 4)}
"""of each, in an array of tractor x, y, trailer x, y"""

_ROUNDING = 1e-9
"""Forgives the rounding of times, so that an event at k times the sample period starts with sample k, s."""


class _Event(Settings):
    start: NonNegative
    """when it happens or begins, s"""


class SlipStep(_Event):
    """From the start on, the mean of one slip factor is another (a wet patch)."""

    kind: Literal["slip_step"] = "slip_step"
    factor: Literal["longitudinal_slip", "tractor_slip"]
    """mu or kappa"""
    value: SlipFactor
    """the new mean"""


class SideSlope(_Event):
    """From the start on, gravity adds one crab angle to all three axles."""

    kind: Literal["side_slope"] = "side_slope"
    crab: Crab
    """positive when the machine is drawn to its left, rad"""
    ramp: Positive = 1.0
    """time in which the crab grows from nothing to its full value, s"""


class Bump(_Event):
    """A blow that displaces the machine at once; the angle of the actuated joint stays."""

    kind: Literal["bump"] = "bump"
    lateral: float = 0.0
    """displacement of the tractor, and of the trailer with it, to the tractor's left, m"""
    tractor_yaw: Angle = 0.0
    """kick of the tractor's yaw about its rear axle; the free joint takes the trailer along, rad"""
    trailer_yaw: Angle = 0.0
    """kick of the yaw of drawbar and trailer about the free joint, rad"""


class GpsLoss(_Event):
    """No new fix for a while."""

    kind: Literal["gps_loss"] = "gps_loss"
    duration: Positive
    """s"""
    antenna: Antenna = "both"
    """which of them is affected"""
    report: Literal["masked", "held"] = "masked"
    """what the receiver reports meanwhile: nothing (NaN), or what it reported last"""


class GpsJump(_Event):
    """A false fix: the reported position is shifted for a while."""

    kind: Literal["gps_jump"] = "gps_jump"
    duration: Positive
    """s"""
    antenna: Antenna = "both"
    """which of them is affected"""
    east: float = 0.0
    """shift, m"""
    north: float = 0.0
    """shift, m"""


class GpsFloat(_Event):
    """RTK without resolved ambiguities: fixes are noisier for a while."""

    kind: Literal["gps_float"] = "gps_float"
    duration: Positive
    """s"""
    antenna: Antenna = "both"
    """which of them is affected"""
    deviation: Positive = 0.3
    """of each coordinate, in place of the usual noise, m"""
    correlation: NonNegative = 0.0
    """time constant of that noise; 0: white, s"""
    honest: bool = True
    """the receiver reports float and the deviation; else it continues as before"""


Event = Annotated[SlipStep | SideSlope | Bump | GpsLoss | GpsJump | GpsFloat, Field(discriminator="kind")]
ReceiverEvent = Annotated[GpsLoss | GpsJump | GpsFloat, Field(discriminator="kind")]
"""those that happen to the receivers alone"""


def active(times: Floats, start: float, duration: float = np.inf) -> NDArray[np.bool_]:
    """Return which of the times (n,) lie in [start, start + duration), forgiving their rounding."""
    elapsed = times - start + _ROUNDING
    return (elapsed >= 0.0) & (elapsed < duration)

"""Settings of one receiver: what its bytes do not contain."""

from typing import Annotated

from pydantic import Field

from drawbar.settings import Angle, Delay, NonNegative, Positive, Settings


class AntennaSettings(Settings):
    """The two antennas of a receiver that measures heading."""

    baseline: NonNegative = 0.0
    """surveyed distance of both antennas, m; 0: not known, and not compared with the measured one. On NMEA 2000, which
    reports no distance, a heading is taken for that of two antennas only where it is given; else it may be a
    compass's"""
    baseline_tolerance: Positive = 0.03
    """largest difference of the measured from the surveyed distance, m; beyond it the heading is wrong"""
    line: Angle = 0.0
    """of the direction that the receiver reports as heading, from the body's forward direction, counter-clockwise, rad;
    0: antennas behind each other, or turned by the receiver or board itself"""


class EpochSettings(Settings):
    """How a receiver's sentences become epochs."""

    latency: Delay | None = None
    """shortest time from the instant of a measurement until its first byte is here, s; what the receiver reports of it
    itself (SBF) not counted; none: 0.04, as most have 0.01 to 0.08, and 0.01 of a receiver that reports"""
    sigma_inflation: Annotated[float, Field(ge=0.5, le=10.0)] = 1.5
    """factor on reported standard deviations, which are too small as a rule; 1 once calibrated at standstill"""
    quality_hold: Annotated[float, Field(ge=0.0, le=60.0)] = 1.0
    """a better quality is accepted after it has held so long, s; a worse one at once"""
    leap_seconds: Annotated[int, Field(ge=0, le=60)] = 18
    """GPS time minus UTC, s; 18 since 2017"""
    antennas: AntennaSettings = AntennaSettings()

"""Bare valve's settings in a configuration; bare_valve.py drives it."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from drawbar.errors import ConfigurationError
from drawbar.protocols.sensors import Potentiometer
from drawbar.settings import Angle, Settings
from drawbar.transports.address import TransportText


class BareValveSettings(Settings):
    """The board of a valve or motor without a loop of its own, which `drawbar calibrate --push` moves."""

    transport: TransportText
    """where it is, e.g. serial:/dev/ttyUSB2@115200"""
    counts: Annotated[tuple[float, ...], Field(strict=False)]
    """of the front wheels' sensor, rising"""
    angles: Annotated[tuple[Angle, ...], Field(strict=False)]
    """at those counts, left positive, rad; roughly, before they are calibrated"""

    @model_validator(mode="after")
    def _sensor(self) -> Self:
        try:
            self.sensor()
        except ConfigurationError as error:
            raise ValueError(str(error)) from None
        return self

    def sensor(self) -> Potentiometer:
        """Return the sensor; raises ConfigurationError where its table cannot be one."""
        return Potentiometer(counts=self.counts, angles=self.angles)

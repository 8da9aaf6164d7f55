"""Sensor line: the settings of a sensor board, and its transport and protocol together."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from drawbar.errors import ConfigurationError
from drawbar.protocols.sensor_board import SensorBoard, SensorReport
from drawbar.protocols.sensors import AngleSensor, Encoder, InductiveSensor, Potentiometer
from drawbar.settings import Angle, Settings
from drawbar.transports.address import TransportText
from drawbar.transports.base import Transport


class SensorBoardSettings(Settings):
    """A board that measures the hitch angle, the wheels' speed, or both, as `drawbar calibrate` found them."""

    transport: TransportText
    """where its sentences come from, e.g. serial:/dev/ttyUSB1@115200"""
    hitch_counts: Annotated[tuple[float, ...], Field(strict=False)] = ()
    """of the hitch angle's converter, rising; none: it does not measure that"""
    hitch_angles: Annotated[tuple[Angle, ...], Field(strict=False)] = ()
    """at those counts, rad, tractor turned to the left of the drawbar positive"""
    hitch_polynomial: Annotated[tuple[float, float, float, float], Field(strict=False)] | None = None
    """in the place of a table, of an inductive sensor: c0 ... c3 of angle = c0 + c1 n + c2 n² + c3 n³, rad, n counts"""
    hitch_range: Annotated[tuple[float, float], Field(strict=False)] | None = None
    """least and largest counts for which the polynomial holds; what is beyond them is a broken cable"""
    pulses_per_metre: float | None = None
    """of the wheels' encoder; negative: it counts down on the way forwards; none: there is no encoder"""
    counter_bits: Literal[16, 32] = 32
    """of the encoder's counter"""

    @model_validator(mode="after")
    def _sensors(self) -> Self:
        try:
            self.board()
        except ConfigurationError as error:
            raise ValueError(str(error)) from None
        return self

    def board(self) -> SensorBoard:
        """Return the board's protocol with its calibration.

        Raises:
            ConfigurationError: the calibration cannot be one.
        """
        pulses = self.pulses_per_metre
        encoder = Encoder(pulses_per_metre=pulses, bits=self.counter_bits) if pulses is not None else None
        return SensorBoard(self._hitch(), encoder)

    def _hitch(self) -> AngleSensor | None:
        given = (self.hitch_polynomial is not None, self.hitch_range is not None)
        if any(given) and (self.hitch_counts or self.hitch_angles or not all(given)):
            raise ConfigurationError(
                "give either a table of the hitch angle, hitch_counts and hitch_angles, or both hitch_polynomial and "
                "hitch_range"
            )
        if self.hitch_polynomial is not None and self.hitch_range is not None:
            lowest, highest = self.hitch_range
            return InductiveSensor(coefficients=self.hitch_polynomial, lowest=lowest, highest=highest)
        return Potentiometer(counts=self.hitch_counts, angles=self.hitch_angles) if self.hitch_counts else None

    @property
    def measures_hitch(self) -> bool:
        """Whether it measures the hitch angle."""
        return bool(self.hitch_counts) or self.hitch_polynomial is not None


class SensorLine:
    """Reads one sensor board; `last` is its newest report."""

    def __init__(self, transport: Transport, settings: SensorBoardSettings) -> None:
        """Take the open transport."""
        self.transport, self.board = transport, settings.board()
        self.last = SensorReport(time=-math.inf, received=-math.inf)

    def poll(self) -> None:
        """Read what has come."""
        for received in self.transport.read():
            for report in self.board.push(received.data, received.time):
                self.last = report

    def close(self) -> None:
        """Give the transport back."""
        self.transport.close()

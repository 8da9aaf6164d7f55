"""Sensor line: the settings of a sensor board, and its transport and protocol together."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from drawbar.errors import ConfigurationError
from drawbar.protocols.sensor_board import SensorBoard, SensorReport
from drawbar.protocols.sensors import Encoder, Potentiometer
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
        hitch = Potentiometer(counts=self.hitch_counts, angles=self.hitch_angles) if self.hitch_counts else None
        pulses = self.pulses_per_metre
        encoder = Encoder(pulses_per_metre=pulses, bits=self.counter_bits) if pulses is not None else None
        return SensorBoard(hitch, encoder)


class SensorLine:
    """Reads one sensor board; `last` is its newest report."""

    def __init__(self, transport: Transport, settings: SensorBoardSettings) -> None:
        """Take the open transport."""
        self.transport, self.board = transport, settings.board()
        self.last = SensorReport(time=-math.inf)

    def poll(self) -> None:
        """Read what has come."""
        for received in self.transport.read():
            for report in self.board.push(received.data, received.time):
                self.last = report

    def close(self) -> None:
        """Give the transport back."""
        self.transport.close()

"""Devices of a real machine: one section of the configuration for each, with its transport and its protocol."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from drawbar.geometry import LocalFrame
from drawbar.machine.hardware.bare_valve_settings import BareValveSettings
from drawbar.machine.hardware.corrections.settings import CorrectionsSettings
from drawbar.machine.hardware.isobus import IsobusSettings
from drawbar.machine.hardware.receiver import ReceiverSettings
from drawbar.machine.hardware.sensor_line import SensorBoardSettings
from drawbar.machine.hardware.steer_board import SteerBoardSettings, refuse_equal_boards
from drawbar.settings import Settings


class OriginSettings(Settings):
    """Origin of the east-north frame of a path that has none of its own: figure-eights and CSV files."""

    latitude: Annotated[float, Field(ge=-89.0, le=89.0)] = 50.87
    """WGS84, degrees"""
    longitude: Annotated[float, Field(ge=-180.0, le=180.0)] = 4.7
    """WGS84, degrees"""

    def frame(self) -> LocalFrame:
        """Return the frame."""
        return LocalFrame(latitude=self.latitude, longitude=self.longitude)


class DeviceSettings(Settings):
    """All devices of the machine. Each body is steered by a board of AgOpenGPS's kind or by a valve on the ISOBUS."""

    tractor_receiver: ReceiverSettings
    trailer_receiver: ReceiverSettings | None = None
    """without it the tractor's has two antennas and measures its yaw, and `sensors` measures the hitch angle"""
    tractor_board: SteerBoardSettings | None = None
    """turns the front wheels"""
    trailer_board: SteerBoardSettings | None = None
    """turns the joint between drawbar and trailer"""
    isobus: IsobusSettings | None = None
    sensors: SensorBoardSettings | None = None
    """measures hitch angle, wheel speed, or both; without it the estimator does without them"""
    corrections: CorrectionsSettings | None = None
    """from a caster; what comes is written to both receivers too. Without it, the receivers have their own"""
    bare_valve: BareValveSettings | None = None
    """the front wheels' valve or motor without a loop of its own, for `drawbar calibrate --push` alone"""
    speed: Literal["driver", "isobus"] = "driver"
    """who drives: the driver, who is asked to stop, or the tractor by commands on the ISOBUS"""
    origin: OriginSettings = OriginSettings()

    @model_validator(mode="after")
    def _one_actuator_for_each_body(self) -> Self:
        for body in ("tractor", "trailer"):
            board = getattr(self, f"{body}_board") is not None
            valve = self.isobus is not None and getattr(self.isobus, f"{body}_valve") is not None
            if board == valve:
                given = "both are" if board else "none is"
                raise ValueError(
                    f"the {body} is steered by {body}_board or by isobus.{body}_valve; {given} given, give one"
                )
        refuse_equal_boards([board for board in (self.tractor_board, self.trailer_board) if board is not None])
        if self.trailer_receiver is None and not (self.sensors and self.sensors.measures_hitch):
            raise ValueError(
                "without trailer_receiver nothing shows where the trailer is; add that section, or sensors with "
                "hitch_counts and hitch_angles, and a tractor_receiver with two antennas"
            )
        if self.trailer_receiver is None and self.tractor_receiver.is_without_heading:
            raise ValueError(
                "without trailer_receiver the tractor's tells its yaw, and a heading on NMEA 2000 may be a compass's; "
                "give tractor_receiver.antennas.baseline, the distance of its two antennas, or add trailer_receiver"
            )
        self._refuse_one_line_for_two()
        if self.speed == "isobus" and self.isobus is None:
            raise ValueError('speed = "isobus" needs the section isobus; add it, or set speed = "driver"')
        return self

    @property
    def receivers_on_boards(self) -> tuple[ReceiverSettings, ...]:
        """The receivers whose datagrams come to the port where boards are listened to."""
        places = [board.listening for board in (self.tractor_board, self.trailer_board) if board is not None]
        return tuple(receiver for receiver in self.receivers if any(map(receiver.is_at, places)))

    @property
    def receivers(self) -> tuple[ReceiverSettings, ...]:
        """The tractor's, and the trailer's where there is one."""
        return tuple(each for each in (self.tractor_receiver, self.trailer_receiver) if each is not None)

    def _refuse_one_line_for_two(self) -> None:
        tractor, trailer, sensors = self.tractor_receiver, self.trailer_receiver, self.sensors
        recorded = any(each.is_recorded for each in self.receivers)
        if sensors is not None and not recorded and sensors.transport in [each.transport for each in self.receivers]:
            raise ValueError(f"a receiver and sensors have one transport, {sensors.transport}; give each its own")
        if trailer is None or tractor.transport != trailer.transport or tractor.is_recorded:
            return
        if not tractor.has_senders:
            raise ValueError(f"both receivers have one transport, {tractor.transport}; give each its own")
        senders = [tractor.sender, trailer.sender]
        if "" in senders or senders[0] == senders[1]:
            raise ValueError(
                f"two receivers at {tractor.transport} need a sender each, and different ones; given are {senders}"
            )

"""Steer board: settings of an AgOpenGPS board that turns the front wheels or the drawbar's joint."""

import ipaddress
from collections.abc import Collection, Sequence
from typing import Annotated, Self

from pydantic import AfterValidator, Field, model_validator

from drawbar.errors import ConfigurationError
from drawbar.protocols.agopengps.board_settings import SteerConfig, SteerSettings
from drawbar.protocols.agopengps.network import BOARD_PORT, COMPUTER_PORT, STEER_HOST
from drawbar.protocols.agopengps.steer_board import SteerBoard
from drawbar.settings import PositiveAngle, Settings


def _endpoint(text: str) -> str:
    host, separator, port = text.partition(":")
    try:
        ipaddress.IPv4Address(host)
    except ValueError:
        raise ValueError(f"{text!r} does not begin with an IPv4 address; write one as in 192.168.5.126:8888") from None
    if separator and not (port.isascii() and port.isdigit() and int(port) <= 0xFFFF):
        raise ValueError(
            f"{text!r} has no port between 0 and 65535 behind its colon; write one as in 192.168.5.126:8888"
        )
    return text


Endpoint = Annotated[str, AfterValidator(_endpoint)]
"""An IPv4 address with or without `:port`"""
Byte = Annotated[int, Field(ge=0, le=255)]


class BoardMemory(Settings):
    """What the board itself stores. drawbar writes it on the operator's command only, at standstill."""

    gain: Byte = 40
    """PWM per degree of error"""
    high_pwm: Byte = 60
    """largest PWM"""
    minimum_pwm: Byte = 9
    """PWM that the motor needs to move at all; AIO v4 takes 1.2 times this for its low PWM"""
    counts_per_degree: Annotated[int, Field(ge=1, le=255)] = 30
    """of the angle sensor"""
    offset: Annotated[int, Field(ge=-0x8000, le=0x7FFF)] = 0
    """of the angle sensor's centre, counts"""
    ackermann: Annotated[int, Field(ge=1, le=255)] = 100
    """per cent by which angles to the left are scaled; 100 for a joint"""
    invert_sensor: bool = False
    """counts of the angle sensor rise to the right"""
    invert_motor: bool = False
    """the motor turns to the right where the board means left"""
    single_ended: bool = True
    """the angle sensor has one signal wire, else two"""
    cytron: bool = True
    """motor driver: Cytron, else IBT2"""
    danfoss: bool = False
    """Danfoss valve in place of a motor"""
    relay_active_high: bool = False
    """relays close with a high level"""
    steer_switch: bool = False
    """a switch at the board enables its steering"""
    steer_button: bool = False
    """a button does"""
    shaft_encoder: bool = False
    """turns of the steering wheel release"""
    pressure_sensor: bool = False
    """pressure in the steering releases"""
    current_sensor: bool = False
    """current of the motor releases"""
    threshold: Byte = 5
    """counts or reading that release"""
    minimum_speed: Byte = 0
    """below which AiO_26 does not begin to steer, 0.1 km/h"""
    imu_across: bool = False
    """the IMU's Y axis is the vehicle's roll axis"""

    def frames(self) -> tuple[bytes, bytes]:
        """Return the two datagrams that make the board store this."""
        values = self.model_dump()
        loop = {name: values.pop(name) for name in SteerSettings.__dataclass_fields__ if name in values}
        return SteerSettings(**loop).encode(), SteerConfig(**values).encode()


class SteerBoardSettings(Settings):
    """One board of AgOpenGPS's kind (AIO v4, AiO_26) that turns the front wheels or the drawbar's joint."""

    address: Endpoint
    """where set points go: the board's own address, or the broadcast address of its network when it is alone there"""
    listen: Endpoint = f"0.0.0.0:{COMPUTER_PORT}"
    """where replies are taken and set points sent from; boards send to port 9999, and AiO_26 obeys that port only"""
    board: Endpoint | None = None
    """where replies come from; by default `address`, or number 126 of a broadcast's network"""
    max_angle: PositiveAngle
    """largest set point either way, rad; for the paper's joint 0.349 (20°)"""
    inverted: bool = False
    """the board's positive angle is to the left, as a sensor on a joint may be mounted"""
    memory: BoardMemory = BoardMemory()

    @model_validator(mode="after")
    def _steers_below_50_degrees(self) -> Self:
        self.actuator()
        return self

    @property
    def destination(self) -> tuple[str, int]:
        """Host and port that set points go to."""
        host, _, port = self.address.partition(":")
        return host, int(port or BOARD_PORT)

    @property
    def source(self) -> str:
        """Return where replies come from."""
        if self.board is not None:
            return self.board
        host = self.destination[0]
        network, _, last = host.rpartition(".")
        return f"{network}.{STEER_HOST}" if last == "255" else self.address

    @property
    def listening(self) -> tuple[str, int]:
        """Host and port that replies are taken at."""
        host, _, port = self.listen.partition(":")
        return host, int(port or COMPUTER_PORT)

    @property
    def receive_only(self) -> str:
        """Address of a socket for `drawbar.transports` that receives from the board, and sends nothing."""
        host, port = self.listening
        return f"udp://{host}:{port}"

    @property
    def broadcasts(self) -> str:
        """Address of a socket for `drawbar.transports` that receives what is broadcast to the board."""
        host, port = self.destination
        return f"udp://{host.rpartition('.')[0]}.255:{port}"

    @property
    def transport(self) -> str:
        """Address of the socket for `drawbar.transports`; boards that `listen` at one place share one socket.

        It may broadcast, since another board that shares it may be one that is reached so.
        """
        host, port = self.destination
        return f"{self.receive_only}?peer={host}:{port}&broadcast=1"

    def actuator(self, own: Collection[str] = ()) -> SteerBoard:
        """Return the board as the gate commands it; own: `address:port` of this computer's own sockets.

        Raises ValueError when the largest angle is beyond what boards steer to.
        """
        try:
            return SteerBoard(board=self.source, max_angle=self.max_angle, inverted=self.inverted, own=own)
        except ConfigurationError as error:
            raise ValueError(str(error)) from None


def refuse_equal_boards(boards: Sequence[SteerBoardSettings]) -> None:
    """Raise ConfigurationError when two boards answer from, or are commanded at, one address."""
    for place, board in enumerate(boards):
        for other in boards[:place]:
            if _overlap(board.source, other.source) or board.destination == other.destination:
                raise ConfigurationError(
                    f"two steer boards have one address ({other.address} and {board.address}, replies from "
                    f"{other.source} and {board.source}): both would obey every set point; give each board a network "
                    "of its own, as AgOpenGPS's AgIO sets it"
                )


def _overlap(one: str, other: str) -> bool:
    """Return whether a sender can be both; an address without a port is every port of it."""
    (host_1, _, port_1), (host_2, _, port_2) = one.partition(":"), other.partition(":")
    return host_1 == host_2 and (port_1 == port_2 or not (port_1 and port_2))

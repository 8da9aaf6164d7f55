"""Stand-in board: the clock, the wires and the sensor that the stand-ins of both firmwares share."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from drawbar.machine.stand_in.wheel import Wheel
from drawbar.protocols.agopengps.board_settings import SteerConfig, SteerSettings
from drawbar.protocols.agopengps.frame import CONSTANT, PREFIX, STEER_BOARD, Pgn, checksum

_FIRST_TICK = 0.001
"""after the start, s"""
_SAME = 1e-9
"""times nearer than this are the same, s"""
_CENTRE = 6805
"""half of the converter's counts with the wheel straight"""


@dataclass(frozen=True, slots=True)
class Output:
    """One datagram of a board."""

    time: float
    data: bytes
    destination: str


class StandInBoard(ABC):
    """A steer board without its electronics: datagrams and its own ticks in, datagrams and a turned wheel out.

    Everything happens at the times given, s of any clock that does not go back. `receive` comes before the tick of the
    same instant, as on the board.
    """

    TICK: ClassVar[float]
    """period of its loop, s"""
    SLOWEST: ClassVar[float]
    """speed below which it does not turn the wheel, km/h"""

    driving = False
    """the motor is on"""
    pwm = 0
    """what the motor gets, -255 to 255, positive to the left"""

    def __init__(
        self,
        wheel: Wheel,
        *,
        subnet: str = "192.168.5",
        start: float = 0.0,
        sensor_counts: float = 30.0,
        sensor_offset: int = 0,
    ) -> None:
        """Switch the board on at `start`, s.

        Args:
            wheel: what it turns.
            subnet: the first three numbers of its address.
            start: time of power on.
            sensor_counts: true counts per degree of the wheel angle sensor, negative where it is mounted the other way.
            sensor_offset: true counts of the sensor with the wheel straight, from its centre.
        """
        self.wheel = wheel
        self.subnet = subnet
        self.settings = SteerSettings()
        self.config = SteerConfig()
        self._sensor_counts, self._sensor_offset = sensor_counts, sensor_offset
        self._outputs: list[Output] = []
        self.restart(start)

    def restart(self, time: float, outage: float = 0.0) -> None:
        """Restart `outage` s after `time`, with the settings that it has stored; until then it is off."""
        self._start, self._ticks = time + outage, 0
        self.driving, self.pwm = False, 0
        self._boot()

    @property
    def set_point(self) -> float | None:
        """The angle it turns to, rad, left positive, for a machine whose steering follows; None: it releases."""
        return -math.radians(self._target) if self.driving and self._speed >= self.SLOWEST else None

    _target = 0.0
    """set point, degrees, right positive"""
    _speed = 0.0
    """of the vehicle, as received, km/h"""

    @property
    def next_tick(self) -> float:
        """Time of the next tick, s."""
        return self._start + _FIRST_TICK + self._ticks * self.TICK

    def advance(self, time: float) -> list[Output]:
        """Do the ticks up to `time`, and return what was sent."""
        self._run_to(time + _SAME)
        return self._sent()

    def receive(self, time: float, datagram: bytes, port: int = 9999) -> list[Output]:
        """Take in a datagram from a computer's `port`, after the ticks before `time`; return what was sent."""
        self._run_to(time - _SAME)
        if time >= self._start - _SAME:
            self._take(time, datagram, port)
        return self._sent()

    def _run_to(self, end: float) -> None:
        while self.next_tick < end:
            time = self.next_tick
            self._ticks += 1
            self._tick(time)
            self.wheel.turn(-self.pwm if self.config.invert_motor else self.pwm, self.TICK)

    def _sent(self) -> list[Output]:
        outputs, self._outputs = self._outputs, []
        return outputs

    def _send(self, time: float, pgn: int, data: bytes, *, constant: bool = False, everywhere: bool = False) -> None:
        frame = PREFIX + bytes((STEER_BOARD, pgn, len(data))) + data
        last = CONSTANT if constant else checksum(frame)
        address = "255.255.255.255" if everywhere else f"{self.subnet}.255"
        self._outputs.append(Output(time, frame + bytes((last,)), f"{address}:9999"))

    def _send_address(self, time: float) -> None:
        subnet = bytes(int(number) for number in self.subnet.split("."))
        self._send(time, Pgn.SCAN_REPLY, subnet + b"\x7e" + subnet, everywhere=True)

    def _move(self, time: float, numbers: bytes) -> None:
        """Take the address of another subnet and restart."""
        self.subnet = ".".join(str(number) for number in numbers)
        self.restart(time)

    def _counts(self) -> int:
        """Return half of the converter's counts: the wheel's angle, quantised."""
        right = -math.degrees(self.wheel.angle)
        return _CENTRE + self._sensor_offset + round(right * self._sensor_counts)

    def _measured(self) -> float:
        """Return the angle as the firmware computes it, degrees, right positive; infinite with 0 counts per degree."""
        settings, counts = self.settings, self._counts() - _CENTRE
        position = settings.offset - counts if self.config.invert_sensor else counts + settings.offset
        if settings.counts_per_degree == 0:
            return math.copysign(math.inf, position) if position else 0.0
        angle = position / settings.counts_per_degree
        return angle * settings.ackermann / 100.0 if angle < 0.0 else angle

    @abstractmethod
    def _boot(self) -> None:
        """Set what the firmware remembers to what it is after power on."""

    @abstractmethod
    def _take(self, time: float, datagram: bytes, port: int) -> None:
        """Take in a datagram."""

    @abstractmethod
    def _tick(self, time: float) -> None:
        """Do one round of the firmware's loop."""

    @abstractmethod
    def press(self, *, pressed: bool) -> None:
        """Press or release the operator's steer button."""

    @abstractmethod
    def override(self) -> None:
        """Let the operator turn the steering wheel so that encoder, pressure or current notices."""

"""Bare valve: a valve or motor of the front wheels that takes a drive, with their sensor, as a calibration moves it."""

import math
import select
import time
from collections.abc import Callable
from dataclasses import dataclass

from drawbar.machine.calibration.pushing import CalibratedMachine, Sensed
from drawbar.machine.hardware.bare_valve_settings import BareValveSettings
from drawbar.protocols.bare_valve import ValveBoard, ValveReport, drive_sentence
from drawbar.transports.base import Transport

_SILENCE = 0.15
"""longest wait for a report, s; a calibration bears 0.2"""
_LOOK = 0.005
"""between two looks at a transport, s"""
_FRESH = 1.0
"""oldest speed, s"""


@dataclass(frozen=True, slots=True)
class Motion:
    """How the tractor moves, by its receiver; NaN: unknown."""

    time: float
    """monotonic, of the measurement, s"""
    speed: float
    """m/s"""
    yaw_rate: float
    """counter-clockwise, rad/s"""


class BareValve(CalibratedMachine):
    """The board on its transport."""

    def __init__(
        self,
        transport: Transport,
        settings: BareValveSettings,
        *,
        wheelbase: float,
        motion: Callable[[], Motion],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Take the open transport, the wheelbase (m), the tractor's motion, and the monotonic clock (s)."""
        self._transport, self._sensor, self._board = transport, settings.sensor(), ValveBoard()
        self._wheelbase, self._motion, self._clock = wheelbase, motion, clock
        self._last_motion, self._rolled = -math.inf, Motion(-math.inf, math.nan, math.nan)

    def sense(self) -> Sensed:
        """Wait for the next report."""
        end = self._clock() + _SILENCE
        report = self._newest()
        while report is None and self._clock() < end:
            self._motion()  # a receiver's bytes are to be read as they come
            self._wait()
            report = self._newest()
        motion = self._motion()
        if math.isfinite(motion.speed):
            self._rolled = motion  # an epoch may come without a speed
        now = self._clock()
        speed = self._rolled.speed if now - self._rolled.time <= _FRESH else math.nan
        if report is None:
            return Sensed(time=now, angle=math.nan, speed=speed, permitted=True)
        return Sensed(
            time=report.time,
            angle=self._sensor.read(report.counts).value,
            speed=speed,
            permitted=report.permitted,
            by_yaw=self._by_yaw(motion),
        )

    def drive(self, drive: float) -> None:
        """Drive it."""
        self._transport.write(drive_sentence(drive))

    def off(self) -> None:
        """Switch it off."""
        self.drive(0.0)

    def close(self) -> None:
        """Give the transport back."""
        self._transport.close()

    def _newest(self) -> ValveReport | None:
        reports = [each for got in self._transport.read() for each in self._board.push(got.data, got.time)]
        return reports[-1] if reports else None

    def _wait(self) -> None:
        descriptor = self._transport.fileno()
        select.select([descriptor] if descriptor >= 0 else [], [], [], _LOOK)

    def _by_yaw(self, motion: Motion) -> float:
        """Return the steering angle by yaw rate and speed, once for each report of the receiver, rad."""
        if motion.time <= self._last_motion or not motion.speed > 0.0:
            return math.nan
        self._last_motion = motion.time
        return math.atan(self._wheelbase * motion.yaw_rate / motion.speed)

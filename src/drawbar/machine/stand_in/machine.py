"""Stand-in machine: a simulated tractor and trailer behind the bytes of its receivers and boards.

It moves on by the times it is given; the wires, sockets or memory, are its owner's.
"""

import datetime
import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drawbar.geometry import LocalFrame
from drawbar.machine.stand_in.bare_valve import StandInBareValve
from drawbar.machine.stand_in.board import Output, StandInBoard
from drawbar.machine.stand_in.can_machine import CanMachine
from drawbar.machine.stand_in.driver import Driver
from drawbar.machine.stand_in.receiver import Encoder, Report, of_quality
from drawbar.machine.stand_in.wheel import HeldWheel
from drawbar.machine.stand_in.world import TICK, World
from drawbar.protocols.sensor_board import sentence
from drawbar.signals import FixQuality, Truth
from drawbar.vehicle.parameters import BODIES

_SAME = 1e-9
"""times nearer than this are the same, s"""
SENSORS = "sensors"
"""name of the sensor board's line"""
BARE_VALVE = "bare valve"
"""name of its line"""
HITCH_COUNTS = (0.0, 1024.0, 2048.0, 3072.0, 4096.0)
"""of its converter"""
COUNTS_PER_RADIAN = 1600.0
"""of the hitch angle's converter"""
HITCH_ANGLES = tuple((counts - 2048.0) / COUNTS_PER_RADIAN for counts in HITCH_COUNTS)
"""rad"""
PULSES = 100.0
"""of its encoder, per metre"""
_OLDEST = 600.0
"""largest age of corrections that receivers report, s"""
_REPORTS = 0.04
"""between two sentences of the sensor board, s"""
_BEGAN = datetime.datetime(2026, 6, 1, 6, 0, tzinfo=datetime.UTC)
"""when its receivers' clocks begin"""


@dataclass(frozen=True, slots=True, kw_only=True)
class StandInSettings:
    """How the devices behave."""

    epochs: float = 0.2
    """between two epochs of a receiver, s"""
    latency: float = 0.03
    """from an epoch to the first byte of its messages, s"""
    speed_sigma: float = 0.02
    """standard deviation of the speed over ground, m/s"""
    correction_age: float = 1.0
    """of receivers that have corrections of their own, s"""
    holds: float = 60.0
    """how long a receiver keeps its RTK fix without corrections, s"""


@dataclass(frozen=True, slots=True, kw_only=True)
class StandInDevices:
    """Devices of the machine."""

    boards: dict[str, tuple[StandInBoard, HeldWheel]]
    """of the bodies that one steers, each with the wheel that it measures"""
    encoders: dict[str, Encoder]
    """make a receiver's bytes of what it reports, by body"""
    can: CanMachine | None = None
    """steers the other bodies, and takes the speed; None: there is no ISOBUS"""
    valve: StandInBareValve | None = None
    """turns the front wheels while commanded; None: there is none"""


class StandInMachine:
    """The machine: `advance` it to a time, take what its devices have sent, give the boards what was sent to them."""

    def __init__(
        self,
        world: World,
        frame: LocalFrame,
        devices: StandInDevices,
        *,
        driver: Driver,
        settings: StandInSettings,
        seed: int,
    ) -> None:
        """Take the components.

        Args:
            world: with the simulated machine.
            frame: of the path.
            devices: between the world and the wires.
            driver: who drives.
            settings: of the receivers.
            seed: of the noise of their speeds.
        """
        self._rng = np.random.default_rng(seed)
        self.world, self.driver = world, driver
        self.boards, self.encoders, self.can, self.valve = devices.boards, devices.encoders, devices.can, devices.valve
        self._frame, self._settings = frame, settings
        self._ticks = self._epochs = self._reports = 0
        self._way = 0.0
        self._yaws = dict.fromkeys(BODIES, 0.0)
        """of the inertial sensors, from their own zero, rad; NaN: there is none"""
        self._leaving: deque[tuple[float, str, bytes]] = deque()
        self.quality = dict.fromkeys(BODIES, FixQuality.FIXED)
        """what the receivers report"""
        self.corrected: dict[str, float] = {}
        """when corrections came last, s, by body; only of receivers that have no RTK fix without"""
        self.silent: set[str] = set()
        """devices that are not streamed: `sensors`, `tractor board`, `trailer board`"""
        self.delay = 0.0
        """by which what receivers send leaves later than it should, s"""
        self.hitch_counts: Callable[[int], int | None] = lambda right: right
        """what the sensor board reports of the hitch, given what is right; None: nothing"""
        self.pulses: Callable[[int], int] = lambda right: right
        """the same of the wheels"""
        self.by_hand: Callable[[Truth], float | None] = lambda truth: None
        """where the driver turns the front wheels while he creeps and nothing steers, rad; None: he leaves them"""

    @property
    def time(self) -> float:
        """Time up to which it has moved on, s."""
        return self._ticks * TICK

    @property
    def driving(self) -> int:
        """How many steerings follow set points: boards that turn their wheel, valves that are engaged."""
        valves = self.can.valves.values() if self.can else ()
        return sum(board.driving for board, _ in self.boards.values()) + sum(valve.engaged for valve in valves)

    @property
    def next_time(self) -> float:
        """When something happens next, s."""
        times = [self._ticks * TICK, *(board.next_tick for board, _ in self.boards.values())]
        return min([*times, *(leaves for leaves, _, _ in self._leaving)])

    def advance(self, time: float) -> tuple[list[tuple[str, bytes]], list[tuple[str, Output]]]:
        """Let everything happen up to a time, s; return the receivers' bytes and the boards' datagrams."""
        sent: list[tuple[str, Output]] = []
        while self._ticks * TICK <= time + _SAME:
            self._tick(self._ticks * TICK)
            self._ticks += 1
        for body, (board, _) in self.boards.items():
            sent += self._said(body, board.advance(time))
        streamed: list[tuple[str, bytes]] = []
        due = [each for each in self._leaving if each[0] <= time + _SAME]
        self._leaving = deque(each for each in self._leaving if each[0] > time + _SAME)
        streamed += [(line, data) for _, line, data in due if line not in self.silent]
        return streamed, sent

    def receive(self, time: float, body: str, datagram: bytes, port: int) -> list[tuple[str, Output]]:
        """Give a board a datagram from a computer's port; return what it answers at once."""
        board, _ = self.boards[body]
        return self._said(body, board.receive(time, datagram, port))

    def _said(self, body: str, outputs: list[Output]) -> list[tuple[str, Output]]:
        return [] if f"{body} board" in self.silent else [(body, output) for output in outputs]

    def _tick(self, time: float) -> None:
        points = {body: board.set_point for body, (board, _) in self.boards.items()}
        points |= self.can.set_points() if self.can else {}
        steered = all(board.driving for board, _ in self.boards.values())
        steered &= self.can is None or all(valve.engaged for valve in self.can.valves.values())
        pushed = self.valve.turn(time, self.world.truth.tractor_steering, TICK) if self.valve else None
        if pushed is not None:
            points["tractor"] = pushed
        self.driver.tick(time, steered, self.can.speed(time) if self.can else None, pushed=pushed is not None)
        if points["tractor"] is None and self.driver.creeps:
            points["tractor"] = self.by_hand(self.world.truth)
        if self._ticks:
            self.world.tick(points["tractor"], points["trailer"], self.driver.speed)
            self._turn()
        truth = self.world.truth
        angles = {"tractor": truth.tractor_steering, "trailer": truth.trailer_steering}
        for body, (_, wheel) in self.boards.items():
            wheel.hold(angles[body])
        if self.can:
            self.can.step(time, angles, truth.speed)
        self._way += TICK * truth.speed
        if self.valve:
            self._leaving.append((time, BARE_VALVE, self.valve.report(time)))
        if time + _SAME >= self._reports * _REPORTS:
            self._reports += 1
            self._sense(time)
        if time + _SAME >= self._epochs * self._settings.epochs:
            self._epochs += 1
            self._report(time)

    def _turn(self) -> None:
        """Let the inertial sensors add up what they have felt in a tick."""
        for body in BODIES:
            self._yaws[body] += TICK * getattr(self.world.measurement, f"{body}_yaw_rate")

    def _sense(self, time: float) -> None:
        """Let the sensor board report."""
        counts = round(2048.0 + COUNTS_PER_RADIAN * self.world.measurement.hitch_angle)
        said = (self.hitch_counts(counts), self.pulses(int(self._way * PULSES)))
        self._leaving.append((time, SENSORS, sentence(round(time * 1e3), *said)))

    def _report(self, time: float) -> None:
        """Let both receivers measure now; their bytes leave later."""
        measured, moved = self.world.measurement, self._settings
        for body, x, y in (
            ("tractor", measured.tractor_x, measured.tractor_y),
            ("trailer", measured.trailer_x, measured.trailer_y),
        ):
            known, (speed, course) = math.isfinite(x + y), self.world.velocity(body)
            age = time - self.corrected[body] if body in self.corrected else moved.correction_age
            latitude, longitude = (float(each) for each in self._frame.level(x, y)) if known else (0.0, 0.0)
            report = Report(
                time=_BEGAN + datetime.timedelta(seconds=round(time, 3)),
                latitude=latitude,
                longitude=longitude,
                height=0.0,
                speed=abs(speed + self._rng.normal(0.0, moved.speed_sigma)),
                course=course,
                yaw=measured.tractor_yaw if body == "tractor" else math.nan,
                roll=getattr(measured, f"{body}_roll"),
                pitch=-getattr(measured, f"{body}_pitch"),  # nose up there
                inertial_yaw=self._yaws[body],
                yaw_rate=getattr(measured, f"{body}_yaw_rate"),
                correction_age=min(age, _OLDEST),
            )
            report = of_quality(report, self._quality(body, age) if known else FixQuality.NONE)
            leaves = time + moved.latency + self.delay
            self._leaving += [(leaves, body, frame) for frame in self.encoders[body](report)]

    def _quality(self, body: str, age: float) -> FixQuality:
        """Return the quality that a receiver reports, with corrections of an age, s."""
        return min(self.quality[body], FixQuality.SINGLE if age > self._settings.holds else FixQuality.FIXED)

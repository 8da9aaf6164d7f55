"""Faults of a stand-in machine: what breaks at a receiver, a board, a steering or the bus, and when.

Each is put in by a function of the machine, once; `drawbar stand-in --fault` and the experiment `faults` use the same.
"""

import math
import random
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from drawbar.errors import ConfigurationError
from drawbar.machine.stand_in.machine import BODIES, SENSORS, StandInMachine
from drawbar.machine.stand_in.receiver import Encoder, Report
from drawbar.machine.stand_in.wheel import HeldWheel
from drawbar.signals import FixQuality

ReportChange = Callable[[Report, float], Report]
"""what a receiver reports instead, given its report and the time since the fault began, s"""
AngleChange = Callable[[float, float], float]
"""where a steering turns to, given its set point and its true angle, rad"""
LIST = "list"
"""in the place of a fault's name: tell which there are"""
_METRES_PER_DEGREE = 111_200.0


def report_otherwise(machine: StandInMachine, change: ReportChange, bodies: Iterable[str] = BODIES) -> None:
    """Let receivers report something else from now on."""
    start = machine.time

    def otherwise(before: Encoder) -> Encoder:
        return lambda report: before(change(report, machine.time - start))

    for body in bodies:
        machine.encoders[body] = otherwise(machine.encoders[body])


def send_otherwise(machine: StandInMachine, change: Callable[[bytes], list[bytes]], bodies: Iterable[str]) -> None:
    """Let each piece of receivers' bytes be replaced from now on."""

    def otherwise(before: Encoder) -> Encoder:
        return lambda report: [each for piece in before(report) for each in change(piece)]

    for body in bodies:
        machine.encoders[body] = otherwise(machine.encoders[body])


def moved(report: Report, machine: StandInMachine, left: float) -> Report:
    """Return a report of a place so many metres to the left of the tractor's way."""
    yaw = machine.world.truth.tractor.yaw
    east, north = -left * math.sin(yaw), left * math.cos(yaw)
    return replace(
        report,
        latitude=report.latitude + north / _METRES_PER_DEGREE,
        longitude=report.longitude + east / _METRES_PER_DEGREE / math.cos(math.radians(report.latitude)),
    )


def freeze(machine: StandInMachine, bodies: Iterable[str]) -> None:
    """Let receivers report the same again and again from now on, time included."""
    for body in bodies:
        kept: list[Report] = []

        def again(report: Report, since: float, kept: list[Report] = kept) -> Report:
            kept.append(report)
            return kept[0]

        report_otherwise(machine, again, [body])


def steer_otherwise(machine: StandInMachine, body: str, change: AngleChange) -> None:
    """Let a steering turn to something else than its set point from now on."""
    world = machine.world
    before = world.tick

    def tick(tractor: float | None, trailer: float | None, speed: float) -> None:
        truth = world.truth
        if body == "tractor" and tractor is not None:
            tractor = change(tractor, truth.tractor_steering)
        if body == "trailer" and trailer is not None:
            trailer = change(trailer, truth.trailer_steering)
        before(tractor, trailer, speed)

    world.tick = tick  # type: ignore[method-assign]


def measure_the_same(machine: StandInMachine, body: str) -> None:
    """Let a board measure the same angle from now on: its loop turns the wheel until that is right, or to the stop."""
    board, wheel = machine.boards[body]
    stuck = wheel.angle
    machine.boards[body] = (board, HeldWheel(stuck))
    steer_otherwise(machine, body, lambda wanted, true: true + 4.0 * (wanted - stuck))


def _garbage(machine: StandInMachine) -> None:
    chance = random.Random(0)
    send_otherwise(machine, lambda piece: [chance.randbytes(len(piece))], BODIES)


def _float(machine: StandInMachine) -> None:
    machine.quality = dict.fromkeys(BODIES, FixQuality.FLOAT)


def _cut(machine: StandInMachine) -> None:
    assert machine.can is not None
    machine.can.cut()


def _any(machine: StandInMachine) -> bool:
    return True


def _front_board(machine: StandInMachine) -> bool:
    return "tractor" in machine.boards


@dataclass(frozen=True, slots=True, kw_only=True)
class DeviceFault:
    """One that can be put into a stand-in machine."""

    text: str
    """what happens"""
    begin: Callable[[StandInMachine], None]
    possible: Callable[[StandInMachine], bool] = _any


FAULTS = {
    "receivers-silent": DeviceFault(
        text="both receivers fall silent", begin=lambda machine: send_otherwise(machine, lambda piece: [], BODIES)
    ),
    "receiver-silent": DeviceFault(
        text="the tractor's receiver falls silent",
        begin=lambda machine: send_otherwise(machine, lambda piece: [], BODIES[:1]),
    ),
    "receivers-garbage": DeviceFault(text="both receivers send garbage", begin=_garbage),
    "fixes-jump": DeviceFault(
        text="both receivers' positions jump 1 m to the left",
        begin=lambda machine: report_otherwise(machine, lambda report, since: moved(report, machine, 1.0)),
    ),
    "fixes-frozen": DeviceFault(
        text="both receivers repeat their last epoch", begin=lambda machine: freeze(machine, BODIES)
    ),
    "fixes-float": DeviceFault(text="both receivers lose their fixed ambiguities: quality float", begin=_float),
    "corrections-lost": DeviceFault(
        text="corrections come no more: their age grows",
        begin=lambda machine: report_otherwise(
            machine, lambda report, since: replace(report, correction_age=report.correction_age + since)
        ),
    ),
    "sensors-silent": DeviceFault(
        text="the sensor board falls silent", begin=lambda machine: machine.silent.add(SENSORS)
    ),
    "board-silent": DeviceFault(
        text="the front wheels' board says nothing, and steers on",
        begin=lambda machine: machine.silent.add("tractor board"),
        possible=_front_board,
    ),
    "wheels-stuck": DeviceFault(
        text="the front wheels stay where they are",
        begin=lambda machine: steer_otherwise(machine, "tractor", lambda wanted, true: true),
    ),
    "angle-stuck": DeviceFault(
        text="the front wheels' board measures the same angle",
        begin=lambda machine: measure_the_same(machine, "tractor"),
        possible=_front_board,
    ),
    "bus-off": DeviceFault(text="the ISOBUS is cut", begin=_cut, possible=lambda machine: machine.can is not None),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedFault:
    """A fault and when it begins."""

    name: str
    after: float | None
    """it has first been steered, s; None: from the start"""


def planned_fault(text: str) -> PlannedFault:
    """Return what `NAME` (from the start) or `NAME@20s` (20 s after it has first been steered) means.

    Raises:
        ConfigurationError: there is no such fault, or that is no time; lists those that there are.
    """
    name, at, time = text.partition("@")
    if name not in FAULTS:
        raise ConfigurationError(f"--fault {text}: there is no fault {name!r}; there are: {', '.join(FAULTS)}")
    try:
        after = float(time.removesuffix("s")) if at else None
    except ValueError:
        after = math.nan
    if after is not None and not 0.0 <= after < math.inf:
        raise ConfigurationError(f"--fault {text}: {time!r} is no time in seconds; give for example {name}@20s")
    return PlannedFault(name=name, after=after)


class FaultPlan:
    """Puts faults into a machine when they are due."""

    def __init__(self, faults: Sequence[PlannedFault], machine: StandInMachine) -> None:
        """Take the faults.

        Raises:
            ConfigurationError: the machine does not have the device that one is a fault of.
        """
        for fault in faults:
            if not FAULTS[fault.name].possible(machine):
                raise ConfigurationError(
                    f"--fault {fault.name}: the configuration's devices have nothing that could break so "
                    f"({FAULTS[fault.name].text})"
                )
        self._machine, self._coming = machine, list(faults)
        self._steered = math.inf

    def look(self) -> list[str]:
        """Put in what is due now; return what happens, in words."""
        machine = self._machine
        if machine.driver.steered:
            self._steered = min(self._steered, machine.time)
        due = [each for each in self._coming if each.after is None or machine.time >= self._steered + each.after]
        self._coming = [each for each in self._coming if each not in due]
        for each in due:
            FAULTS[each.name].begin(machine)
        return [FAULTS[each.name].text for each in due]

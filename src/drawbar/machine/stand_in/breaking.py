"""Breaking: how devices of a stand-in machine are made to report, measure and steer otherwise than they should.

Each is put in by a function of the machine, once; faults.py names those that can be asked for.
"""

import math
import random
from collections.abc import Callable, Iterable
from dataclasses import replace

from drawbar.machine.stand_in.machine import StandInMachine
from drawbar.machine.stand_in.receiver import Encoder, Report
from drawbar.vehicle.parameters import BODIES

ReportChange = Callable[[Report, float], Report]
"""what a receiver reports instead, given its report and the time since the fault began, s"""
AngleChange = Callable[[float, float], float]
"""where a steering turns to, given its set point and its true angle, rad"""
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


def measure_otherwise(
    machine: StandInMachine, body: str, change: Callable[[float], float], *, loop: bool = True
) -> None:
    """Let a board measure another angle than its wheel's true one, rad, from now on.

    Its position loop goes by what it measures: it turns the wheel until that is right, or to the stop. Without `loop`
    the wheel still stands where it should.
    """
    _, wheel = machine.boards[body]
    wheel.shows = change
    wheel.hold(wheel.angle)
    if loop:
        steer_otherwise(machine, body, lambda wanted, true: true + 4.0 * (wanted - wheel.angle))


def measure_more_and_more(machine: StandInMachine, body: str, rate: float) -> None:
    """Let a board measure an angle further and further to the left, rad/s, from now on."""
    start = machine.time
    measure_otherwise(machine, body, lambda true: true + rate * (machine.time - start))


def measure_the_same(machine: StandInMachine, body: str) -> None:
    """Let a board measure the same angle from now on."""
    stuck = machine.boards[body][1].angle
    measure_otherwise(machine, body, lambda true: stuck)


def hold_hitch(machine: StandInMachine) -> None:
    """Let the hitch's counts stay as they are."""
    kept: list[int] = []

    def stuck(right: int) -> int:
        kept.append(right)
        return kept[0]

    machine.hitch_counts = stuck


def drift_hitch(machine: StandInMachine, rate: float) -> None:
    """Let the hitch's counts become more and more, 1/s."""
    start = machine.time
    machine.hitch_counts = lambda right: right + round(rate * (machine.time - start))


def scale_wheel_speed(machine: StandInMachine, by: int) -> None:
    """Let the wheels' pulses come so many times as often."""
    kept: list[int] = []

    def scaled(right: int) -> int:
        kept.append(right)
        return kept[0] + by * (right - kept[0])

    machine.pulses = scaled


def lose_epochs(machine: StandInMachine, share: float) -> None:
    """Let a share of the receivers' epochs be lost, each receiver's by itself."""

    def otherwise(before: Encoder, chance: random.Random) -> Encoder:
        return lambda report: [] if chance.random() < share else before(report)

    for body in BODIES:
        machine.encoders[body] = otherwise(machine.encoders[body], random.Random(body))


def swap_receivers(machine: StandInMachine) -> None:
    """Let each receiver report what the other should."""
    last: dict[str, Report] = {}

    def otherwise(before: Encoder, body: str, other: str) -> Encoder:
        def encode(report: Report) -> list[bytes]:
            last[body] = report
            return before(replace(last.get(other, report), time=report.time))

        return encode

    one, two = BODIES
    for body, other in ((one, two), (two, one)):
        machine.encoders[body] = otherwise(machine.encoders[body], body, other)

"""Faults of a stand-in machine: what breaks at a receiver, a sensor, a board, a steering, the bus or the driver.

`drawbar stand-in --fault` and the experiment `faults` use the same.
"""

import math
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from drawbar.machine.stand_in.breaking import (
    drift_hitch,
    freeze,
    hold_hitch,
    lose_epochs,
    measure_more_and_more,
    measure_otherwise,
    measure_the_same,
    moved,
    report_otherwise,
    scale_wheel_speed,
    send_otherwise,
    steer_otherwise,
    swap_receivers,
)
from drawbar.machine.stand_in.machine import COUNTS_PER_RADIAN, SENSORS, StandInMachine
from drawbar.signals import FixQuality
from drawbar.vehicle.parameters import BODIES

_KNOTS = 3600.0 / 1852.0
"""of a metre per second"""
_DRIFT = math.radians(2.0)
"""of an angle's sensor, rad/s"""


def _garbage(machine: StandInMachine) -> None:
    chance = random.Random(0)
    send_otherwise(machine, lambda piece: [chance.randbytes(len(piece))], BODIES)


def _quality(quality: FixQuality) -> Callable[[StandInMachine], None]:
    def begin(machine: StandInMachine) -> None:
        machine.quality = dict.fromkeys(BODIES, quality)

    return begin


def _drift(rate: float, bodies: Sequence[str] = BODIES) -> Callable[[StandInMachine], None]:
    """Let positions drift to the left, m/s."""
    return lambda machine: report_otherwise(machine, lambda report, since: moved(report, machine, rate * since), bodies)


def _jump(left: float, bodies: Sequence[str] = BODIES) -> Callable[[StandInMachine], None]:
    return lambda machine: report_otherwise(machine, lambda report, since: moved(report, machine, left), bodies)


def _hitch(change: Callable[[int], int]) -> Callable[[StandInMachine], None]:
    def begin(machine: StandInMachine) -> None:
        machine.hitch_counts = change

    return begin


def _delay(machine: StandInMachine) -> None:
    machine.delay = 0.4


def _stay_seated(machine: StandInMachine) -> None:
    machine.driver.reaction = math.inf


def _cut(machine: StandInMachine) -> None:
    assert machine.can is not None
    machine.can.cut()


@dataclass(frozen=True, slots=True, kw_only=True)
class DeviceFault:
    """One that can be put into a stand-in machine."""

    text: str
    """what happens"""
    begin: Callable[[StandInMachine], None]
    needs: str = ""
    """setting of the devices without which nothing could break so"""


FAULTS = {
    "receivers-silent": DeviceFault(
        text="both receivers fall silent",
        begin=lambda machine: send_otherwise(machine, lambda piece: [], BODIES),
    ),
    "receiver-silent": DeviceFault(
        text="the tractor's receiver falls silent",
        begin=lambda machine: send_otherwise(machine, lambda piece: [], BODIES[:1]),
    ),
    "receivers-garbage": DeviceFault(
        text="both receivers send garbage",
        begin=_garbage,
    ),
    "receivers-late": DeviceFault(
        text="both receivers' epochs come 0.4 s later",
        begin=_delay,
    ),
    "receivers-swapped": DeviceFault(
        text="each receiver reports what the other should",
        begin=swap_receivers,
        needs="trailer_receiver",
    ),
    "epochs-lost": DeviceFault(
        text="a fifth of both receivers' epochs are lost",
        begin=lambda machine: lose_epochs(machine, 0.2),
    ),
    "fixes-jump": DeviceFault(
        text="both receivers' positions jump 1 m to the left",
        begin=_jump(1.0),
    ),
    "fix-jumps": DeviceFault(
        text="the tractor's positions jump 1 m to the left",
        begin=_jump(1.0, BODIES[:1]),
    ),
    "fixes-drift": DeviceFault(
        text="both receivers' positions drift to the left by 0.3 m/s",
        begin=_drift(0.3),
    ),
    "fixes-drift-slowly": DeviceFault(
        text="both receivers' positions drift to the left by 0.05 m/s",
        begin=_drift(0.05),
    ),
    "fix-drifts": DeviceFault(
        text="the tractor's positions drift to the left by 0.3 m/s",
        begin=_drift(0.3, BODIES[:1]),
    ),
    "fixes-frozen": DeviceFault(
        text="both receivers repeat their last epoch",
        begin=lambda machine: freeze(machine, BODIES),
    ),
    "fixes-float": DeviceFault(
        text="both receivers lose their fixed ambiguities: quality float",
        begin=_quality(FixQuality.FLOAT),
    ),
    "fixes-lost": DeviceFault(
        text="both receivers have no position any more",
        begin=_quality(FixQuality.NONE),
    ),
    "corrections-lost": DeviceFault(
        text="corrections come no more: their age grows",
        begin=lambda machine: report_otherwise(
            machine, lambda report, since: replace(report, correction_age=report.correction_age + since)
        ),
    ),
    "speed-in-knots": DeviceFault(
        text="both receivers report their speed in knots",
        begin=lambda machine: report_otherwise(
            machine, lambda report, since: replace(report, speed=_KNOTS * report.speed)
        ),
    ),
    "sensors-silent": DeviceFault(
        text="the sensor board falls silent",
        begin=lambda machine: machine.silent.add(SENSORS),
        needs="sensors",
    ),
    "hitch-stuck": DeviceFault(
        text="the hitch sensor reports the same angle",
        begin=hold_hitch,
        needs="sensors.hitch_counts",
    ),
    "hitch-drifts": DeviceFault(
        text="the hitch sensor drifts to the left by 2°/s",
        begin=lambda machine: drift_hitch(machine, _DRIFT * COUNTS_PER_RADIAN),
        needs="sensors.hitch_counts",
    ),
    "hitch-reversed": DeviceFault(
        text="the hitch sensor has the wrong sign",
        begin=_hitch(lambda right: 4096 - right),
        needs="sensors.hitch_counts",
    ),
    "hitch-broken": DeviceFault(
        text="the hitch sensor reports the end of its range",
        begin=_hitch(lambda right: 0),
        needs="sensors.hitch_counts",
    ),
    "wheel-speed-zero": DeviceFault(
        text="the wheels' encoder does not count",
        begin=lambda machine: scale_wheel_speed(machine, 0),
        needs="sensors.pulses_per_metre",
    ),
    "board-silent": DeviceFault(
        text="the front wheels' board says nothing, and steers on",
        begin=lambda machine: machine.silent.add("tractor board"),
        needs="tractor_board",
    ),
    "board-restarts": DeviceFault(
        text="the joint's board loses its power for half a second",
        begin=lambda machine: machine.boards["trailer"][0].restart(machine.time, outage=0.5),
        needs="trailer_board",
    ),
    "operator-steers": DeviceFault(
        text="the operator turns the steering wheel",
        begin=lambda machine: machine.boards["tractor"][0].override(),
        needs="tractor_board",
    ),
    "wheels-stuck": DeviceFault(
        text="the front wheels stay where they are",
        begin=lambda machine: steer_otherwise(machine, "tractor", lambda wanted, true: true),
    ),
    "wheels-reversed": DeviceFault(
        text="the front wheels turn the wrong way",
        begin=lambda machine: steer_otherwise(machine, "tractor", lambda wanted, true: true - 4.0 * (wanted - true)),
    ),
    "wheels-off": DeviceFault(
        text="the front wheels stand 3° to the left of their set point",
        begin=lambda machine: steer_otherwise(machine, "tractor", lambda wanted, true: wanted + math.radians(3.0)),
    ),
    "joint-stuck": DeviceFault(
        text="the joint stays where it is",
        begin=lambda machine: steer_otherwise(machine, "trailer", lambda wanted, true: true),
    ),
    "angle-stuck": DeviceFault(
        text="the front wheels' board measures the same angle",
        begin=lambda machine: measure_the_same(machine, "tractor"),
        needs="tractor_board",
    ),
    "angle-off": DeviceFault(
        text="the front wheels' board measures 5° too far to the left",
        begin=lambda machine: measure_otherwise(machine, "tractor", lambda true: true + math.radians(5.0)),
        needs="tractor_board",
    ),
    "angle-drifts": DeviceFault(
        text="what the front wheels' board measures drifts to the left by 2°/s",
        begin=lambda machine: measure_more_and_more(machine, "tractor", _DRIFT),
        needs="tractor_board",
    ),
    "angle-reversed": DeviceFault(
        text="the front wheels' board measures with the wrong sign",
        begin=lambda machine: measure_otherwise(machine, "tractor", lambda true: -true),
        needs="tractor_board",
    ),
    "joint-angle-stuck": DeviceFault(
        text="the joint's board measures the same angle",
        begin=lambda machine: measure_the_same(machine, "trailer"),
        needs="trailer_board",
    ),
    "joint-angle-drifts": DeviceFault(
        text="what the joint's board measures drifts to the left by 2°/s",
        begin=lambda machine: measure_more_and_more(machine, "trailer", _DRIFT),
        needs="trailer_board",
    ),
    "driver-stays": DeviceFault(
        text="the driver does not stop when told to",
        begin=_stay_seated,
    ),
    "bus-off": DeviceFault(
        text="the ISOBUS is cut",
        begin=_cut,
        needs="isobus",
    ),
}

"""Navigation and sampler behind receivers' stand-ins: what a machine measures of its attitude arrives."""

import datetime
import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import pytest
from receiver_frames import nmea, sbf, ubx

from drawbar.config import load_configuration
from drawbar.driving.stand_in.memory_transports import MemoryBus, MemoryTransport
from drawbar.driving.stand_in.stand_in_machine import stand_in_machine
from drawbar.geometry import LocalFrame
from drawbar.machine.base import MachineWithTruth
from drawbar.machine.hardware.navigation import Navigation
from drawbar.machine.hardware.receiver import Receiver, ReceiverSettings
from drawbar.machine.hardware.sampler import Sampler
from drawbar.machine.hardware.sensor_line import SensorLine
from drawbar.machine.stand_in.faults import FAULTS
from drawbar.machine.stand_in.machine import StandInMachine
from drawbar.machine.stand_in.nmea2000 import nmea2000
from drawbar.machine.stand_in.receiver import Encoder, Report
from drawbar.machine.stand_in.world import TICK, World
from drawbar.messages import Fixes
from drawbar.messages.records import decode, encode
from drawbar.protocols.sensor_board import SensorReport
from drawbar.signals import Command, FixQuality, Measurement, Pose, Truth
from drawbar.simulation import build_path
from drawbar.vehicle.parameters import BODIES

FRAME = LocalFrame(latitude=50.87, longitude=4.7)
LEFT = 0.1
"""rad/s"""
SAMPLE = 0.2
"""s"""


class Circling(MachineWithTruth):
    """A tractor that turns left at 0.1 rad/s, leans to the right and climbs; its trailer turns right."""

    def __init__(self, *, senses: bool = True) -> None:
        self.time, self.senses = 0.0, senses

    def read(self) -> Measurement:
        x, y = 10.0 * math.sin(LEFT * self.time), 10.0 - 10.0 * math.cos(LEFT * self.time)
        places = {"tractor_x": x, "tractor_y": y, "trailer_x": x - 5.0, "trailer_y": y}
        angles = {"hitch_angle": 0.0, "speed": 1.0, "tractor_steering": 0.1, "trailer_steering": 0.0}
        sensed = {"tractor_roll": 0.05, "tractor_pitch": 0.03, "tractor_yaw_rate": LEFT}
        sensed |= {"trailer_roll": -0.02, "trailer_pitch": 0.0, "trailer_yaw_rate": -LEFT}
        return Measurement(time=self.time, **places, **angles, **(sensed if self.senses else {}))

    def write(self, command: Command) -> None:
        self.time += TICK

    def stop(self) -> None:
        pass

    def truth(self) -> Truth:
        names = (
            "tractor_steering",
            "trailer_steering",
            "tractor_slip",
            "steering_offset",
            "tractor_crab",
            "trailer_crab",
        )
        tractor, trailer = Pose(x=0.0, y=0.0, yaw=LEFT * self.time), Pose(x=-5.0, y=0.0, yaw=0.0)
        still = dict.fromkeys(names, 0.0)
        return Truth(time=self.time, tractor=tractor, trailer=trailer, speed=1.0, longitudinal_slip=1.0, **still)


def machine_of(*, senses: bool = True) -> StandInMachine:
    configuration = load_configuration("articulated", [f"sample_time={SAMPLE}"])
    path, _ = build_path(configuration)
    machine = stand_in_machine(configuration, path, FRAME, 0, MemoryBus([], lambda: 0.0))
    machine.world = World(Circling(senses=senses), configuration.vehicle)
    return machine


class Board(SensorLine):
    """A sensor board that reports every 20 ms what it is told to."""

    def __init__(self) -> None:
        self.now, self.last = 0.0, SensorReport(time=-math.inf, received=-math.inf)

    def poll(self) -> None:
        if self.now - self.last.time >= 0.02:
            self.last = SensorReport(time=self.now, received=self.now, hitch_angle=0.1, wheel_speed=1.5)


def measured(
    machine: StandInMachine, transport: str, seconds: float, board: Board | None = None
) -> Iterator[Measurement]:
    """Yield what is measured at each sample; one whose epoch does not come is taken without."""
    lines = {body: MemoryTransport() for body in BODIES}
    settings = ReceiverSettings(transport=transport)
    tractor, trailer = (Receiver(lines[body], settings) for body in BODIES)
    navigation, sampler = Navigation((tractor, trailer), FRAME, board), Sampler(SAMPLE)
    start = machine.time
    for step in range(round(seconds / 0.005)):
        now = start + 0.005 * step
        for line, data in machine.advance(now)[0]:
            if line in lines:
                lines[line].arrive(now + 10.0, data)
        if board is not None:
            board.now = now + 10.0
        found = [sampler.take(fixes) for fixes in over_the_channel(navigation.poll(now + 10.0))]
        late = sampler.deadline is not None and (now + 10.0) * 1e9 > sampler.deadline
        yield from (each for each in found if each is not None)
        if late:
            yield sampler.miss()


def over_the_channel(sent: list[Fixes]) -> Iterator[Fixes]:
    for fixes in sent:
        received = decode(encode(fixes), Fixes)
        assert isinstance(received, Fixes)
        yield received


def septentrio(report: Report) -> list[bytes]:
    return sbf.blocks(replace(report, yaw=report.inertial_yaw))


def two_antennas(report: Report) -> list[bytes]:
    return nmea.sentences(replace(report, yaw=report.inertial_yaw))


TENTHS = math.radians(0.1)


@pytest.mark.parametrize(
    ("encoder", "transport", "step", "age"),
    [
        (None, "file:memory", TENTHS / SAMPLE, SAMPLE / 2.0),
        (lambda report: [nmea.panda(report)], "file:memory", TENTHS / SAMPLE, SAMPLE / 2.0),
        (two_antennas, "file:memory", 2e-6, 0.0),
        (septentrio, "file:memory", 1e-6, 0.0),
        (nmea2000(0x20), "can:virtual:x", 1e-6, 0.0),
    ],
)
def test_a_machine_that_turns_left_measures_that(
    encoder: Encoder | None, transport: str, step: float, age: float
) -> None:
    machine = machine_of()
    for body in BODIES if encoder else ():
        machine.encoders[body] = encoder
    samples = list(measured(machine, transport, 3.0))[2:]
    assert len(samples) >= 10
    for each in samples:
        assert each.tractor_yaw_rate == pytest.approx(LEFT, abs=step)
        assert each.trailer_yaw_rate == pytest.approx(-LEFT, abs=step)
        ages = (each.tractor_attitude_age - each.tractor_fix_age, each.trailer_attitude_age - each.trailer_fix_age)
        assert ages == pytest.approx((age, age), abs=1e-6)
        assert (each.tractor_roll, each.tractor_pitch) == pytest.approx((0.05, 0.03), abs=TENTHS / 2.0)
        assert each.trailer_roll == pytest.approx(-0.02, abs=TENTHS / 2.0)


def test_a_machine_without_sensors_of_attitude_measures_none() -> None:
    for each in measured(machine_of(senses=False), "file:memory", 1.0):
        assert all(math.isnan(value) for value in (each.tractor_yaw_rate, each.trailer_yaw_rate, each.tractor_roll))


@pytest.mark.parametrize("name", ["fixes-frozen", "receivers-silent", "receivers-garbage"])
def test_what_a_broken_receiver_says_is_no_yaw_rate_as_it_is_no_roll(name: str) -> None:
    machine = machine_of()
    *_, before = measured(machine, "file:memory", 1.0)
    assert math.isfinite(before.tractor_yaw_rate + before.tractor_roll)
    FAULTS[name].begin(machine)
    after = list(measured(machine, "file:memory", 2.0))
    assert all(math.isnan(each.tractor_yaw_rate) for each in after[1:])
    assert all(math.isnan(each.tractor_roll) for each in after[1:])


def test_a_sensor_board_is_heard_by_itself_once_the_receivers_are_silent() -> None:
    machine, samples = machine_of(), list[Measurement]()
    for each in measured(machine, "file:memory", 4.0, Board()):
        samples.append(each)
        if len(samples) == 5:
            FAULTS["receivers-silent"].begin(machine)
    silent = [each for each in samples if math.isnan(each.tractor_x)]
    assert len(silent) > 12
    steps = [after.time - before.time for before, after in pairwise(silent)]
    assert steps == pytest.approx([SAMPLE] * len(steps), abs=1e-9)
    assert math.isnan(silent[0].speed)  # whether an epoch is only late is not known yet
    assert {(each.hitch_angle, each.speed) for each in silent[1:]} == {(0.1, 1.5)}
    assert all(each.hitch_angle_age <= 0.02 for each in silent[1:])
    assert not any(math.isfinite(each.trailer_x) for each in silent)


def test_a_last_report_of_the_sensor_board_comes_out_when_it_is_due() -> None:
    machine, lines, board = machine_of(), [MemoryTransport() for _ in BODIES], Board()
    receivers = [Receiver(line, ReceiverSettings(transport="file:memory")) for line in lines]
    navigation, now, start = Navigation(receivers, FRAME, board), 0.0, machine.time
    for step in range(400):
        now = 10.0 + 0.005 * step
        board.now = now
        for name, data in machine.advance(start + 0.005 * step)[0]:
            if name in BODIES:
                lines[list(BODIES).index(name)].arrive(now, data)
        navigation.poll(now)
    found = list[Fixes]()
    while (due := navigation.due) < math.inf:  # nothing comes any more, neither bytes nor reports
        assert due >= now
        assert not navigation.poll(math.nextafter(due, 0.0))
        found, now = navigation.poll(due), due
    (last,) = found
    assert math.isnan(last.tractor.x)
    assert last.wheel_speed == 1.5
    assert not navigation.poll(now + 5.0)


def test_a_sensor_board_alone_begins_nothing() -> None:
    machine = machine_of()
    FAULTS["receivers-silent"].begin(machine)
    assert not list(measured(machine, "file:memory", 2.0, Board()))


def test_satellites_are_reported_as_far_as_a_receiver_tells_them() -> None:
    machine, lines = machine_of(), {body: MemoryTransport() for body in BODIES}
    tractor, trailer = (Receiver(lines[body], ReceiverSettings(transport="file:memory")) for body in BODIES)
    navigation, told = Navigation((tractor, trailer), FRAME), []
    start = machine.time
    for step in range(400):
        now = start + 0.005 * step
        for line, data in machine.advance(now)[0]:
            if line == BODIES[0]:  # the trailer's is silent
                lines[line].arrive(now + 10.0, data)
        told += over_the_channel(navigation.poll(now + 10.0))
    assert {(each.tractor.satellites, each.trailer.satellites) for each in told} == {(20, 0)}


def test_epochs_with_corrections_of_any_age_reach_the_controller() -> None:
    transport, epochs = MemoryTransport(), {}
    navigation = Navigation([Receiver(transport, ReceiverSettings(transport="serial:/dev/none@115200"))], FRAME)
    for second, age in enumerate((1.0, 100.0, 300.0)):
        report = Report(
            time=datetime.datetime(2026, 11, 22, 12, 0, second, tzinfo=datetime.UTC),
            latitude=50.87,
            longitude=4.7,
            height=100.0,
            quality=FixQuality.FIXED,
            correction_age=age,
        )
        transport.arrive(float(second), ubx.pvt(report))
        (fixes,) = navigation.poll(second + 0.1)
        received = decode(encode(fixes), Fixes)
        assert isinstance(received, Fixes)
        epochs[age] = received.tractor.correction_age
    assert epochs == {1.0: 0.5, 100.0: 105.0, 300.0: 600.0}  # the middle of each class

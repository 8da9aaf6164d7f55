"""The stand-in valve and tractor against drawbar's own actuator: on a wire without time, and on buses of python-can."""

import math
import os
import socket
import threading
import time
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest
from can_adapter import Wire, two_ends

from drawbar.machine.stand_in.can_devices import CanDevices
from drawbar.machine.stand_in.tractor_ecu import StandInTractor
from drawbar.machine.stand_in.valve import StandInValve
from drawbar.protocols.actuator import Readiness, SteeringReport, SteeringRequest
from drawbar.protocols.isobus.address import CLAIM, AddressClaim
from drawbar.protocols.isobus.curvature import TableCurvature, WheelbaseCurvature
from drawbar.protocols.isobus.guidance import GuidanceValve
from drawbar.protocols.isobus.guidance_messages import MACHINE_INFO, SYSTEM_COMMAND, ExitReason
from drawbar.protocols.isobus.identifier import decode
from drawbar.protocols.isobus.name import Name
from drawbar.protocols.isobus.node import IsobusNode
from drawbar.protocols.isobus.speed_command import SpeedCommand
from drawbar.protocols.isobus.tractor import Tractor
from drawbar.transports.base import CanBus, CanFrame

TICK = 0.01
JOINT = TableCurvature([(-0.4, -0.25), (0.0, 0.0), (0.4, 0.2)])


def node(identity: int, address: int) -> IsobusNode:
    return IsobusNode(AddressClaim(Name(identity=identity, manufacturer=1407, function=29), address))


class Cab:
    """Drawbar's side of a bus: two valves and the tractor under one node."""

    def __init__(self, bus: CanBus, address: int = 0x80) -> None:
        self.bus, self.node = bus, node(1000, address)
        self.front = GuidanceValve(self.node, WheelbaseCurvature(1.4), address=0xA0)
        self.joint = GuidanceValve(self.node, JOINT, address=0xA1)
        self.tractor = Tractor()
        self.node.attach(self.tractor)
        self.speed_command = SpeedCommand(self.node, 3.0)
        self.steer, self.angles, self.speed = False, (0.1, -0.05), None
        self.halted = False

    def step(self, now: float) -> None:
        if self.halted:
            return
        for received, frame in self.bus.read():
            self.front.receive(received, frame)
            self.joint.receive(received, frame)
        frames: list[CanFrame] = []
        for valve, angle in zip((self.front, self.joint), self.angles, strict=True):
            frames += valve.send(now, SteeringRequest(steer=self.steer, angle=angle, speed=1.0))
        for frame in frames + self.speed_command.send(now, self.speed):
            self.bus.write(frame)

    def reports(self, now: float) -> tuple[SteeringReport, SteeringReport]:
        return self.front.report(now), self.joint.report(now)


class Machine:
    """The other side: two valves and a tractor's control unit, each with its own address."""

    def __init__(self, bus: CanBus) -> None:
        nodes = [node(1, 0xA0), node(2, 0xA1), node(3, 0xA2)]
        self.front, self.joint = StandInValve(nodes[0]), StandInValve(nodes[1])
        self.tractor = StandInTractor(nodes[2])
        self.devices = CanDevices(bus, nodes)


class Yard:
    """Both sides on a wire, with a clock."""

    def __init__(self, address: int = 0x80) -> None:
        self.wire = Wire()
        self.cab, self.machine = Cab(self.wire.end(), address), Machine(self.wire.end())
        self.ticks = 0

    def run(self, seconds: float, *, steer: bool | None = None) -> "Yard":
        self.cab.steer = self.cab.steer if steer is None else steer
        for _ in range(round(seconds / TICK)):
            self.wire.time = self.ticks * TICK
            self.machine.devices.step(self.wire.time)
            self.cab.step(self.wire.time)
            self.ticks += 1
        return self

    def engaged(self) -> "Yard":
        self.run(3.0).run(1.0, steer=True)
        assert self.machine.front.engaged
        assert self.machine.joint.engaged
        assert all(report.engaged for report in self.cab.reports(self.wire.time))
        return self

    def exits(self) -> list[ExitReason]:
        return [reason for _, reason in self.machine.front.exits]


def test_both_valves_follow_their_angles() -> None:
    yard = Yard().engaged()
    front, joint = yard.cab.reports(yard.wire.time)
    assert front.angle == pytest.approx(0.1, abs=2e-4)
    assert joint.angle == pytest.approx(-0.05, abs=4e-4)
    assert yard.machine.front.curvature == pytest.approx(math.tan(0.1) / 1.4, abs=1.3e-4)
    assert yard.machine.joint.curvature == pytest.approx(-0.25 * 0.05 / 0.4, abs=1.3e-4)


def test_a_minute_at_ten_hertz_without_an_exit() -> None:
    yard = Yard().engaged()
    yard.run(60.0)
    assert yard.exits() == []
    commands = [t for t, frame in yard.wire.seen if frame.identifier == 0x0CADA080 and t > 4.0]
    assert len(commands) == pytest.approx(600, abs=2)
    assert all(after - before == pytest.approx(0.1, abs=0.011) for before, after in pairwise(commands))


@pytest.mark.parametrize(
    ("happen", "reason", "readiness"),
    [
        ({"operator_steers": True}, ExitReason.OPERATOR_OVERRIDE, Readiness.OVERRIDDEN),
        ({"locked_out": True}, ExitReason.CONTROL_NOT_IN_POSITION, Readiness.LOCKED_OUT),
        ({"interlock": ExitReason.OPERATOR_PRESENCE}, ExitReason.OPERATOR_PRESENCE, Readiness.NOT_READY),
        ({"interlock": ExitReason.FUNCTION_FAULT}, ExitReason.FUNCTION_FAULT, Readiness.FAULT),
        ({"speed": 5.0, "fastest": 4.0}, ExitReason.TOO_FAST, Readiness.NOT_READY),
        ({"speed": 0.1, "slowest": 0.3}, ExitReason.TOO_SLOW, Readiness.NOT_READY),
    ],
)
def test_valve_releases_and_is_engaged_again_only_by_a_new_edge(
    happen: dict[str, Any], reason: ExitReason, readiness: Readiness
) -> None:
    yard = Yard().engaged()
    before = {key: getattr(yard.machine.front, key) for key in happen}
    for key, value in happen.items():
        setattr(yard.machine.front, key, value)
    yard.run(0.3)
    assert yard.exits() == [reason]
    assert yard.cab.front.report(yard.wire.time).readiness is readiness
    assert yard.cab.front.report(yard.wire.time).overridden == (readiness is Readiness.OVERRIDDEN)
    for key, value in before.items():
        setattr(yard.machine.front, key, value)
    yard.run(3.0)
    assert not yard.machine.front.engaged
    yard.run(0.5, steer=False).run(0.5, steer=True)
    assert yard.machine.front.engaged


@pytest.mark.parametrize("cut", [False, True])
def test_valve_releases_by_itself_when_commands_stop(cut: bool) -> None:
    yard = Yard().engaged()
    if cut:
        yard.wire.cut = True
    else:
        yard.cab.halted = True
    begun = yard.wire.time
    yard.run(0.5)
    assert yard.exits() == [ExitReason.COMMAND_TIMEOUT]
    assert yard.machine.front.exits[0][0] - begun <= 0.15 + 0.03
    yard.wire.cut = yard.cab.halted = False
    yard.run(2.0)
    assert not yard.machine.front.engaged
    yard.run(0.5, steer=False).run(0.5, steer=True)
    assert yard.machine.front.engaged


def test_silence_of_the_valve_makes_drawbar_release() -> None:
    yard = Yard().engaged()
    yard.machine.front.silent = True
    yard.run(0.45)
    assert not yard.machine.front.engaged
    assert yard.exits() == []
    assert yard.cab.front.report(yard.wire.time).readiness is Readiness.SILENT
    assert yard.machine.joint.engaged


def test_a_valve_at_its_stop_says_so_and_stays() -> None:
    yard = Yard().engaged()
    yard.cab.angles = (1.0, 0.0)
    yard.run(3.0)
    assert yard.machine.front.engaged
    assert yard.machine.front.curvature == pytest.approx(0.6)


def test_a_second_master_makes_the_valve_release() -> None:
    yard = Yard().engaged()
    other = yard.wire.end()
    other.write(CanFrame(0x0CADFF55, bytes.fromhex("807DFDFFFFFFFFFF")))
    yard.run(0.3)
    assert yard.exits() == [ExitReason.OTHER_GUIDANCE]
    assert yard.cab.front.report(yard.wire.time).readiness is Readiness.OTHER_MASTER


def test_drawbar_leaves_an_address_that_a_stronger_name_wants_and_steering_with_it() -> None:
    yard = Yard(address=0xA0).engaged()
    assert yard.cab.node.claim.address == 0x80
    late = CanDevices(yard.wire.end(), [node(5, 0x80)])
    for _ in range(200):
        late.step(yard.wire.time)
        yard.run(TICK)
    assert late._nodes[0].claim.address == 0x80
    assert yard.cab.node.claim.address == 0x81
    assert not yard.machine.front.engaged
    yard.run(0.5, steer=False).run(0.5, steer=True)
    assert yard.machine.front.engaged


def test_a_weaker_newcomer_goes_elsewhere_and_steering_goes_on() -> None:
    yard = Yard().engaged()
    late = CanDevices(yard.wire.end(), [node(5000, 0x80)])
    for _ in range(200):
        late.step(yard.wire.time)
        yard.run(TICK)
    assert late._nodes[0].claim.address not in (0x80, 0xA0, 0xA1, 0xA2)
    assert late._nodes[0].claim.held
    assert yard.machine.front.engaged
    assert yard.exits() == []


def test_speeds_come_with_sign_and_age_and_their_loss_is_noticed() -> None:
    yard = Yard()
    yard.machine.tractor.wheel_speed, yard.machine.tractor.ground_speed = -1.25, 1.5
    yard.run(3.0)
    wheel = yard.cab.tractor.speed("wheel speed")
    assert wheel.speed == pytest.approx(-1.25)
    assert 0.0 <= yard.wire.time - wheel.time <= 0.11
    for name in ("wheel speed", "ground speed", "selected speed"):
        assert yard.cab.tractor.reading(name, yard.wire.time) is not None
    yard.machine.tractor.ground_speed = None
    yard.run(1.0)
    assert yard.cab.tractor.reading("ground speed", yard.wire.time) is None
    yard.machine.tractor.ground_speed = 1.5
    yard.run(0.3)
    reading = yard.cab.tractor.reading("ground speed", yard.wire.time)
    assert reading is not None
    assert reading.distance == pytest.approx(1.5 * 3.3, abs=0.2)


def test_speed_command_reaches_the_tractor_and_runs_out() -> None:
    yard = Yard().run(2.0)
    assert yard.machine.tractor.commanded(yard.wire.time) is None
    yard.cab.speed = 1.5
    yard.run(0.3)
    assert yard.machine.tractor.commanded(yard.wire.time) == 1.5
    yard.cab.speed = None
    yard.run(0.03)
    assert yard.machine.tractor.commanded(yard.wire.time) is None
    yard.cab.speed = 1.5
    yard.run(0.3)
    yard.cab.halted = True
    yard.run(0.35)
    assert yard.machine.tractor.commanded(yard.wire.time) is None


def test_bad_messages_to_the_stand_ins_are_counted() -> None:
    yard = Yard().engaged()
    for identifier in (0x0CADA080, 0x0CFD4380):
        yard.wire.end().write(CanFrame(identifier, b"\x00"))
    yard.run(0.1)
    assert (yard.machine.front.dropped["length"], yard.machine.tractor.dropped["length"]) == (1, 1)


def _multicast_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
    return port


def _virtual() -> Callable[[], Any]:
    can = pytest.importorskip("can", reason="python-can is not installed: pip install 'drawbar[machine]'")
    channel = f"drawbar-{os.getpid()}-{time.monotonic_ns()}"
    return lambda: can.Bus(interface="virtual", channel=channel)


def _udp_multicast() -> Callable[[], Any]:
    can = pytest.importorskip("can", reason="python-can is not installed: pip install 'drawbar[machine]'")
    port = _multicast_port()
    return lambda: can.Bus(interface="udp_multicast", channel="239.74.163.2", port=port, hop_limit=0)


def _socketcan() -> Callable[[], Any]:
    can = pytest.importorskip("can", reason="python-can is not installed: pip install 'drawbar[machine]'")
    channel = os.environ.get("DRAWBAR_TEST_SOCKETCAN")
    if channel is None:
        pytest.skip("no bus: set DRAWBAR_TEST_SOCKETCAN to a virtual bus (vcan0); its frames move whatever is on it")
    return lambda: can.Bus(interface="socketcan", channel=channel)


@pytest.mark.parametrize("bus", [_virtual, _udp_multicast, _socketcan])
def test_claims_steers_and_is_overridden_over_a_bus_in_real_time(bus: Callable[[], Callable[[], Any]]) -> None:
    with two_ends(bus(), echoes=bus is _udp_multicast) as (near, far):
        cab, machine, done = Cab(near), Machine(far), threading.Event()
        devices = threading.Thread(target=machine.devices.run, args=(done.is_set,))
        devices.start()
        try:
            _until(cab, lambda: cab.front.report(time.monotonic()).readiness is Readiness.READY)
            cab.steer = True
            _until(cab, lambda: cab.front.report(time.monotonic()).engaged)
            _until(cab, lambda: abs(cab.front.report(time.monotonic()).angle - 0.1) < 1e-3)
            machine.front.operator_steers = True
            _until(cab, lambda: cab.front.report(time.monotonic()).overridden)
            assert not machine.front.engaged
        finally:
            done.set()
            devices.join()


def _until(cab: Cab, reached: Callable[[], bool], patience: float = 120.0) -> None:
    end = time.monotonic() + patience
    while not reached():
        assert time.monotonic() < end, cab.reports(time.monotonic())
        cab.step(time.monotonic())
        time.sleep(0.01)


def test_what_is_on_the_wire_is_what_a_bus_analyser_expects() -> None:
    yard = Yard().engaged()
    groups = {message.pgn for _, frame in yard.wire.seen if (message := decode(frame)) is not None}
    assert groups == {0xEA00, CLAIM, SYSTEM_COMMAND, MACHINE_INFO, 0xFE48, 0xFE49, 0xF022, 0xFD43}

"""Faults of a stand-in machine: what breaks is seen in what the machine says or does."""

import math
from dataclasses import dataclass, field

import pytest
from isobus_devices import isobus_devices

from drawbar.config import load_configuration
from drawbar.driving.stand_in.memory_transports import MemoryBus
from drawbar.driving.stand_in.stand_in_machine import stand_in_machine
from drawbar.errors import ConfigurationError
from drawbar.geometry import LocalFrame
from drawbar.machine.stand_in.faults import FAULTS, FaultPlan, PlannedFault, planned_fault
from drawbar.machine.stand_in.machine import StandInMachine
from drawbar.protocols.agopengps.steering import SteerCommand
from drawbar.simulation import build_path

LEFT = SteerCommand(steer=True, angle=0.2, speed=2.0).encode()


def machine_of(*, isobus: bool = False, ends: list[MemoryBus] | None = None) -> StandInMachine:
    configuration = load_configuration("articulated")
    path, _ = build_path(configuration)
    if isobus:
        configuration = configuration.model_copy(update={"devices": isobus_devices()})
    bus = MemoryBus([] if ends is None else ends, lambda: 0.0)
    return stand_in_machine(configuration, path, LocalFrame(latitude=50.87, longitude=4.7), 0, bus)


@dataclass(kw_only=True)
class Heard:
    """What came from a machine in a second or so."""

    lines: dict[str, list[bytes]] = field(default_factory=dict)
    replies: dict[str, list[bytes]] = field(default_factory=dict)

    def fields(self, line: str, name: bytes) -> list[list[bytes]]:
        sentences = [each for each in self.lines.get(line, []) if each[3:6] == name]
        return [each.partition(b"*")[0].split(b",") for each in sentences]


def driven(machine: StandInMachine, seconds: float, *, datagram: bytes = LEFT) -> Heard:
    """Let time pass while both boards are told to turn to the left; they begin to at a change of the command."""
    heard, start = Heard(), machine.time
    for step in range(round(seconds * 50)):
        now = start + 0.02 * step
        lines, sent = machine.advance(now)
        for line, data in lines:
            heard.lines.setdefault(line, []).append(data)
        for body in machine.boards if step % 5 == 0 else ():
            sent += machine.receive(now, body, datagram, 9999)
        for body, output in sent:
            heard.replies.setdefault(body, []).append(output.data)
    return heard


def broken(name: str) -> tuple[Heard, Heard, StandInMachine]:
    """Return what a machine said before a fault and with it."""
    machine = machine_of()
    before = driven(machine, 7.0)
    FAULTS[name].begin(machine)
    return before, driven(machine, 2.0), machine


@pytest.mark.parametrize(
    ("name", "silent", "heard"),
    [
        ("receivers-silent", {"tractor", "trailer"}, {"sensors"}),
        ("receiver-silent", {"tractor"}, {"trailer", "sensors"}),
        ("sensors-silent", {"sensors"}, {"tractor", "trailer"}),
    ],
)
def test_what_falls_silent_is_silent_and_nothing_else(name: str, silent: set[str], heard: set[str]) -> None:
    before, after, _ = broken(name)
    assert set(before.lines) == silent | heard
    assert set(after.lines) - {line for line in silent if len(after.lines.get(line, [])) <= 3} == heard
    assert set(after.replies) == {"tractor", "trailer"}


def test_garbage_comes_as_much_as_sentences() -> None:
    before, after, _ = broken("receivers-garbage")
    for line in ("tractor", "trailer"):
        assert all(each.startswith(b"$") for each in before.lines[line])
        assert sum(each.startswith(b"$") for each in after.lines[line]) <= 5
        assert len(after.lines[line]) >= 20


def test_both_positions_jump_by_a_metre() -> None:
    before, after, _ = broken("fixes-jump")
    for line in ("tractor", "trailer"):
        (*_, last), (*_, first) = before.fields(line, b"GGA"), after.fields(line, b"GGA")[2:3]
        metres = 1852.0 * math.hypot(
            float(first[2]) - float(last[2]), (float(first[4]) - float(last[4])) * math.cos(math.radians(50.87))
        )
        assert metres == pytest.approx(1.0, abs=0.35), "and what it has driven meanwhile"


def test_the_last_epoch_comes_again_and_again() -> None:
    _, after, _ = broken("fixes-frozen")
    assert len({each[1] for each in after.fields("tractor", b"GGA")[3:]}) == 1


def test_the_fix_floats_and_corrections_grow_old() -> None:
    before, after, _ = broken("fixes-float")
    assert {each[6] for each in before.fields("trailer", b"GGA")} == {b"4"}
    assert {each[7] for each in before.fields("trailer", b"GST")} == {b"0.0200"}
    assert after.fields("trailer", b"GGA")[-1][6] == b"5"
    assert after.fields("trailer", b"GST")[-1][6:8] == [b"0.4000", b"0.4000"]
    _, after, _ = broken("corrections-lost")
    ages = [float(each[13]) for each in after.fields("tractor", b"GGA")[2:]]
    assert ages == sorted(ages)
    assert ages[-1] == pytest.approx(2.8, abs=0.3)


def test_a_silent_board_steers_on() -> None:
    before, after, machine = broken("board-silent")
    assert set(before.replies) == {"tractor", "trailer"}
    assert set(after.replies) == {"trailer"}
    assert machine.boards["tractor"][0].driving


def test_stuck_wheels_stay_and_a_stuck_angle_lets_them_run_away() -> None:
    machine = machine_of()
    driven(machine, 7.0)
    FAULTS["wheels-stuck"].begin(machine)
    driven(machine, 0.3)
    angle = machine.world.truth.tractor_steering
    driven(machine, 1.0, datagram=SteerCommand(steer=True, angle=-0.2, speed=2.0).encode())
    assert machine.world.truth.tractor_steering == pytest.approx(angle, abs=0.01)
    machine = machine_of()
    driven(machine, 7.0)
    FAULTS["angle-stuck"].begin(machine)
    driven(machine, 3.0, datagram=SteerCommand(steer=True, angle=-0.1, speed=2.0).encode())
    assert machine.world.truth.tractor_steering == pytest.approx(-math.radians(30.0), abs=0.02)
    assert machine.boards["tractor"][0].wheel.angle == pytest.approx(0.2, abs=0.02)


def test_a_cut_bus_carries_nothing() -> None:
    ends: list[MemoryBus] = []
    bus, machine = MemoryBus(ends, lambda: 0.0), machine_of(isobus=True, ends=ends)
    driven(machine, 2.0)
    assert bus.read()
    FAULTS["bus-off"].begin(machine)
    driven(machine, 2.0)
    assert not bus.read()


def test_a_fault_is_named_with_its_time() -> None:
    assert planned_fault("bus-off@20s") == PlannedFault(name="bus-off", after=20.0)
    assert planned_fault("bus-off@1.5").after == 1.5
    assert planned_fault("bus-off").after is None
    with pytest.raises(ConfigurationError, match=r"no fault 'bus-of'; there are: receivers-silent, .*, bus-off"):
        planned_fault("bus-of@20s")
    for time in ("soon", "-1s", "nan", "inf"):
        with pytest.raises(ConfigurationError, match="is no time in seconds; give for example bus-off@20s"):
            planned_fault(f"bus-off@{time}")


def test_a_plan_waits_until_it_is_steered() -> None:
    machine = machine_of()
    plan = FaultPlan([planned_fault("sensors-silent@1s"), planned_fault("receiver-silent")], machine)
    assert plan.look() == ["the tractor's receiver falls silent"]
    begun = {}
    for _ in range(100):
        driven(machine, 0.1)
        for words in plan.look():
            begun[words] = machine.time
        if machine.driver.steered and "steered" not in begun:
            begun["steered"] = machine.time
    assert begun["the sensor board falls silent"] - begun["steered"] == pytest.approx(1.0, abs=0.11)
    assert plan.look() == []


def test_a_fault_of_a_device_that_is_not_there_is_refused() -> None:
    with pytest.raises(ConfigurationError, match=r"--fault bus-off: .* nothing that could break so"):
        FaultPlan([planned_fault("bus-off")], machine_of())
    with pytest.raises(ConfigurationError, match="--fault board-silent"):
        FaultPlan([planned_fault("board-silent")], machine_of(isobus=True))

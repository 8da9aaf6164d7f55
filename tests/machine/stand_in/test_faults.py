"""Faults of a stand-in machine: what breaks is seen in what the machine says or does."""

import math
from dataclasses import dataclass, field

import pytest
from isobus_devices import isobus_devices

from drawbar.config import load_configuration
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.driving.stand_in.memory_transports import MemoryBus
from drawbar.driving.stand_in.stand_in_machine import stand_in_machine
from drawbar.errors import ConfigurationError
from drawbar.geometry import LocalFrame
from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.machine.stand_in.fault_plan import FaultPlan, PlannedFault, planned_fault
from drawbar.machine.stand_in.faults import FAULTS
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


def places(heard: Heard, line: str) -> dict[bytes, tuple[float, float]]:
    """Return where a receiver said that it was, m, by the epoch's time."""
    east = math.cos(math.radians(50.87))
    return {
        each[1]: (1852.0 * (float(each[4]) % 100.0) * east, 1852.0 * (float(each[2]) % 100.0))
        for each in heard.fields(line, b"GGA")
    }


def twins(name: str, seconds: float = 3.0) -> tuple[Heard, Heard]:
    """Return what a machine says after seven seconds with a fault, and what it would say without."""
    told = []
    for fault in (name, ""):
        machine = machine_of()
        driven(machine, 7.0)
        if fault:
            FAULTS[fault].begin(machine)
        told.append(driven(machine, seconds))
    return told[0], told[1]


def asides(name: str, line: str) -> list[float]:
    """Return how far a receiver's positions are from those of the same machine without a fault, m, epoch by epoch."""
    (spoilt, right) = (places(each, line) for each in twins(name))
    assert spoilt.keys() == right.keys()
    assert len(right) > 10
    return [math.dist(spoilt[time], right[time]) for time in right]


@pytest.mark.parametrize(
    ("name", "rate", "of_the_trailer"),
    [("fixes-drift", 0.3, 1.0), ("fixes-drift-slowly", 0.05, 1.0), ("fix-drifts", 0.3, 0.0)],
)
def test_positions_drift_at_their_rate(name: str, rate: float, of_the_trailer: float) -> None:
    for line, share in (("tractor", 1.0), ("trailer", of_the_trailer)):
        found = asides(name, line)
        assert found[-1] - found[1] == pytest.approx(share * rate * 0.2 * (len(found) - 2), abs=0.005)
        assert found == sorted(found)


def test_the_tractors_positions_alone_jump() -> None:
    assert asides("fix-jumps", "tractor")[1:] == pytest.approx([1.0] * 14, abs=0.01)
    assert asides("fix-jumps", "trailer") == [0.0] * 15


def test_swapped_receivers_report_each_others_places() -> None:
    swapped, right = twins("receivers-swapped")
    assert places(swapped, "trailer") == places(right, "tractor")
    after, before = places(swapped, "tractor"), list(places(right, "trailer").values())
    assert list(after.values())[1:] == before[:-1], "an epoch later, as the tractor's receiver reports first"


def test_late_epochs_leave_two_epochs_later() -> None:
    late, right = twins("receivers-late")
    for line in ("tractor", "trailer"):
        assert [*places(late, line)] == [*places(right, line)][:-2]


def test_a_fifth_of_the_epochs_are_lost_of_each_receiver_by_itself() -> None:
    spoilt, right = twins("epochs-lost", 40.0)
    heard = [set(places(spoilt, line)) for line in ("tractor", "trailer")]
    assert [len(each) / len(places(right, "tractor")) for each in heard] == pytest.approx([0.8, 0.8], abs=0.07)
    assert heard[0] != heard[1]


def test_a_speed_in_knots_is_almost_twice_as_much() -> None:
    spoilt, right = ([float(field[7]) for field in each.fields("tractor", b"VTG")] for each in twins("speed-in-knots"))
    assert spoilt[1:] == pytest.approx([each * 3600.0 / 1852.0 for each in right[1:]], rel=0.01)


def test_receivers_without_a_position_say_so() -> None:
    _, after, _ = broken("fixes-lost")
    assert {each[6] for each in after.fields("tractor", b"GGA")[2:]} == {b"0"}


def sensed(heard: Heard) -> tuple[list[int], list[int]]:
    """Return the counts of the hitch and the pulses of the wheels that a sensor board has told."""
    told = [each.partition(b"*")[0].split(b",") for each in heard.lines["sensors"]]
    return [int(each[2]) for each in told], [int(each[3]) for each in told]


def test_the_sensor_board_reports_what_its_spoilt_sensors_show() -> None:
    for name in ("hitch-stuck", "hitch-reversed", "hitch-broken", "wheel-speed-zero"):
        (spoilt, pulses), (right, true) = (sensed(each) for each in twins(name))
        shown = {
            "hitch-stuck": [right[0]] * len(right),
            "hitch-reversed": [4096 - each for each in right],
            "hitch-broken": [0] * len(right),
        }
        assert spoilt == shown.get(name, right), name
        assert pulses == ([true[0]] * len(true) if name == "wheel-speed-zero" else true), name
        assert len(set(right)) > 5
        assert true[-1] - true[0] > 100


def test_two_faults_of_the_sensor_board_go_together() -> None:
    machine = machine_of()
    driven(machine, 7.0)
    for name in ("hitch-broken", "wheel-speed-zero"):
        FAULTS[name].begin(machine)
    counts, pulses = sensed(driven(machine, 1.0))
    assert set(counts) == {0}
    assert len(set(pulses)) == 1


def test_a_board_that_restarts_is_silent_for_a_while_and_is_released() -> None:
    machine = machine_of()
    driven(machine, 7.0)
    FAULTS["board-restarts"].begin(machine)
    assert "trailer" not in driven(machine, 0.4).replies
    assert [machine.boards[body][0].driving for body in ("tractor", "trailer")] == [True, False]
    assert "trailer" in driven(machine, 0.4).replies


def test_an_operator_who_steers_takes_over_at_the_front_wheels_board() -> None:
    _, _, machine = broken("operator-steers")
    assert [machine.boards[body][0].driving for body in ("tractor", "trailer")] == [False, True]


def turned(name: str) -> tuple[float, float, float, float]:
    """Return by how much both steerings have turned, and what their boards measure, a second after a new command."""
    machine = machine_of()
    driven(machine, 7.0)
    FAULTS[name].begin(machine)
    before = machine.world.truth
    driven(machine, 1.0, datagram=SteerCommand(steer=True, angle=0.1, speed=2.0).encode())
    after, boards = machine.world.truth, machine.boards
    return (
        after.tractor_steering - before.tractor_steering,
        after.trailer_steering - before.trailer_steering,
        boards["tractor"][0].wheel.angle,
        boards["trailer"][0].wheel.angle,
    )


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("wheels-reversed", (0.32, -0.1, 0.52, 0.1)),
        ("wheels-off", (-0.1 + math.radians(3.0), -0.1, 0.1 + math.radians(3.0), 0.1)),
        ("joint-stuck", (-0.1, 0.0, 0.1, 0.2)),
        ("angle-off", (-0.1 - math.radians(5.0), -0.1, 0.1, 0.1)),
        ("angle-reversed", (0.32, -0.1, -0.52, 0.1)),
        ("joint-angle-stuck", (-0.1, -math.radians(20.0), 0.1, 0.2)),
    ],
)
def test_steerings_turn_and_boards_measure_as_the_fault_says(name: str, expected: tuple[float, ...]) -> None:
    assert turned(name) == pytest.approx(expected, abs=0.02)


@pytest.mark.parametrize("stays", [False, True])
def test_a_driver_who_stays_drives_on(stays: bool) -> None:
    machine = machine_of()
    driven(machine, 7.0)
    if stays:
        FAULTS["driver-stays"].begin(machine)
    before = machine.driver.speed
    machine.driver.stop_requested = True
    driven(machine, 3.0)
    assert (machine.driver.speed >= before > 0.5) is stays
    assert (machine.driver.speed == 0.0) is not stays


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
    plan = FaultPlan([planned_fault("sensors-silent@1s"), planned_fault("receiver-silent")], machine, board_devices())
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


def without(setting: str) -> DeviceSettings:
    """Return devices without a setting, `section` or `section.key`."""
    section, _, key = setting.partition(".")
    devices = board_devices()
    rest = getattr(devices, section).model_copy(update={key: None}) if key else None
    return devices.model_copy(update={section: rest})


@pytest.mark.parametrize("name", [name for name, fault in FAULTS.items() if fault.needs])
def test_a_fault_of_a_device_that_is_not_there_is_refused(name: str) -> None:
    needs = FAULTS[name].needs
    with pytest.raises(ConfigurationError, match=rf"--fault {name} \(.*\) needs devices\.{needs}, which"):
        FaultPlan([planned_fault(name)], machine_of(), without(needs))
    FaultPlan([planned_fault(name)], machine_of(), isobus_devices() if needs == "isobus" else board_devices())


def board_devices() -> DeviceSettings:
    devices = with_stand_ins(load_configuration("articulated")).devices
    assert devices is not None
    return devices

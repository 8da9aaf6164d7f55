"""The loop around the step: when a run ends, why, and what the machine is told at last."""

import math
import signal
import sys
from contextlib import closing
from dataclasses import replace
from itertools import count, islice
from pathlib import Path
from types import SimpleNamespace

import pytest
from mcap.reader import make_reader

import drawbar
from drawbar.errors import DrawbarError, HardwareError, PathError
from drawbar.machine.base import Machine
from drawbar.recording.log import read_log
from drawbar.recording.recorder import Recorder
from drawbar.signals import Status
from drawbar.simulation import RunAborted, Simulation, build_machine, drive
from drawbar.step.build import build_autopilot

PACKAGE = str(Path(drawbar.__file__).parent)


class Watched(Machine):
    """Passes everything on to a simulated machine, and writes down what it is told."""

    def __init__(self, machine, change=lambda measurement: measurement):
        self.machine, self.change, self.received = machine, change, []

    def read(self):
        return self.change(self.machine.read())

    def write(self, command):
        self.received.append(command.speed)
        self.machine.write(command)

    def stop(self):
        self.received.append("stop")
        self.machine.stop()

    def close(self):
        self.received.append("close")


def driven(simulation, change=lambda measurement: measurement, time_limit=1000.0):
    machine = Watched(simulation.machine, change)
    return machine, drive(machine, simulation.autopilot, time_limit=time_limit)


def short(build) -> Simulation:
    return build("articulated", "path.radii=[8.0]", "path.straight_length=4.0")


def test_a_run_ends_with_the_path(build):
    machine, steps = driven(short(build))
    records = list(steps)
    assert records[-1].reference.tractor.progress == pytest.approx(short(build).path.length, abs=0.3)
    assert machine.received[-3:] == [0.0, "stop", "close"]


def test_a_vehicle_that_does_not_arrive_is_given_up(build):
    machine, steps = driven(short(build), time_limit=4.0)
    with pytest.raises(RunAborted, match="not finished within 4 s"):
        list(steps)
    assert machine.received[-2:] == ["stop", "close"]


def test_the_time_limit_counts_from_the_first_measurement(build):
    machine, steps = driven(short(build), lambda m: replace(m, time=m.time + 1.7e9), time_limit=4.0)
    assert len(list(islice(steps, 20))) == 20
    with pytest.raises(RunAborted, match="not finished within 4 s"):
        list(steps)
    assert machine.received[-2:] == ["stop", "close"]


def jump(at, metres=100.0):
    """Let both antennas jump at a time."""

    def change(m):
        if m.time < at:
            return m
        return replace(m, tractor_y=m.tractor_y + metres, trailer_y=m.trailer_y + metres)

    return change


def test_a_vehicle_that_left_the_path_is_given_up_after_its_record(build):
    machine, steps = driven(short(build), jump(4.0))
    told = [record.status for record in islice(steps, 26) if record.status is not Status.OK]
    assert told == [Status.OFF_COURSE]
    with pytest.raises(RunAborted, match=r"At 5\.0 s the tractor was .* m from the path \(limit 6 m\)"):
        next(steps)
    assert machine.received[-3:] == [0.0, "stop", "close"]


def test_a_first_measurement_without_a_position_is_reported(build):
    _, steps = driven(short(build), lambda m: replace(m, trailer_x=float("nan")))
    with pytest.raises(HardwareError, match=r"lacks a position .* wait for a fix of both antennas"):
        next(steps)


def test_a_start_too_far_away_is_reported(build):
    told = r"is 6\.0. m from where the run is to begin, \(0\.00, 0\.00\) m, .* at most 5 m is allowed: drive there"
    with pytest.raises(PathError, match=r"at most 5 m is allowed: drive there"):
        build("articulated", "start.left=40.0")
    _, steps = driven(short(build), lambda m: replace(m, tractor_y=m.tractor_y + 6.02))
    with pytest.raises(PathError, match=told):
        next(steps)


def test_a_run_begins_where_the_machine_stands_on_the_path(build):
    simulation = build("articulated", "path.radii=[8.0]", "start.ahead=9.0", "start.left=0.5")
    records = list(islice(simulation.steps(), 20))
    assert records[0].reference.tractor.progress == pytest.approx(9.0, abs=0.2)
    assert {record.status for record in records} == {Status.OK}
    assert simulation.header().path.path().length == simulation.path.length


def test_a_run_goes_the_way_that_the_machine_faces_along_recorded_and_parallel_lines(build):
    there = "path.radii=[8.0]", "start.ahead=9.0", "start.yaw=3.1415"
    assert build("articulated", *there).autopilot.start == pytest.approx(9.0, abs=1e-6)
    back = build("articulated", *there, "path.working_width=3.0")
    assert back.autopilot.start == pytest.approx(back.path.length - 9.0, abs=1e-6)
    brook = "path.file=examples/brook.csv", "start.ahead=20.0"
    there, back_again = build("articulated", *brook), build("articulated", *brook, "start.yaw=3.1415")
    assert there.path.length - there.autopilot.start == pytest.approx(back_again.autopilot.start, abs=1e-6)
    records = list(islice(back.steps(), 15))
    assert {record.status for record in records} == {Status.OK}
    assert all(abs(record.reference.tractor.lateral_error) < 0.1 for record in records)


def test_a_vehicle_that_faces_away_where_no_turns_help_is_reported(build):
    simulation = build("articulated", "start.yaw=3.1", "guidance.turning_room=0.1")
    with pytest.raises(RunAborted, match=r"faced -?1\d\d° away from the path; turns of .* do not lead onto it"):
        list(simulation.steps())


class Interrupted(Exception):  # noqa: N818 -- no mistake
    pass


def an_exception(*arguments):
    raise Interrupted


def ctrl_c(*arguments):
    signal.raise_signal(signal.SIGINT)


def sigterm(*arguments):
    signal.raise_signal(signal.SIGTERM)


@pytest.mark.parametrize("place", ["read", "feedback", "write", "prepare", "record", "consumer"])
@pytest.mark.parametrize(
    ("broken", "raised"), [(an_exception, Interrupted), (ctrl_c, KeyboardInterrupt), (sigterm, SystemExit)]
)
def test_whatever_breaks_the_loop_the_machine_is_told_to_stop(build, monkeypatch, place, broken, raised):
    simulation = short(build)
    machine, steps = driven(simulation)
    list(islice(steps, 5))
    if place in ("read", "write"):
        monkeypatch.setattr(machine, place, broken)
    elif place != "consumer":
        monkeypatch.setattr(simulation.autopilot, place, broken)
    with pytest.raises(raised), closing(steps):  # noqa: PT012 -- the loop is what is tested
        for _ in steps:
            if place == "consumer":
                broken()
    assert machine.received[-2:] == ["stop", "close"]
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


def interrupted_at(line: int, steps) -> bool:
    """Drive a step that is interrupted at one of the lines of drawbar's own code; return whether it has so many."""
    lines = count()

    def trace(frame, event, _):
        if not frame.f_code.co_filename.startswith(PACKAGE):
            return None
        if event == "line" and next(lines) == line:
            sys.settrace(None)
            raise KeyboardInterrupt
        return trace

    before = sys.gettrace()
    with closing(steps):
        sys.settrace(trace)
        try:
            next(steps)
        except KeyboardInterrupt:
            return True
        finally:
            sys.settrace(before)
    return False


@pytest.mark.parametrize("every", range(4))
def test_an_interrupt_at_any_line_of_a_step_ends_with_a_stop(build, every):
    simulation = short(build)
    for line in count(every, 4):
        simulation.autopilot.begin(simulation.path)
        simulation.machine = build_machine(simulation.configuration, simulation.path, 0)
        machine, steps = driven(simulation)
        list(islice(steps, 2))
        if not interrupted_at(line, steps):
            break
        assert machine.received[-2:] == ["stop", "close"], f"line {line}"
    assert line > 50


def test_a_program_that_handles_sigterm_itself_goes_on_doing_so(build):
    heard = []
    before = signal.signal(signal.SIGTERM, lambda number, frame: heard.append(number))
    try:
        _, steps = driven(short(build))
        with closing(steps):
            next(steps)
            signal.raise_signal(signal.SIGTERM)
            next(steps)
    finally:
        signal.signal(signal.SIGTERM, before)
    assert heard == [signal.SIGTERM]


def bare(_) -> None:
    return None


def as_dictionary(m):
    return {"time": m.time}


def later(change, samples=20):
    """Let a machine report rightly at first."""
    count = iter(range(samples))
    return lambda m: change(m) if next(count, None) is None else m


@pytest.mark.parametrize("change", [bare, as_dictionary], ids=lambda change: change.__name__)
@pytest.mark.parametrize("samples", [0, 20])
def test_a_machine_that_reports_no_measurement_is_reported_and_stopped(build, change, samples):
    machine, steps = driven(short(build), later(change, samples))
    given = repr(change(SimpleNamespace(time=0.0)))[:6]
    with pytest.raises(HardwareError, match=rf"Watched\.read\(\) returned {given}.*must return a drawbar\.Measurement"):
        list(steps)
    assert machine.received[-2:] == ["stop", "close"]


@pytest.mark.parametrize("time", [math.nan, math.inf])
def test_a_first_measurement_without_a_time_is_reported(build, time):
    machine, steps = driven(short(build), lambda m: replace(m, time=time))
    with pytest.raises(HardwareError, match=f"first measurement has time = {time}; give seconds"):
        next(steps)
    assert machine.received == ["stop", "close"]


@pytest.mark.parametrize(
    "stamp",
    [lambda time: 3.0, lambda time: 8.0 - time, lambda time: time - 100.0, lambda time: math.nan],
    ids=["stands still", "runs backwards", "was set back", "is lost"],
)
def test_a_clock_that_does_not_go_on_ends_the_run_and_is_named(build, stamp, tmp_path):
    simulation = short(build)
    machine, steps = driven(simulation, later(lambda m: replace(m, time=stamp(m.time))))
    log = Recorder(tmp_path / "log.mcap", simulation.header())
    with pytest.raises(RunAborted, match=r"time stamps had not increased, or were not finite, for 1\.0 s"), log:  # noqa: PT012
        for record in steps:
            log.write(record)
    assert machine.received[-3:] == [0.0, "stop", "close"]
    assert 20 < len(read_log(tmp_path / "log.mcap").records) < 30


def test_a_clock_below_zero_is_as_good_as_any(build, tmp_path):
    simulation = short(build)
    _, steps = driven(simulation, lambda m: replace(m, time=m.time - 7e4))
    with Recorder(tmp_path / "log.mcap", simulation.header()) as log:
        for record in islice(steps, 20):
            log.write(record)
    with (tmp_path / "log.mcap").open("rb") as file:
        assert [message.log_time for _, _, message in make_reader(file).iter_messages()] == [
            pytest.approx(step * 200_000_000, abs=100) for step in range(20)
        ]
    assert read_log(tmp_path / "log.mcap").records[0].measurement.time == -7e4


def test_what_is_no_machine_and_an_autopilot_without_a_path_are_refused(build):
    simulation = short(build)
    with pytest.raises(DrawbarError, match=r"machine must be a Machine, got namespace\(\)"):
        next(drive(SimpleNamespace(), simulation.autopilot, time_limit=1.0))  # type: ignore[arg-type]
    machine = Watched(simulation.machine)
    with pytest.raises(PathError, match=r"no path; call autopilot\.begin\(path\)"):
        next(drive(machine, build_autopilot(simulation.configuration), time_limit=1.0))
    assert machine.received == [0.0, "stop", "close"]


def test_a_machine_that_forgets_to_stop_cannot_be_made():
    class Unstoppable(Machine):
        def read(self):
            raise NotImplementedError

        def write(self, command):
            raise NotImplementedError

    with pytest.raises(TypeError, match=r"abstract method '?stop'?"):
        Unstoppable()

"""The exported library is Python's own: compiled alike, it says bit for bit the same."""

import ctypes
import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import islice

import pytest

from drawbar.signals import Flag, Measurement, Status, StepRecord

RUNS = {
    "articulated": ("articulated",),
    "tricycles": ("paper",),
    "filter": ("articulated-ekf",),
    "whole vehicle": ("articulated-centralised",),
    "closed form": ("lqr-pi",),
    "dead time": ("articulated", "vehicle.dead_time=0.3"),
    "dead time found": ("articulated", "actuation.identify=true", "machine.actuators.dead_time=0.3"),
    "masts": (
        "articulated",
        "vehicle.masts={tractor={up=2.5,left=0.1},trailer={up=2.0}}",
        "machine.terrain={slope=0.08,unevenness=0.03}",
        "machine.attitude.tractor.present=true",
        "machine.events=[{kind='gps_float', start=30.0, duration=10.0}]",
    ),
}


@pytest.mark.parametrize("name", RUNS)
def test_over_a_whole_run(
    name: str, build: Callable, exported: Callable, compiled: Callable, answers: Callable
) -> None:
    told: list[tuple[bytes, bytes]] = []
    with build(*RUNS[name]) as simulation:
        own = simulation.autopilot.library
        records = list(simulation.steps(between=lambda: told.append(answers(own.call))))
    library = compiled(exported(*RUNS[name]))
    assert library.begin(simulation.path) == 0
    for record, answer in zip(records, told, strict=False):  # there is no record of the sample that ends the run
        command, status = library.step(record.measurement)
        assert status == (record.flags if record.status.is_new_command else record.status)
        assert repr(command) == repr(record.command)  # a zero has a sign
        assert answers(library.call) == answer, f"step {record.step}"


def faulty(records: list[StepRecord]) -> Iterator[Measurement]:
    """Yield the measurements with faults of clock, caller and sensors, a few seconds apart."""
    for i, record in enumerate(records):
        measured = record.measurement
        if i in (40, 41, 80, 81, 82, 83):
            continue
        if i in (60, 61):
            measured = replace(measured, time=math.nan if i == 60 else 0.0)
        if 100 <= i < 110:
            measured = replace(measured, tractor_x=math.nan, trailer_y=math.inf)
        if i >= 120:
            measured = replace(measured, tractor_steering=1.3)
        yield measured


@pytest.mark.parametrize("name", ["articulated", "whole vehicle", "dead time"])
def test_where_callers_and_sensors_fail(
    name: str, build: Callable, exported: Callable, compiled: Callable, answers: Callable
) -> None:
    with build(*RUNS[name]) as simulation:
        records = list(islice(simulation.steps(), 200))
    autopilot, library = simulation.autopilot, compiled(exported(*RUNS[name]))
    autopilot.begin(simulation.path)
    library.begin(simulation.path)
    reached = []
    for i, measurement in enumerate(faulty(records)):
        if speed := {20: 0.5, 30: 1.0}.get(i):
            autopilot.set_speed(speed)
            assert library.call("set_speed", ctypes.c_double(speed)) == Status.OK
        own_status, own_command = autopilot.feedback(measurement)
        autopilot.prepare()
        command, status = library.step(measurement)
        assert status == (autopilot.record().flags if own_status.is_new_command else own_status)
        assert repr(command) == repr(own_command)
        assert answers(library.call) == answers(autopilot.library.call), f"sample {i}"
        reached.append(status)
    assert {0, Status.TIME, Flag.MEASUREMENT, Flag.LATE} <= set(reached)
    # nothing that sensors show makes a solver fail; tests/step/test_step.py shows what a step does then
    assert any(status & Flag.SLOWED and status < Status.REFUSED for status in reached)

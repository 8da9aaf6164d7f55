"""What is remembered of everybody who was heard."""

import math

import pytest
import setting_looks
from gate_bench import Bench

from drawbar.messages import Mode, SupervisorState
from drawbar.protocols.actuator import Readiness, SteeringReport
from drawbar.safety.causes import Cause
from drawbar.safety.engagement import STEERING
from drawbar.safety.settings import SafetySettings
from drawbar.safety.watch import Watch, agrees, largest
from drawbar.statuses import FixQuality


@pytest.mark.parametrize("state", list(SupervisorState), ids=lambda each: each.name)
@pytest.mark.parametrize("mode", [None, *Mode])
def test_who_agrees_with_whom(state, mode):
    expected = mode in (None, Mode.IDLE)
    if state in STEERING:
        driving = state in (SupervisorState.ACTIVE, SupervisorState.DEGRADED)
        expected = not (driving and mode is Mode.IDLE)
    assert agrees(mode, state) is expected


def test_the_largest_is_unknown_if_any_is():
    assert largest(1.0, -2.0) == 2.0
    assert math.isnan(largest(1.0, math.nan))
    assert math.isnan(largest())


def test_nothing_heard_is_nothing_known():
    seen = Watch(SafetySettings(), drives=False).observe(5.0, SupervisorState.STANDBY, (None, None), ())
    assert (seen.controller_age, seen.angle_age) == (math.inf, math.inf)
    assert math.isnan(seen.steering_error)
    assert math.isnan(seen.speed)
    assert not any((seen.command_valid, seen.configured, seen.recording, seen.speed_known))


def test_ages_and_errors_are_those_of_the_worst_actuator():
    bench = Bench()
    bench.command = {"tractor_angle": 0.1, "trailer_angle": -0.1}
    bench.run(0.1)
    reports = (
        SteeringReport(angle=0.05, angle_time=bench.time),
        SteeringReport(angle=0.1, angle_time=bench.time - 1.0),
    )
    seen = bench.gate.watch.observe(bench.time, SupervisorState.STANDBY, reports, (Readiness.READY,))
    assert seen.angle_age == 1.0
    assert seen.steering_error == pytest.approx(0.2)
    assert seen.readiness == (Readiness.READY,)
    alone = bench.gate.watch.observe(bench.time, SupervisorState.STANDBY, (reports[0], None), ())
    assert alone.steering_error == pytest.approx(0.05)


def test_fixes_count_from_when_both_are_fixed():
    bench = Bench()
    bench.controller = {"trailer_quality": 4}
    bench.run(5.0)
    seen = bench.gate.watch.observe(bench.time, bench.state, (None, None), ())
    assert math.isnan(seen.fixed_for)
    bench.controller = {}
    bench.run(3.0)
    seen = bench.gate.watch.observe(bench.time, bench.state, (None, None), ())
    assert seen.fixed_for == pytest.approx(2.95)
    assert seen.fix_age <= 0.05


@pytest.mark.parametrize(
    ("quality", "lasts", "goes_on"),
    [
        (FixQuality.NONE, 0.4, True),
        (FixQuality.NONE, 0.6, False),
        (FixQuality.UNKNOWN, 0.1, False),
        (FixQuality.SINGLE, 0.1, False),
        (FixQuality.FLOAT, 0.1, False),
    ],
)
@pytest.mark.parametrize("body", ["tractor", "trailer"])
def test_epochs_that_are_lost_on_their_way_are_no_lost_fix(body, quality, lasts, goes_on):
    bench = Bench()
    bench.run(3.0)
    bench.controller = {f"{body}_quality": int(quality)}
    bench.run(lasts)
    bench.controller = {}
    bench.run(1.0)
    seen = bench.gate.watch.observe(bench.time, bench.state, (None, None), ())
    assert seen.fixed_for == pytest.approx(3.95 + lasts if goes_on else 0.95, abs=0.051)


def test_how_long_fixes_have_been_missing_counts_from_when_each_was_fixed_last():
    bench = Bench()
    age = lambda: bench.gate.watch.observe(bench.time, bench.state, (None, None), ()).fix_age  # noqa: E731
    bench.controller = {"tractor_quality": 4}
    bench.run(1.0)
    assert age() == math.inf
    bench.controller = {}
    bench.run(1.0)
    for body in ("tractor", "trailer"):  # that they are lost in turn is not worse than one
        bench.controller = {f"{body}_quality": 0}
        bench.run(0.4)
        assert age() == pytest.approx(0.4, abs=0.051)


def test_late_steps_are_those_of_the_last_seconds_of_this_controller():
    bench = Bench()
    overruns = lambda: bench.gate.watch.observe(bench.time, bench.state, (None, None), ()).overruns  # noqa: E731
    assert overruns() == 0
    bench.controller = {"overruns": 7}
    bench.run(1.0)
    assert overruns() == 0
    bench.controller = {"overruns": 9}
    bench.run(1.0)
    assert overruns() == 2
    bench.controller = {"overruns": 0}
    bench.run(1.0)
    assert overruns() == 0


@pytest.mark.parametrize(
    ("cause", "seconds", "after"),
    [
        (Cause.POSITION_REJECTED, 1.0, SupervisorState.ACTIVE),
        (Cause.ANTENNA_DISTANCE, 1.0, SupervisorState.ACTIVE),
        (Cause.STEERING_MIRRORED, 0.3, SupervisorState.FAULT),
        (Cause.STEERING_CONTRADICTS, 0.3, SupervisorState.FAULT),
    ],
)
def test_a_notice_that_refuses_to_engage_ends_a_drive_only_where_the_front_wheels_are_wrong(cause, seconds, after):
    told = {"notices": (cause.value, *[0] * 7)}
    assert setting_looks.refuses(cause, **told)(SafetySettings())
    assert not setting_looks.refuses(cause)(SafetySettings())
    bench = Bench(SafetySettings()).drive()
    bench.controller = told
    bench.run(seconds)
    assert bench.state is after

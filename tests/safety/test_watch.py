"""What is remembered of everybody who was heard."""

import math
from dataclasses import replace

import pytest
import setting_looks
from gate_bench import Bench

from drawbar.messages import ControllerState, Heartbeat, Mode, Role, SupervisorState
from drawbar.messages.records import decode
from drawbar.protocols.actuator import Readiness, SteeringReport
from drawbar.safety.causes import Cause
from drawbar.safety.engagement import STEERING
from drawbar.safety.settings import SafetySettings
from drawbar.safety.watch import Watch, agrees, largest
from drawbar.statuses import FixQuality, Status

ACTIVE, STANDBY, STOPPING = SupervisorState.ACTIVE, SupervisorState.STANDBY, SupervisorState.STOPPING
STATE = decode(Bench().state_record(), ControllerState)
"""of a controller with which nothing is wrong"""


class Alone:
    """A watch without its gate."""

    def __init__(self):
        self.watch, self.sequence = Watch(SafetySettings(), drives=False), 0

    def hear(self, time, **changes):
        self.sequence += 1
        self.watch.receive_controller(time, replace(STATE, sequence=self.sequence, **changes))
        return self

    def observe(self, time, state=ACTIVE, steering=(None, None)):
        return self.watch.observe(time, state, steering, ())


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


def test_what_the_controller_says_is_observed_as_it_is():
    seen = Alone().hear(10.0, tractor_lateral_error=-0.3, trailer_heading_error=-0.2).observe(10.25)
    assert (seen.controller_age, seen.fixed_for, seen.fix_age, seen.correction_age) == (0.25, 0.25, 0.25, 1.0)
    assert (seen.lateral_error, seen.heading_error, seen.hitch_angle) == (0.3, 0.2, 0.1)
    assert (seen.lateral_deviation, seen.heading_deviation) == (0.02, 0.01)
    assert (seen.solved, seen.configured, seen.wiggled, seen.speed) == (99, True, True, 1.0)
    assert not Alone().hear(10.0, configuration=STATE.configuration + 1, wiggled=0).observe(10.0).configured


@pytest.mark.parametrize("source", ["wheel_speed", "receiver_speed"])
def test_each_source_of_speed_counts(source):
    both = {"wheel_speed": math.nan, "receiver_speed": math.nan}
    seen = Alone().hear(10.0, **{**both, source: 2.0}).observe(10.0)
    assert (seen.speed, seen.speed_received, seen.speed_known) == (2.0, True, True)


def test_a_state_that_comes_again_or_late_is_not_taken_in():
    alone = Alone().hear(10.0)
    alone.watch.receive_controller(10.5, replace(STATE, sequence=1, solved=3))
    assert (alone.observe(10.5).controller_age, alone.observe(10.5).solved) == (0.5, 99)


@pytest.mark.parametrize(
    ("lateral", "heading", "arrives"),
    [
        (0.1, math.radians(3.0), True),
        (-0.1, -math.radians(3.0), True),
        (math.nextafter(0.1, 1.0), 0.0, False),
        (0.0, math.nextafter(math.radians(3.0), 1.0), False),
        (0.0, math.nan, False),
    ],
)
def test_it_has_come_onto_its_line_where_both_bodies_are_on_it_and_along_it(lateral, heading, arrives):
    errors = {"tractor_lateral_error": lateral, "trailer_lateral_error": 0.0}
    headings = {"tractor_heading_error": 0.0, "trailer_heading_error": heading}
    alone = Alone().hear(10.0, **errors, **headings)
    assert alone.observe(10.0).on_line is arrives


def test_it_stays_come_onto_its_line_until_it_is_not_steered_any_more():
    alone = Alone().hear(10.0, tractor_lateral_error=0.3)
    assert not alone.observe(10.0).on_line
    assert alone.hear(11.0, tractor_heading_error=0.0, trailer_heading_error=0.0).observe(11.0).on_line
    assert alone.hear(12.0, tractor_lateral_error=0.3).observe(12.0, STOPPING).on_line
    assert not alone.observe(13.0, STANDBY).on_line
    assert not alone.observe(14.0).on_line, "engaged again, it is on its way"
    assert not alone.hear(15.0, tractor_heading_error=0.0, trailer_heading_error=0.0).observe(15.0, STANDBY).on_line


@pytest.mark.parametrize("quality", [FixQuality.NONE, FixQuality.FIXED])
def test_a_fix_may_not_be_reported_for_half_a_second(quality):
    alone = Alone().hear(8.0).hear(10.0, tractor_quality=int(quality))
    skipped = quality is FixQuality.FIXED
    assert math.isnan(alone.observe(10.0).fixed_for) is not skipped
    alone = Alone().hear(9.5).hear(10.0, tractor_quality=int(quality))
    assert alone.observe(10.0).fixed_for == 0.5


@pytest.mark.parametrize("body", ["tractor", "trailer"])
def test_a_receiver_that_was_never_fixed_has_been_without_for_ever(body):
    assert Alone().hear(10.0, **{f"{body}_quality": int(FixQuality.FLOAT)}).observe(10.0).fix_age == math.inf


def test_only_late_steps_of_the_last_seconds_count():
    alone = Alone().hear(10.0, overruns=3).hear(11.0, overruns=4).hear(12.0, overruns=6)
    assert alone.observe(15.0).overruns == 3
    assert alone.observe(15.5).overruns == 2
    assert alone.observe(17.5).overruns == 0, "nothing has been heard for so long"


@pytest.mark.parametrize(("role", "field"), [(Role.RECORDER, "recording"), (Role.GUARD, "guarded")])
def test_recorder_and_guard_are_there_while_they_say_that_they_are_well(role, field):
    def beat(healthy, role=role):
        return Heartbeat(time=0, valid_until=0, role=role, healthy=healthy, state=STANDBY)

    alone = Alone()
    there = lambda time: getattr(alone.observe(time), field)  # noqa: E731
    alone.watch.receive_heartbeat(10.0, beat(1, Role.CONTROLLER))
    assert not there(10.0)
    alone.watch.receive_heartbeat(10.0, beat(1))
    assert there(11.0)
    assert not there(11.001)
    for healthy in (0, 2):
        alone.watch.receive_heartbeat(12.0, beat(1))
        alone.watch.receive_heartbeat(12.0, beat(healthy))
        assert not there(12.0)


def test_a_command_may_be_obeyed_up_to_its_last_instant():
    bench = Bench().run(0.1)
    command, last = bench.gate.watch, bench.ns(bench.time + 0.2) / 1e9
    assert command.command_valid(last)
    assert not command.command_valid(last + 1e-6)


def test_what_the_gate_was_late_by_does_not_make_an_angle_old():
    alone = Alone()
    alone.watch.troubles.lateness = 0.25
    report = SteeringReport(angle=0.0, angle_time=10.0)
    assert alone.observe(10.5, steering=(report, None)).angle_age == 0.25


@pytest.mark.parametrize(("state", "said"), [(ACTIVE, True), (STOPPING, False)])
def test_a_steering_that_contradicts_its_commands_counts_until_it_stops(state, said):
    assert Alone().hear(10.0, status=int(Status.STEERING)).observe(10.0, state).not_following is said
    assert not Alone().hear(10.0).observe(10.0, state).not_following


def test_antennas_that_move_backwards():
    assert Alone().hear(10.0, status=int(Status.BACKWARDS)).observe(10.0).backwards
    assert not Alone().hear(10.0).observe(10.0).backwards


@pytest.mark.parametrize(
    ("trouble", "value", "field", "expected"),
    [
        ("refused", 9.0, "refused_ago", 1.0),
        ("late", 9.0, "late_ago", 1.0),
        ("unsent", 9.0, "unsent_ago", 1.0),
        ("gone", True, "controller_gone", True),
        ("ended", True, "ended", True),
        ("suspended", True, "suspended", True),
        ("device", True, "device_failed", True),
    ],
)
def test_the_gates_own_troubles_are_observed(trouble, value, field, expected):
    alone = Alone().hear(10.0)
    sound = getattr(alone.observe(10.0), field)
    assert sound == (False if expected is True else math.inf)
    setattr(alone.watch.troubles, trouble, value)
    assert getattr(alone.observe(10.0), field) == expected


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

"""What ends driving: how soon the gate releases, degrades or stops, by which cause, and for good."""

import math

import pytest
from gate_bench import Bench, driving, told

from drawbar.messages import Action, Mode
from drawbar.protocols.actuator import Readiness
from drawbar.safety.causes import BY_READINESS, Cause
from drawbar.safety.engagement import ACTIVE, DEGRADED, ENGAGING, ESTOP, FAULT, OVERRIDE, STANDBY, STOPPED, STOPPING
from drawbar.statuses import Status


def released_within(bench, seconds):
    """Return after how long the frames said off, s."""
    start = bench.time
    while bench.transport.written[-1].endswith(b"on"):
        bench.run()
        assert bench.time - start <= seconds + 1e-9, (bench.state, bench.cause)
    assert told(bench) == [b"tractor off", b"trailer off"]
    return bench.time - start


ENDS = {
    "expired": (lambda b: setattr(b, "command", None), FAULT, Cause.COMMAND_EXPIRED, 0.25),
    "silent": (lambda b: setattr(b, "controller", None), FAULT, Cause.CONTROLLER_SILENT, 0.6),
    "gone": (lambda b: setattr(b.channel, "gone", True), FAULT, Cause.CONTROLLER_GONE, 0.05),
    "garbage": (lambda b: b.channel.waiting.append(b"garbage"), FAULT, Cause.COMMAND_REFUSED, 0.05),
    "lost": (lambda b: b.channel.waiting.append(b.command_record(sequence=b.sequence + 99)), FAULT,
             Cause.COMMAND_REFUSED, 0.05),
    "nan": (lambda b: setattr(b, "command", {"tractor_angle": math.nan}), FAULT, Cause.COMMAND_REFUSED, 0.05),
    "infinite": (lambda b: setattr(b, "command", {"speed": math.inf}), FAULT, Cause.COMMAND_REFUSED, 0.05),
    "mode": (lambda b: setattr(b, "follows", False), FAULT, Cause.MODE, 0.05),
    "settings": (lambda b: b.controller.update(configuration=1), FAULT, Cause.CONFIGURATION, 0.05),
    "late": (lambda b: setattr(b, "late", 0.15), FAULT, Cause.GATE_LATE, 0.05),
    "late and expired": (lambda b: b.__dict__.update(late=0.15, command={"valid_until": b.ns()}), FAULT,
                         Cause.GATE_LATE, 0.05),
    "late nan": (lambda b: setattr(b, "late", math.nan), FAULT, Cause.GATE_LATE, 0.05),
    "unsent": (lambda b: setattr(b.transport, "works", False), FAULT, Cause.NOT_SENT, 0.1),
    "astray": (lambda b: b.controller.update(status=int(Status.STEERING)), FAULT, Cause.STEERING_STUCK, 0.05),
    "folded": (lambda b: b.controller.update(hitch_angle=-1.06), FAULT, Cause.HITCH_FOLDED, 0.05),
    "hitch unknown": (lambda b: b.controller.update(hitch_angle=math.nan), FAULT, Cause.HITCH_FOLDED, 0.05),
    "override": (lambda b: b.trailer.changes.update(overridden=True), OVERRIDE, Cause.OPERATOR_STEERS, 0.05),
    "released": (lambda b: b.tractor.changes.update(engaged=False), FAULT, Cause.ACTUATOR_RELEASED, 0.05),
    "ended": (lambda b: setattr(b.gate.watch.troubles, "ended", True), FAULT, Cause.ENDED, 0.05),
    "suspended": (lambda b: setattr(b.gate, "_suspended_before", -9.0), FAULT, Cause.SUSPENDED, 0.05),
    "release": (lambda b: b.ask(Action.RELEASE), STANDBY, Cause.OPERATOR_RELEASES, 0.05),
    "emergency": (lambda b: b.ask(Action.EMERGENCY), ESTOP, Cause.EMERGENCY, 0.05),
    "feedback": (lambda b: setattr(b.tractor, "silent_since", b.time), FAULT, Cause.STEERING_LOST, 0.56),
    **{
        readiness.name: (
            lambda b, readiness=readiness: b.trailer.changes.update(readiness=readiness), FAULT, cause, 0.05,
        )
        for readiness, cause in BY_READINESS.items()
        if readiness not in (Readiness.SWITCHED_ON, Readiness.OVERRIDDEN)
    },
}  # fmt: skip


@pytest.mark.parametrize("name", list(ENDS))
def test_what_ends_driving_releases_in_time_and_for_good(name):
    end, state, cause, seconds = ENDS[name]
    bench = driving()
    end(bench)
    released_within(bench, seconds)
    assert (bench.state, bench.cause) == (state, cause)
    assert bench.shown.cause == cause.value
    assert not bench.shown.steers
    before = len(bench.transport.written)
    bench.controller, bench.command, bench.late = {}, {}, 0.0
    bench.run(20.0)
    assert not any(frame.endswith(b"on") for frame in bench.transport.written[before:]), "nothing begins again"


def test_what_the_controller_said_before_is_dropped_and_counted():
    bench = driving()
    old_command, old_state = bench.command_record(tractor_angle=0.3), bench.state_record()
    bench.controller = {"wheel_speed": 0.9, "receiver_speed": 0.9}
    bench.run(1.0)
    before = bench.shown.dropped
    for record in (old_command, old_state, bench.command_record(sequence=bench.sequence), old_state, old_command):
        bench.channel.waiting.append(record)
    bench.run(1.0)
    assert bench.state is ACTIVE
    assert (bench.shown.dropped - before, bench.shown.rejects) == (3, 0)
    assert bench.gate.watch.speeds.last == 0.9
    assert bench.shown.tractor_set_point == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("readiness", [Readiness.SWITCHED_ON, Readiness.OVERRIDDEN])
def test_what_an_actuator_says_because_it_steers_is_no_fault(readiness):
    bench = driving()
    bench.tractor.changes.update(readiness=readiness)
    bench.run(1.0)
    assert bench.state is ACTIVE


STOPS = {
    "line": (lambda b: b.controller.update(tractor_lateral_error=0.41), Cause.LINE_LOST),
    "trailer's line": (lambda b: b.controller.update(trailer_lateral_error=-0.41), Cause.LINE_LOST),
    "line unknown": (lambda b: b.controller.update(trailer_lateral_error=math.nan), Cause.LINE_LOST),
    "position": (lambda b: b.controller.update(lateral_deviation=0.31), Cause.POSITION_LOST),
    "swapped": (lambda b: b.controller.update(status=int(Status.BACKWARDS)), Cause.RECEIVERS_SWAPPED),
    "controller": (lambda b: setattr(b, "command", {"mode": Mode.STOP}), Cause.CONTROLLER_STOPS),
    "operator": (lambda b: b.ask(Action.STOP), Cause.OPERATOR_STOPS),
    "console": (lambda b: setattr(b, "operator", False), Cause.NO_OPERATOR),
    "speed": (lambda b: b.controller.update(wheel_speed=4.3, receiver_speed=4.3), Cause.TOO_FAST),
    "clips": (lambda b: setattr(b, "command", {"tractor_angle": 0.6}), Cause.COMMAND_LIMITED),
    "speed clips": (lambda b: setattr(b, "command", {"speed": 4.3}), Cause.COMMAND_LIMITED),
    "feedback": (lambda b: setattr(b.tractor, "silent_since", b.time), Cause.STEERING_OLD),
}


@pytest.mark.parametrize("name", list(STOPS))
def test_what_stops_driving_keeps_steering_until_it_stands(name):
    stop, cause = STOPS[name]
    bench = driving()
    stop(bench)
    start = bench.time
    while bench.state is ACTIVE:
        bench.run()
        assert bench.time - start <= 2.11
    assert (bench.state, bench.cause) == (STOPPING, cause)
    assert told(bench) == [b"tractor on", b"trailer on"]
    assert (bench.shown.stop, bench.shown.speed_limit) == (1, 0.0)
    if name == "feedback":
        return  # whose loss releases 0.3 s later, see above
    bench.controller = {"wheel_speed": 0.0, "receiver_speed": 0.0}
    bench.run(0.6)
    assert bench.state is STOPPED
    assert told(bench) == [b"tractor off", b"trailer off"]


@pytest.mark.parametrize("beside", [{"tractor_lateral_error": 0.5}, {"trailer_heading_error": -0.1}])
def test_a_vehicle_may_be_farther_from_its_line_until_it_has_come_onto_it(beside):
    bench = Bench()
    bench.controller = dict(beside)
    bench.drive().run(1.0)
    bench.controller.update(trailer_lateral_error=1.4)
    bench.run(1.0)
    assert bench.state is ACTIVE
    bench.controller.update(trailer_lateral_error=1.6)
    bench.run(0.2)
    assert (bench.state, bench.cause) == (STOPPING, Cause.LINE_LOST)


def test_a_vehicle_that_is_engaged_again_is_on_its_way_again():
    bench = driving()
    bench.ask(Action.STOP)
    bench.controller = {"wheel_speed": 0.0, "receiver_speed": 0.0}
    bench.run(2.0)
    assert bench.state is STOPPED
    bench.controller = {"tractor_lateral_error": 0.8}
    bench.ask(Action.ACKNOWLEDGE)
    bench.drive().run(1.0)
    assert bench.state is ACTIVE


DEGRADING = {
    "fix": ({"tractor_quality": 4}, Cause.FIX_LOST),
    "trailer's fix": ({"trailer_quality": 4}, Cause.FIX_LOST),
    "corrections": ({"correction_age": 20.1}, Cause.CORRECTIONS_LOST),
    "position": ({"lateral_deviation": 0.075}, Cause.POSITION_UNSURE),
    "heading": ({"heading_deviation": 0.06}, Cause.HEADING_UNSURE),
    "solver": ({"solved": 0}, Cause.UNSOLVED),
    "speeds disagree": ({"wheel_speed": 2.0, "receiver_speed": 1.4}, Cause.SPEED_UNKNOWN),
    "no speed": ({"wheel_speed": math.nan, "receiver_speed": math.nan}, Cause.SPEED_UNKNOWN),
    "overruns": ({"overruns": 3}, Cause.OVERRUNS),
}


@pytest.mark.parametrize("name", list(DEGRADING))
def test_causes_degrade_for_a_while_and_then_stop(name):
    changes, cause = DEGRADING[name]
    bench = driving(speed_actuator=True)
    assert bench.speed_actuator.requests[-1][1].speed == 1.0
    bench.controller = changes
    bench.run(0.6)
    assert (bench.state, bench.cause) == (DEGRADED, cause)
    assert bench.shown.speed_limit == 0.5
    assert bench.speed_actuator.requests[-1][1].speed == 0.5
    assert cause.value in bench.shown.refusals
    assert 9.0 < bench.shown.remaining < 10.0
    if name == "overruns":
        return  # they are forgotten before the budget is over
    bench.run(10.1)
    assert (bench.state, bench.cause) == (STOPPING, Cause.BUDGET)


def test_without_fix_and_speed_it_is_driven_on_for_a_second():
    bench = driving()
    bench.controller = dict.fromkeys(("wheel_speed", "receiver_speed"), math.nan)
    bench.controller |= {"tractor_quality": 0, "trailer_quality": 0}
    bench.run(0.9)
    assert bench.state is DEGRADED
    bench.run(0.3)
    assert (bench.state, bench.cause) == (STOPPING, Cause.SENSORS_LOST)


def test_it_recovers_when_the_cause_is_gone():
    bench = driving()
    bench.controller = {"tractor_quality": 4}
    bench.run(1.0)
    bench.controller = {}
    bench.run(1.9)
    assert bench.state is DEGRADED
    bench.run(0.2)
    assert bench.state is ACTIVE
    assert bench.shown.speed_limit == 4.2


@pytest.mark.parametrize("body", ["tractor", "trailer"])
def test_a_steering_that_does_not_follow_is_released(body):
    bench = driving()
    actuator = getattr(bench, body)
    actuator.takes = False
    actuator.changes["engaged"] = True
    bench.command = {f"{body}_angle": 0.1}
    bench.run(0.45)
    assert bench.state is ACTIVE
    bench.run(0.35)
    assert (bench.state, bench.cause) == (FAULT, Cause.STEERING_STUCK)


def test_a_steering_that_turns_the_wrong_way_is_released():
    bench = driving()
    bench.tractor.takes = False
    bench.tractor.changes["engaged"] = True
    bench.command = {"tractor_angle": 0.1}
    for _ in range(12):
        bench.tractor.angle -= 0.01
        bench.run()
    assert (bench.state, bench.cause) == (FAULT, Cause.STEERING_REVERSED)


def test_a_steering_whose_measured_angle_jumps_is_released():
    bench = driving()
    bench.tractor.takes = False
    bench.tractor.changes["engaged"] = True
    bench.tractor.angle += 0.09
    bench.run(0.15)
    assert (bench.state, bench.cause) == (FAULT, Cause.STEERING_JUMPED)


def test_a_steering_need_not_move_while_the_vehicle_stands():
    bench = driving(speed_actuator=True)
    bench.tractor.takes = False
    bench.tractor.changes["engaged"] = True
    bench.command, bench.speed = {"tractor_angle": 0.1}, 0.05
    bench.run(3.0)
    assert bench.state is ACTIVE


def test_actuators_that_do_not_take_over_are_released():
    bench = Bench().ready()
    bench.trailer.takes = False
    bench.engage().run(2.9)
    assert bench.state is ENGAGING
    bench.run(0.2)
    assert (bench.state, bench.cause) == (FAULT, Cause.NOT_TAKEN)


def test_the_stop_of_the_speed_actuator_is_always_reachable():
    bench = driving(speed_actuator=True)
    assert bench.speed_actuator.requests[-1][1].drive
    bench.tractor.send = None  # its program fails
    bench.run()
    assert bench.state in (ACTIVE, FAULT)
    bench.run()
    assert (bench.state, bench.cause) == (FAULT, Cause.DEVICE)
    assert bench.speed_actuator.requests[-1][1].drive is False
    assert bench.transport.written[-2:] == [b"trailer off", b"speed"]


def test_a_vehicle_that_does_not_stop_is_asked_harder_and_released_once_there_is_a_reason():
    bench = driving(speed_actuator=True)
    bench.ask(Action.STOP)
    bench.run(0.1)
    request = bench.speed_actuator.requests[-1][1]
    assert (request.drive, request.deceleration) == (False, 1.0)
    bench.run(5.1)
    assert bench.speed_actuator.requests[-1][1].deceleration == 2.5
    assert bench.shown.stop == 2
    assert bench.state is STOPPING
    bench.run(15.0)
    assert bench.state is STOPPING
    assert bench.shown.steers == 1
    bench.controller = {"lateral_deviation": math.nan}
    bench.run()
    assert (bench.state, bench.cause) == (STOPPED, Cause.STOP_IGNORED)
    assert bench.shown.steers == 0
    assert bench.speed_actuator.requests[-1][1].deceleration == 2.5


def test_a_vehicle_that_nobody_steers_stops_as_fast_as_possible():
    bench = driving(speed_actuator=True)
    bench.command = None
    bench.run(0.3)
    assert bench.state is FAULT
    assert bench.speed_actuator.requests[-1][1].deceleration == 2.5


def test_speeds_that_differ_by_a_factor_refuse_and_stop():
    slow = {"wheel_speed": 0.3, "receiver_speed": 0.58}
    bench = Bench().ready()
    bench.controller = slow
    bench.run(0.5)
    assert Cause.SPEEDS_CONTRADICT.value in bench.shown.refusals
    assert Cause.SPEED_UNKNOWN.value not in bench.shown.refusals, "in m/s they hardly differ"
    bench = driving()
    bench.controller = slow
    bench.run(0.5)
    assert (bench.state, bench.cause) == (STOPPING, Cause.SPEEDS_CONTRADICT)
    for speeds in ({"wheel_speed": 1.0, "receiver_speed": 1.4}, {"wheel_speed": 0.1, "receiver_speed": 0.19}):
        bench = driving()
        bench.controller = speeds
        bench.run(2.0)
        assert bench.state is ACTIVE, speeds


def test_a_speed_actuator_that_the_operator_overrides_ends_driving():
    bench = driving(speed_actuator=True)
    bench.speed_actuator.changes["overridden"] = True
    bench.run()
    assert bench.state is OVERRIDE
    assert not bench.speed_actuator.requests[-1][1].drive

"""The gate on the bench: what it tells the actuators, whatever controller, operators and devices do."""

import math

import pytest
from gate_bench import BOUNDS, TICK, Bench
from hypothesis import given, settings
from hypothesis import strategies as st

from drawbar.messages import Action, CommandMessage, GateState, Heartbeat, Mode, Role, SupervisorState, decode, encode
from drawbar.protocols.actuator import Readiness
from drawbar.safety import machine_gate
from drawbar.safety.causes import BY_READINESS, Cause
from drawbar.safety.machine_gate import Gate
from drawbar.safety.wires import Wire
from drawbar.transports.base import Received

ACTIVE, READY, STANDBY, FAULT = (
    SupervisorState.ACTIVE, SupervisorState.READY, SupervisorState.STANDBY, SupervisorState.FAULT,
)  # fmt: skip
STOPPING, STOPPED, OVERRIDE, ESTOP, DEGRADED, ENGAGING = (
    SupervisorState.STOPPING, SupervisorState.STOPPED, SupervisorState.OVERRIDE, SupervisorState.ESTOP,
    SupervisorState.DEGRADED, SupervisorState.ENGAGING,
)  # fmt: skip


def told(bench):
    """Return what the last frames say."""
    return bench.transport.written[-2:]


def driving(settings=None, **names):
    bench = Bench(settings, **names).drive()
    assert bench.state is ACTIVE, (bench.cause, bench.shown.refusals)
    return bench


# --- the way to driving, and what is sent on it


def test_it_tells_the_actuators_off_from_the_first_tick_and_engages_by_the_operators_edge_only():
    bench = Bench()
    bench.ready()
    assert bench.state is READY
    assert set(bench.transport.written) == {b"tractor off", b"trailer off"}
    bench.run(30.0)
    assert bench.state is READY
    bench.engage()
    assert bench.state is ENGAGING
    assert told(bench) == [b"tractor on", b"trailer on"]
    bench.run(2.0)
    assert bench.state is ACTIVE
    shown = bench.shown
    assert (shown.steers, shown.engaged, shown.stop, shown.armed, shown.cause) == (1, 3, 0, 0, 0)
    assert shown.speed_limit == 4.2
    assert shown.lease == 7


def test_the_first_set_point_is_the_measured_angle():
    bench = Bench()
    bench.tractor.angle = 0.03
    bench.trailer.angle = -0.02
    bench.command = {"tractor_angle": 0.05, "trailer_angle": -0.05}
    bench.ready()
    bench.follows = False  # the controller has not yet heard of it
    bench.engage()
    assert bench.state is ENGAGING
    assert bench.tractor.requests[-1][1].angle == 0.03
    assert bench.trailer.requests[-1][1].angle == -0.02
    bench.run(2.0)
    assert bench.state is ENGAGING, "it waits for the controller's run"
    assert bench.tractor.requests[-1][1].angle == 0.03
    bench.follows = True
    bench.run(0.1)
    assert bench.state is ACTIVE
    assert bench.tractor.requests[-1][1].angle == 0.05


def test_commands_are_eased_at_first_and_limited_ones_do_not_count_then():
    bench = Bench().ready().engage()
    bench.command = {"tractor_angle": 0.5}
    bench.run(0.7)
    assert bench.state is ENGAGING
    gaps = [request.angle for time, request in bench.tractor.requests if request.steer]
    assert gaps[1] <= math.radians(7.5) + 1e-9
    assert bench.shown.clips > 5
    bench.command = {"tractor_angle": bench.tractor.angle}
    bench.run(2.0)
    assert bench.state is ACTIVE


@pytest.mark.parametrize("mode", [Mode.IDLE, Mode.DRIVE, Mode.STOP])
def test_a_controller_that_drives_on_its_own_is_not_ready(mode):
    bench = Bench().ready()
    bench.command = {"mode": mode}
    bench.run(0.1)
    assert (bench.state is READY) == (mode is Mode.IDLE)
    assert (Cause.MODE.value in bench.shown.refusals) == (mode is not Mode.IDLE)


def test_while_driving_the_command_of_the_controller_reaches_the_actuators():
    bench = driving()
    bench.command = {"tractor_angle": 0.1, "trailer_angle": -0.07}
    bench.run(1.0)
    assert bench.tractor.requests[-1][1].angle == 0.1
    assert bench.trailer.requests[-1][1].angle == -0.07
    assert bench.tractor.requests[-1][1].speed == 1.0
    shown = bench.shown
    assert (shown.tractor_set_point, shown.trailer_set_point) == (0.1, -0.07)
    assert shown.tractor_angle == pytest.approx(0.1)
    assert shown.tractor_angle_time == bench.ns()
    assert (shown.clips, shown.rejects, shown.refusals) == (0, 0, (0,) * 8)


def test_without_a_trailer_actuator_the_tractor_is_steered_alone():
    bench = driving(trailer=False)
    assert bench.transport.written[-1] == b"tractor on"
    shown = bench.shown
    assert math.isnan(shown.trailer_angle)
    assert math.isnan(shown.trailer_set_point)
    assert (shown.trailer_angle_time, shown.engaged) == (0, 1)


# --- what ends it


def let_go_within(bench, seconds):
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
    "replayed": (lambda b: b.channel.waiting.append(b.command_record(sequence=1)), FAULT, Cause.COMMAND_REFUSED, 0.05),
    "nan": (lambda b: setattr(b, "command", {"tractor_angle": math.nan}), FAULT, Cause.COMMAND_REFUSED, 0.05),
    "infinite": (lambda b: setattr(b, "command", {"speed": math.inf}), FAULT, Cause.COMMAND_REFUSED, 0.05),
    "mode": (lambda b: setattr(b, "follows", False), FAULT, Cause.MODE, 0.05),
    "settings": (lambda b: b.controller.update(configuration=1), FAULT, Cause.CONFIGURATION, 0.05),
    "late": (lambda b: setattr(b, "late", 0.11), FAULT, Cause.GATE_LATE, 0.05),
    "late nan": (lambda b: setattr(b, "late", math.nan), FAULT, Cause.GATE_LATE, 0.05),
    "unsent": (lambda b: setattr(b.transport, "works", False), FAULT, Cause.NOT_SENT, 0.1),
    "folded": (lambda b: b.controller.update(hitch_angle=-1.06), FAULT, Cause.HITCH_FOLDED, 0.05),
    "hitch unknown": (lambda b: b.controller.update(hitch_angle=math.nan), FAULT, Cause.HITCH_FOLDED, 0.05),
    "override": (lambda b: b.trailer.changes.update(overridden=True), OVERRIDE, Cause.OPERATOR_STEERS, 0.05),
    "let go": (lambda b: b.tractor.changes.update(engaged=False), FAULT, Cause.LET_GO, 0.05),
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
def test_what_ends_driving_lets_go_in_time_and_for_good(name):
    end, state, cause, seconds = ENDS[name]
    bench = driving()
    end(bench)
    let_go_within(bench, seconds)
    assert (bench.state, bench.cause) == (state, cause)
    assert bench.shown.cause == cause.value
    assert not bench.shown.steers
    before = len(bench.transport.written)
    bench.controller, bench.command, bench.late = {}, {}, 0.0
    bench.run(20.0)
    assert not any(frame.endswith(b"on") for frame in bench.transport.written[before:]), "nothing begins again"


@pytest.mark.parametrize("readiness", [Readiness.SWITCHED_ON, Readiness.OVERRIDDEN])
def test_what_an_actuator_says_because_it_steers_is_no_fault(readiness):
    bench = driving()
    bench.tractor.changes.update(readiness=readiness)
    bench.run(1.0)
    assert bench.state is ACTIVE


STOPS = {
    "line": (lambda b: b.controller.update(tractor_lateral_error=1.6), Cause.LINE_LOST),
    "trailer's line": (lambda b: b.controller.update(trailer_lateral_error=-1.6), Cause.LINE_LOST),
    "line unknown": (lambda b: b.controller.update(trailer_lateral_error=math.nan), Cause.LINE_LOST),
    "position": (lambda b: b.controller.update(lateral_deviation=0.31), Cause.POSITION_LOST),
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
        return  # whose loss lets go 0.3 s later, see above
    bench.controller = {"wheel_speed": 0.0, "receiver_speed": 0.0}
    bench.run(0.6)
    assert bench.state is STOPPED
    assert told(bench) == [b"tractor off", b"trailer off"]


WORRIES = {
    "fix": ({"tractor_quality": 4}, Cause.FIX_LOST),
    "trailer's fix": ({"trailer_quality": 4}, Cause.FIX_LOST),
    "corrections": ({"correction_age": 20.1}, Cause.CORRECTIONS_LOST),
    "position": ({"lateral_deviation": 0.11}, Cause.POSITION_UNSURE),
    "heading": ({"heading_deviation": 0.06}, Cause.HEADING_UNSURE),
    "solver": ({"solved": 0}, Cause.UNSOLVED),
    "speeds disagree": ({"wheel_speed": 2.0, "receiver_speed": 1.4}, Cause.SPEED_UNKNOWN),
    "no speed": ({"wheel_speed": math.nan, "receiver_speed": math.nan}, Cause.SPEED_UNKNOWN),
    "overruns": ({"overruns": 3}, Cause.OVERRUNS),
}


@pytest.mark.parametrize("name", list(WORRIES))
def test_worries_degrade_for_a_while_and_then_stop(name):
    changes, cause = WORRIES[name]
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


def test_it_recovers_when_the_worry_is_gone():
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
def test_a_steering_that_does_not_follow_is_let_go(body):
    bench = driving()
    actuator = getattr(bench, body)
    actuator.takes = False
    actuator.changes["engaged"] = True
    bench.command = {f"{body}_angle": 0.1}
    bench.run(0.45)
    assert bench.state is ACTIVE
    bench.run(0.35)
    assert (bench.state, bench.cause) == (FAULT, Cause.STEERING_STUCK)


def test_a_steering_that_turns_the_wrong_way_is_let_go():
    bench = driving()
    bench.tractor.takes = False
    bench.tractor.changes["engaged"] = True
    bench.command = {"tractor_angle": 0.1}
    for _ in range(12):
        bench.tractor.angle -= 0.01
        bench.run()
    assert (bench.state, bench.cause) == (FAULT, Cause.STEERING_REVERSED)


def test_a_steering_need_not_move_while_the_vehicle_stands():
    bench = driving(speed_actuator=True)
    bench.tractor.takes = False
    bench.tractor.changes["engaged"] = True
    bench.command, bench.speed = {"tractor_angle": 0.1}, 0.05
    bench.run(3.0)
    assert bench.state is ACTIVE


def test_actuators_that_do_not_take_over_are_let_go():
    bench = Bench().ready()
    bench.trailer.takes = False
    bench.engage().run(2.9)
    assert bench.state is ENGAGING
    bench.run(0.2)
    assert (bench.state, bench.cause) == (FAULT, Cause.NOT_TAKEN)


# --- speed


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


def test_a_vehicle_that_does_not_stop_is_asked_harder_and_let_go_of_once_there_is_a_reason():
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


def test_a_vehicle_with_a_speed_actuator_begins_standing():
    bench = Bench(speed_actuator=True)
    bench.speed = 0.0
    bench.drive()
    assert bench.state is ACTIVE
    assert next(r.speed for _, r in bench.speed_actuator.requests if r.drive) == 0.0
    assert Bench(speed_actuator=True).ready().speed_actuator.requests[-1][1].drive is False
    standing = Bench()
    standing.speed = 0.0
    standing.ready()
    assert standing.state is STANDBY
    assert Cause.TOO_SLOW.value in standing.shown.refusals


def test_a_speed_actuator_that_the_operator_overrides_ends_driving():
    bench = driving(speed_actuator=True)
    bench.speed_actuator.changes["overridden"] = True
    bench.run()
    assert bench.state is OVERRIDE
    assert not bench.speed_actuator.requests[-1][1].drive


def test_a_reverse_command_is_slowed_in_its_direction():
    bench = driving(speed_actuator=True)
    bench.command, bench.speed = {"speed": -1.0}, -1.0
    bench.run(0.5)
    bench.controller = {"tractor_quality": 4}
    bench.run(0.6)
    assert bench.state is DEGRADED
    assert bench.speed_actuator.requests[-1][1].speed == -0.5


# --- records and operators


def test_too_many_records_in_a_tick_are_refused():
    bench = driving()
    for _ in range(14):
        bench.channel.waiting.append(bench.command_record())
    bench.run()
    assert bench.state is ACTIVE
    assert bench.channel.most == 17
    for _ in range(20):
        bench.channel.waiting.append(bench.command_record())
    bench.run()
    assert (bench.state, bench.cause, bench.shown.rejects) == (FAULT, Cause.COMMAND_REFUSED, 1)


def test_a_refused_record_keeps_from_engaging_for_a_while():
    bench = Bench().ready()
    bench.channel.waiting.append(b"garbage")
    bench.run(1.9)
    assert Cause.COMMAND_REFUSED.value in bench.shown.refusals
    bench.run(0.2)
    assert Cause.COMMAND_REFUSED.value not in bench.shown.refusals


def test_a_look_is_urgent_only_while_it_steers():
    bench = Bench().ready()
    bench.ask(Action.STOP)
    assert not bench.hear()
    bench = driving()
    assert bench.hear(), "a new command does not wait"
    assert not bench.gate.hear(bench.time)
    for action in (Action.STOP, Action.RELEASE, Action.EMERGENCY):
        bench.ask(action)
        assert bench.gate.hear(bench.time)
    assert not bench.gate.hear(bench.time)
    assert not bench.gate.hear(bench.time + 0.19)
    assert bench.gate.hear(bench.time + 0.21), "the command has expired"
    bench = driving()
    bench.channel.waiting.append(b"garbage")
    assert bench.hear()
    bench = driving()
    bench.channel.gone = True
    assert bench.hear()


def test_frames_and_records_that_are_dropped_are_counted():
    bench = Bench()
    bench.desk.waiting += [b"garbage", encode(bench_command())]
    bench.transport.waiting = [Received(time=100.0, data=b"x", source="1.2.3.4:5")]
    bench.run()
    assert bench.shown.dropped == 2 + 2, "two records, and one frame of each actuator"
    assert bench.tractor.received == [(100.0, b"x", "1.2.3.4:5")]
    assert set(bench.desk.subscribed) == {"front"}


def bench_command():
    return CommandMessage(time=0, valid_until=0, mode=Mode.IDLE, tractor_angle=0.0, trailer_angle=0.0, speed=0.0)


def test_its_state_goes_to_the_controller_and_to_all_others():
    bench = Bench().run(0.5)
    assert bench.channel.sent == bench.desk.sent
    states = [decode(record, GateState) for record in bench.channel.sent]
    assert [state.sequence for state in states] == list(range(10))
    assert all(state.valid_until - state.time == 10**9 for state in states)
    assert len(states[-1].refusals) == 8


def test_at_most_eight_refusals_are_shown_the_lowest_codes_first():
    bench = Bench()
    bench.controller = bench.command = None
    bench.run(0.2)
    assert list(bench.shown.refusals) == sorted(bench.shown.refusals)
    assert bench.shown.refusals[0] == 101
    assert bench.shown.refusals[-1] > 0


def test_the_recorder_must_live_and_write():
    bench = Bench().ready()
    bench.recorder = 0
    bench.run(0.1)
    assert Cause.NOT_RECORDING.value in bench.shown.refusals
    bench.recorder = 1
    bench.run(0.1)
    assert Cause.NOT_RECORDING.value not in bench.shown.refusals
    bench.recorder = None
    bench.desk.waiting.append(
        encode(Heartbeat(time=1, valid_until=1, role=Role.RECEIVERS, healthy=1, state=SupervisorState.READY))
    )
    bench.run(1.1)
    assert Cause.NOT_RECORDING.value in bench.shown.refusals
    bench = driving()
    bench.recorder = 0
    bench.run(5.0)
    assert bench.state is ACTIVE, "control goes on without it"
    assert bench.shown.refusals[0] == Cause.NOT_RECORDING.value, "and the operator is told"


def test_the_emergency_stop_must_have_been_tried():
    bench = Bench().run(20.0)
    assert bench.state is STANDBY
    assert bench.shown.refusals[:2] == (Cause.EMERGENCY_UNTRIED.value, 0)


def test_a_switch_at_the_actuator_engages_by_its_edge_and_releases():
    bench = Bench()
    bench.tractor.changes["switch"] = False
    bench.ready()
    bench.operator = False
    bench.run(5.0)
    assert bench.state is READY, "a switch is an operator too"
    bench.tractor.changes["switch"] = True
    bench.run()
    assert bench.state is ENGAGING
    bench.run(10.0)
    assert bench.state is ACTIVE
    bench.tractor.changes["switch"] = False
    bench.run()
    assert bench.state is STANDBY


def test_a_switch_that_was_on_before_does_not_engage():
    bench = Bench()
    bench.tractor.changes["switch"] = True
    bench.ready().run(10.0)
    assert bench.state is READY


def test_after_a_fault_it_takes_acknowledgement_and_a_new_edge():
    bench = driving()
    bench.tractor.changes["engaged"] = False
    bench.run()
    assert bench.state is FAULT
    bench.tractor.changes.clear()
    bench.ask(Action.ARM)
    bench.ask(Action.ENGAGE)
    bench.run(5.0)
    assert bench.state is FAULT
    bench.ask(Action.ACKNOWLEDGE)
    bench.run()
    assert bench.state is FAULT, "it does not stand"
    bench.speed = 0.0
    bench.run(1.0)
    bench.ask(Action.ACKNOWLEDGE)
    bench.run(1.2)
    assert bench.state is STANDBY
    bench.speed = 1.0
    bench.run(3.0)
    assert bench.state is READY
    bench.engage().run(2.0)
    assert bench.state is ACTIVE


# --- any stream


@given(data=st.data())
@settings(derandomize=True, max_examples=25, deadline=None)
def test_whatever_the_controller_sends_the_wire_stays_within_the_envelope(data):
    bench = driving()
    number = st.floats(allow_nan=True, allow_infinity=True) | st.floats(-0.6, 0.6)
    for _ in range(data.draw(st.integers(1, 12))):
        if data.draw(st.integers(0, 5)) == 0:
            bench.channel.waiting.append(data.draw(st.binary(max_size=60)))
        bench.command = {name: data.draw(number) for name in ("tractor_angle", "trailer_angle", "speed")}
        bench.run()
    for actuator, limit in ((bench.tractor, BOUNDS.tractor_limit), (bench.trailer, BOUNDS.trailer_limit)):
        for _, request in actuator.requests:
            assert math.isfinite(request.angle)
            assert not request.steer or abs(request.angle) <= limit
    off = [not request.steer for _, request in bench.tractor.requests]
    first = max((i for i, each in enumerate(off) if not each), default=0)
    assert all(off[first + 1 :]), "once off, off"


def test_two_wires_and_their_faults_are_apart():
    bench = Bench()
    other = Bench()
    other.transport.read = None
    gate = Gate(
        bench.settings, BOUNDS,
        [Wire(transport=b.transport, **{n: getattr(b, n)}) for b, n in ((other, "tractor"), (bench, "trailer"))],
        bench.channel, bench.desk,
    )  # fmt: skip
    gate.hear(bench.time)
    gate.tick(bench.time)
    assert gate.engagement.state in (FAULT, SupervisorState.SELFTEST)
    gate.tick(bench.time + TICK)
    assert (gate.engagement.state, gate.engagement.cause) == (FAULT, Cause.DEVICE)
    assert other.transport.written[-1] == b"tractor off"
    assert bench.transport.written[-1] == b"trailer off"
    gate.wires.close()
    assert bench.transport.closed
    assert other.transport.closed


def test_limits_that_do_not_limit_are_a_fault_at_the_start(monkeypatch):
    monkeypatch.setattr(machine_gate, "limits_hold", lambda *given: False)
    bench = Bench().run(0.2)
    assert (bench.state, bench.cause) == (FAULT, Cause.SELFTEST)

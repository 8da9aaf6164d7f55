"""The gate on the bench: what it tells the actuators, whatever controller, operators and devices do."""

import math

import pytest
from gate_bench import BOUNDS, TICK, Bench, driving, told
from hypothesis import given, settings
from hypothesis import strategies as st

from drawbar.messages import Action, CommandMessage, GateState, Heartbeat, Mode, Role, SupervisorState
from drawbar.messages.records import decode, encode
from drawbar.safety import machine_gate
from drawbar.safety.causes import Cause
from drawbar.safety.engagement import ACTIVE, ENGAGING, FAULT, READY, STANDBY, STEERING
from drawbar.safety.machine_gate import Gate
from drawbar.safety.wires import Wire
from drawbar.transports.base import Received

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
    assert 5 < bench.shown.clips < 20
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


@pytest.mark.parametrize("false", [{"receiver_speed": 10.0}, {"wheel_speed": 10.0}, {"wheel_speed": 0.0}])
def test_boards_are_told_no_false_speed_at_which_they_release_or_turn_no_wheel(false):
    bench = driving()
    bench.controller = false
    bench.run(0.2)
    bench.controller = {}
    bench.run(0.2)
    assert all(0.9 < request.speed < 1.5 for _, request in bench.tractor.requests[-8:])
    assert bench.state in STEERING


def test_without_a_trailer_actuator_the_tractor_is_steered_alone():
    bench = driving(trailer=False)
    assert bench.transport.written[-1] == b"tractor on"
    shown = bench.shown
    assert math.isnan(shown.trailer_angle)
    assert math.isnan(shown.trailer_set_point)
    assert (shown.trailer_angle_time, shown.engaged) == (0, 1)


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
    assert bench.shown.rejects == 1
    assert Cause.COMMAND_REFUSED.value in bench.shown.refusals
    bench.run(0.2)
    assert Cause.COMMAND_REFUSED.value not in bench.shown.refusals


@pytest.mark.parametrize("where", [("transport", "read"), ("channel", "receive")], ids=["bus", "processor"])
def test_a_command_that_comes_while_a_busy_bus_is_read_or_the_gate_waits_for_a_processor_is_taken(where):
    bench = driving()
    refused, place, call = bench.shown.rejects, getattr(bench, where[0]), where[1]
    read = getattr(place, call)

    def takes_20_ms(*arguments):
        setattr(place, call, read)
        bench.time += 0.02
        times = {"time": bench.ns(bench.time), "valid_until": bench.ns(bench.time + 0.2)}
        bench.channel.waiting.append(bench.command_record(tractor_angle=0.01, **times))
        return read(*arguments)

    setattr(place, call, takes_20_ms)
    assert bench.gate.receive(lambda: bench.time), "it is taken"
    bench.run(0.1)
    assert bench.shown.rejects == refused
    assert bench.state is SupervisorState.ACTIVE


def test_a_look_is_urgent_only_while_it_steers():
    bench = Bench().ready()
    bench.ask(Action.STOP)
    assert not bench.receive()
    bench = driving()
    assert not bench.receive(), "a repeated one waits"
    for changes in ({"tractor_angle": 0.01}, {"trailer_angle": 0.01}, {"speed": 1.1}, {"mode": Mode.STOP}):
        bench.command |= changes
        assert bench.receive(), "a new command does not wait"
    assert not bench.gate.receive(lambda: bench.time)
    for action in (Action.STOP, Action.RELEASE, Action.EMERGENCY):
        bench.ask(action)
        assert bench.gate.receive(lambda: bench.time)
    assert not bench.gate.receive(lambda: bench.time)
    assert not bench.gate.receive(lambda: bench.time + 0.19)
    assert bench.gate.receive(lambda: bench.time + 0.21), "the command has expired"
    bench = driving()
    bench.channel.waiting.append(b"garbage")
    assert bench.receive()
    bench = driving()
    bench.channel.gone = True
    assert bench.receive()


def test_an_angle_that_a_late_tick_has_not_asked_for_is_not_missed_before_the_next_tick():
    bench = driving()
    bench.tractor.silent_since = bench.time
    bench.time += 0.22
    bench.receive()
    bench.gate.tick(bench.time, 0.13)
    assert bench.state is ACTIVE
    bench.run()
    assert (bench.state, bench.cause) == (SupervisorState.STOPPING, Cause.STEERING_OLD)


def test_frames_and_records_that_are_dropped_are_counted():
    bench = Bench()
    bench.operators.waiting += [b"garbage", encode(bench_command())]
    bench.transport.waiting = [Received(time=100.0, data=b"x", source="1.2.3.4:5")]
    bench.run()
    assert bench.shown.dropped == 2 + 2, "two records, and one frame of each actuator"
    assert bench.tractor.received == [(100.0, b"x", "1.2.3.4:5")]
    assert set(bench.operators.subscribed) == {"front"}
    assert bench.operators.most == 64


def bench_command():
    return CommandMessage(time=0, valid_until=0, mode=Mode.IDLE, tractor_angle=0.0, trailer_angle=0.0, speed=0.0)


def test_its_state_goes_to_the_controller_and_to_all_others():
    bench = Bench().run(0.5)
    assert bench.channel.sent == bench.operators.sent
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
    bench.operators.waiting.append(
        encode(Heartbeat(time=1, valid_until=1, role=Role.RECEIVERS, healthy=1, state=SupervisorState.READY))
    )
    bench.run(1.1)
    assert Cause.NOT_RECORDING.value in bench.shown.refusals
    bench = driving()
    bench.recorder = 0
    bench.run(5.0)
    assert bench.state is ACTIVE, "control goes on without it"
    assert bench.shown.refusals[0] == Cause.NOT_RECORDING.value, "and the operator is told"


def test_the_guard_must_live():
    bench = Bench().ready()
    assert Cause.NOT_GUARDED.value not in bench.shown.refusals
    bench.guard = None
    bench.run(0.9)
    assert Cause.NOT_GUARDED.value not in bench.shown.refusals
    bench.run(0.2)
    assert Cause.NOT_GUARDED.value in bench.shown.refusals
    bench.ask(Action.ARM)
    bench.run(0.2)
    assert bench.state is SupervisorState.STANDBY
    for guard in (None, 0):
        bench = driving()
        bench.guard = guard
        bench.run(5.0)
        assert bench.state is ACTIVE, "control goes on without it, and without the boards' sockets"
        assert bench.shown.refusals[0] == Cause.NOT_GUARDED.value, "and the operator is told"


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
        bench.channel, bench.operators,
    )  # fmt: skip
    gate.receive(lambda: bench.time)
    gate.tick(bench.time, 0.0)
    assert gate.engagement.state in (FAULT, SupervisorState.SELFTEST)
    gate.tick(bench.time + TICK, 0.0)
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

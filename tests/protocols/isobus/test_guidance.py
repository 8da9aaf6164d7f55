"""The steering valve's actuator: cadence, conditions, edges, latches, and what ends steering."""

import math
from dataclasses import replace
from itertools import pairwise

import pytest
from isobus_bench import GOOD, NAME, OWN, PASSING, VALVE, WHEELBASE, Bench

from drawbar.protocols.actuator import Readiness
from drawbar.protocols.isobus.address import CLAIM
from drawbar.protocols.isobus.curvature import WheelbaseCurvature
from drawbar.protocols.isobus.guidance import GuidanceValve
from drawbar.protocols.isobus.guidance_messages import (
    SYSTEM_COMMAND,
    ExitReason,
    Intention,
    LimitStatus,
    MachineInfo,
    SystemCommand,
    decode_command,
    encode_command,
    encode_machine_info,
)
from drawbar.protocols.isobus.identifier import GLOBAL, Message, decode, encode
from drawbar.protocols.isobus.name import Name
from drawbar.transports.base import CanFrame

OFF, ON = Intention.NOT_INTENDED, Intention.INTENDED
STRONGER = Name(identity=1, manufacturer=1407, function=29, device_class=1)
UNAVAILABLE = MachineInfo()
ENDINGS = [
    ({"locked_out": True}, Readiness.LOCKED_OUT),
    ({"ready": False}, Readiness.NOT_READY),
    ({"ready": None}, Readiness.NOT_READY),
    ({"locked_out": None}, Readiness.NOT_READY),
    ({"in_position": False}, Readiness.NOT_READY),
    ({"reset_required": True}, Readiness.NOT_READY),
    ({"limit": LimitStatus.OPERATOR}, Readiness.OVERRIDDEN),
    ({"limit": LimitStatus.NON_RECOVERABLE}, Readiness.FAULT),
    ({"limit": 4}, Readiness.NOT_READY),
    ({"curvature": math.nan}, Readiness.NOT_READY),
    ({"exit_reason": ExitReason.OPERATOR_PRESENCE}, Readiness.NOT_READY),
    ({"exit_reason": ExitReason.OPERATOR_OVERRIDE}, Readiness.OVERRIDDEN),
    ({"exit_reason": ExitReason.COMMAND_TIMEOUT}, Readiness.NOT_READY),
    ({"exit_reason": ExitReason.CONTROL_FAULT}, Readiness.FAULT),
    ({"exit_reason": ExitReason.FUNCTION_FAULT}, Readiness.FAULT),
    ({"exit_reason": ExitReason.TOO_FAST}, Readiness.NOT_READY),
    ({"exit_reason": ExitReason.OTHER_GUIDANCE}, Readiness.OTHER_MASTER),
    ({"exit_reason": ExitReason.ERROR}, Readiness.FAULT),
    ({"exit_reason": 40}, Readiness.NOT_READY),
]


def latched_off(bench: Bench) -> None:
    """Nothing but "not intended" goes out until the gate has released, and then it steers again."""
    assert {what for _, what in bench.run(2.0, steer=True)} <= {OFF}
    bench.run(0.3)
    bench.run(1.5)
    assert {what for _, what in bench.run(0.5, steer=True)} == {ON}


@pytest.mark.parametrize("period", [0.1, 0.05])
@pytest.mark.parametrize("steer", [False, True])
def test_commands_go_at_the_period_whatever_the_rate_of_send(period: float, steer: bool) -> None:
    bench = Bench(period=period)
    bench.run(2.0)
    times = [time for time, _ in bench.run(10.0, steer=steer)]
    assert len(times) == pytest.approx(10.0 / period, abs=1)
    assert all(after - before <= period + 0.021 for before, after in pairwise(times))


def test_a_new_angle_goes_a_fifth_of_the_period_early_and_the_cadence_goes_with_it() -> None:
    bench = Bench().engage()
    (*_, last) = [time for time, message in bench.sent if message.pgn == SYSTEM_COMMAND]

    def goes(after: float, angle: float) -> bool:
        frames = bench.valve.send(last + after, bench.request(True, angle))
        return any(decode(frame).pgn == SYSTEM_COMMAND for frame in frames)

    assert not goes(0.085, 0.1), "what was said already waits for its turn"
    assert not goes(0.075, 0.2)
    assert goes(0.085, 0.2)
    assert not goes(0.15, 0.2)
    assert not goes(0.16, 0.3)
    assert goes(0.184, 0.2), "100 ms after the new angle"


@pytest.mark.parametrize("tick", [0.001, 0.02, 0.033, 0.049, 0.0999, 0.1, 0.1001])
def test_no_gap_between_commands_reaches_the_time_out_of_a_valve(tick: float) -> None:
    bench = Bench()
    times = []
    for number in range(round(30.0 / tick)):
        times += [
            number * tick
            for frame in bench.valve.send(number * tick, bench.request(False))
            if (message := decode(frame)) is not None and message.pgn == SYSTEM_COMMAND
        ]
    assert len(times) == pytest.approx(290, rel=0.35)
    assert max(after - before for before, after in pairwise(times)) < 0.15


def test_nothing_is_commanded_before_the_address_is_held() -> None:
    bench = Bench()
    bench.run(1.0)
    held = next(time for time, message in bench.sent if message.pgn == SYSTEM_COMMAND)
    assert held >= 0.5
    assert [message.pgn for _, message in bench.sent[:2]] == [0xEA00, CLAIM]


def test_it_steers_by_the_tangent_right_positive() -> None:
    bench = Bench().engage()
    bench.tick(steer=True, angle=0.3)
    bench.run(0.2, steer=True, angle=0.3)
    message = bench.sent[-1][1]
    assert (message.destination, message.priority, message.source) == (GLOBAL, 3, OWN)
    raw = message.data[0] | message.data[1] << 8
    assert abs(-0.25e-3 * (raw - 32128) - math.tan(0.3) / WHEELBASE) <= 0.125e-3
    assert raw < 32128


def test_measured_angle_and_its_time_are_reported() -> None:
    bench = Bench()
    bench.run(0.1)
    report = bench.valve.report(0.15)
    assert report.angle == pytest.approx(math.atan(WHEELBASE * 0.1))
    assert report.angle_time == 0.0
    bench.info = replace(GOOD, curvature=math.nan)
    bench.run(0.2)
    assert math.isnan(bench.valve.report(bench.time).angle)


def test_readiness_while_it_comes_up() -> None:
    bench = Bench()
    seen = []
    for _ in range(150):
        bench.tick()
        readiness = bench.valve.report(bench.time).readiness
        seen += [readiness] if seen[-1:] != [readiness] else []
    assert seen == [Readiness.ADDRESS_LOST, Readiness.TOO_NEW, Readiness.READY]


def test_request_that_has_stood_since_the_start_is_no_edge() -> None:
    bench = Bench()
    assert {what for _, what in bench.run(4.0, steer=True)} == {OFF}
    assert bench.valve.report(bench.time).readiness is Readiness.SWITCHED_ON
    latched_off(bench)


@pytest.mark.parametrize(("change", "cause"), ENDINGS)
def test_a_state_of_the_valve_ends_steering_at_once(change: dict[str, object], cause: Readiness) -> None:
    bench = Bench().engage()
    bench.tell(**change)
    assert [_what(message) for message in bench.tick(steer=True)] == [OFF]
    report = bench.valve.report(bench.time)
    assert (report.readiness, report.engaged) == (cause, False)
    assert report.overridden == (cause is Readiness.OVERRIDDEN)
    latched_off(bench)
    assert not bench.valve.report(bench.time).overridden


STANDING = [ending for ending in ENDINGS if ending[0].get("exit_reason") not in PASSING]


@pytest.mark.parametrize(("change", "cause"), [*STANDING, ({"limit": LimitStatus.LIMITED_HIGH}, Readiness.NOT_READY)])
def test_a_state_of_the_valve_refuses_to_engage(change: dict[str, object], cause: Readiness) -> None:
    bench = Bench()
    bench.info = replace(GOOD, **change)
    bench.run(2.0)
    assert bench.valve.report(bench.time).readiness is cause
    assert {what for _, what in bench.run(0.5, steer=True)} == {OFF}
    bench.info = GOOD
    latched_off(bench)


def test_it_is_engaged_only_once_the_valve_has_answered() -> None:
    bench = Bench()
    bench.run(2.0)
    seen = []
    for _ in range(20):
        sent = [_what(message) for message in bench.tick(steer=True)]
        seen += [(sent, bench.valve.report(bench.time).engaged)] if sent or seen else []
    begun = next(index for index, (sent, _) in enumerate(seen) if ON in sent)
    assert not seen[begun][1]
    assert seen[begun + 5][1]


def test_a_valve_that_says_nothing_of_itself_is_refused() -> None:
    bench = Bench()
    bench.info = UNAVAILABLE
    bench.run(2.0)
    assert bench.valve.report(bench.time).readiness is Readiness.NOT_READY
    assert {what for _, what in bench.run(0.5, steer=True)} == {OFF}


@pytest.mark.parametrize("limit", [LimitStatus.LIMITED_HIGH, LimitStatus.LIMITED_LOW])
def test_a_valve_at_its_stop_goes_on_steering(limit: LimitStatus) -> None:
    bench = Bench().engage()
    bench.info = replace(GOOD, limit=limit)
    assert {what for _, what in bench.run(1.0, steer=True)} == {ON}


def test_silence_of_the_valve_ends_steering() -> None:
    bench = Bench().engage()
    bench.info, last = None, bench.time
    commands = bench.run(1.0, steer=True)
    ended = next(time for time, what in commands if what is OFF)
    assert 0.2 < ended - last <= 0.33
    assert bench.valve.report(bench.time).readiness is Readiness.SILENT
    bench.info = GOOD
    latched_off(bench)


def test_a_gap_that_no_tick_saw_ends_steering_too() -> None:
    bench = Bench().engage()
    bench.valve.receive(bench.time + 0.5, encode(Message(pgn=0xAC00, source=VALVE, data=encode_machine_info(GOOD))))
    bench.info = None
    assert OFF in map(_what, bench.tick(steer=True))
    assert bench.valve.report(bench.time).readiness is Readiness.SILENT


@pytest.mark.parametrize("angle", [math.nan, math.inf, -math.inf, math.pi / 2, 1.5])
def test_an_angle_that_cannot_be_said_ends_steering(angle: float) -> None:
    bench = Bench().engage()
    assert {what for _, what in bench.run(0.2, steer=True, angle=angle)} == {OFF}
    assert bench.valve.dropped["command out of range"] == 1
    latched_off(bench)


def test_an_angle_that_cannot_be_said_does_not_matter_while_it_is_released() -> None:
    bench = Bench().engage()
    assert {what for _, what in bench.run(1.0, angle=math.nan)} == {OFF}
    assert {what for _, what in bench.run(0.5, steer=True)} == {ON}


def test_a_release_is_said_at_once_and_the_period_begins_anew() -> None:
    bench = Bench().engage()
    while not bench.tick(steer=True):
        pass
    begun = bench.time
    commands = bench.run(1.0)
    assert commands[0] == (pytest.approx(begun), OFF)
    assert all(after - before == pytest.approx(0.1) for (before, _), (after, _) in pairwise(commands))


def test_between_two_engagements_stands_one_message_not_intended() -> None:
    bench = Bench().engage()
    bench.tick(steer=False)
    bench.run(0.3, steer=True)
    commands = [_what(message) for _, message in bench.sent if message.pgn == SYSTEM_COMMAND]
    assert commands[-1] is ON
    assert OFF in commands[commands.index(ON) :]


def test_loss_of_the_address_ends_steering_and_latches() -> None:
    bench = Bench().engage()
    bench.receive(CLAIM, STRONGER.data, OWN)
    assert [message.pgn for message in bench.tick(steer=True)] == [CLAIM]
    assert bench.valve.report(bench.time).readiness is Readiness.ADDRESS_LOST
    commands = bench.run(2.0, steer=True)
    assert {what for _, what in commands} == {OFF}
    assert commands[0][0] - bench.time + 2.0 == pytest.approx(0.25, abs=0.05)
    assert {message.source for time, message in bench.sent if time > bench.time - 1.9} == {0x80}
    latched_off(bench)


@pytest.mark.parametrize("ticks", range(10, 18))
def test_the_first_command_from_a_new_address_is_not_intended(ticks: int) -> None:
    bench = Bench()
    bench.run(2.0)
    bench.receive(CLAIM, STRONGER.data, OWN)
    bench.run(ticks * 0.02)
    bench.run(0.5, steer=True)
    from_new = [_what(message) for _, message in bench.sent if message.source == 0x80 and message.pgn == SYSTEM_COMMAND]
    assert from_new[0] is OFF


def test_a_device_that_may_not_move_is_silent_after_the_loss() -> None:
    bench = Bench(name=replace(NAME, self_configurable=False)).engage()
    bench.receive(CLAIM, replace(STRONGER, self_configurable=False).data, OWN)
    bench.run(1.0, steer=True)
    assert [message.pgn for time, message in bench.sent if time > bench.time - 1.0] == [CLAIM]
    assert bench.valve.report(bench.time).readiness is Readiness.ADDRESS_LOST


def test_a_weaker_claim_does_not_end_steering() -> None:
    bench = Bench().engage()
    bench.receive(CLAIM, replace(NAME, identity=5000).data, OWN)
    assert CLAIM in [message.pgn for message in bench.tick(steer=True)]
    assert {what for _, what in bench.run(1.0, steer=True)} == {ON}


def test_another_with_our_address_ends_steering_and_latches() -> None:
    bench = Bench().engage()
    bench.receive(0xFE48, bytes(8), OWN)
    sent = bench.tick(steer=True)
    assert [message.pgn for message in sent] == [CLAIM, SYSTEM_COMMAND]
    assert _what(sent[1]) is OFF
    assert bench.valve.report(bench.time).readiness is Readiness.ADDRESS_LOST
    bench.run(5.0, steer=True)
    latched_off(bench)


@pytest.mark.parametrize("destination", [GLOBAL, VALVE])
def test_another_that_steers_ends_steering_and_refuses(destination: int) -> None:
    bench = Bench().engage()
    command = encode_command(SystemCommand(curvature=0.0, intention=ON))
    bench.receive(SYSTEM_COMMAND, command, 0x55, destination=destination)
    assert OFF in map(_what, bench.tick(steer=True))
    assert bench.valve.report(bench.time).readiness is Readiness.OTHER_MASTER
    latched_off(bench)


def test_another_that_steers_is_not_disturbed_once_off_was_said_for_a_second() -> None:
    bench = Bench().engage()
    begin, said = bench.time, list[tuple[float, Intention]]()
    for _ in range(30):
        bench.receive(SYSTEM_COMMAND, encode_command(SystemCommand(curvature=0.0, intention=ON)), 0x55)
        said += bench.run(0.1)
    assert {what for _, what in said} == {OFF}
    assert 0.8 < said[-1][0] - begin < 1.1
    assert bench.valve.report(bench.time).readiness is Readiness.OTHER_MASTER
    assert not bench.run(0.9)
    assert {what for _, what in bench.run(0.5)} == {OFF}, "the other one is gone"


@pytest.mark.parametrize(("intended", "destination"), [(OFF, GLOBAL), (ON, 0x27)])
def test_another_that_does_not_steer_this_valve_does_not_matter(intended: Intention, destination: int) -> None:
    bench = Bench().engage()
    bench.receive(
        SYSTEM_COMMAND, encode_command(SystemCommand(curvature=0.0, intention=intended)), 0x55, destination=destination
    )
    assert {what for _, what in bench.run(1.0, steer=True)} == {ON}


def test_two_valves_without_addresses_are_refused() -> None:
    bench = Bench().engage()
    bench.tell(0x27)
    assert OFF in map(_what, bench.tick(steer=True))
    assert bench.valve.report(bench.time).readiness is Readiness.FAULT
    latched_off(bench)


def test_a_valve_with_an_address_is_commanded_there_and_alone_believed() -> None:
    bench = Bench(address=VALVE).engage()
    bench.tell(0x27, exit_reason=ExitReason.OPERATOR_OVERRIDE, curvature=-0.3)
    assert {what for _, what in bench.run(1.0, steer=True)} == {ON}
    assert bench.sent[-1][1].destination == VALVE
    assert bench.valve.report(bench.time).angle > 0.0


def test_two_valves_share_one_node() -> None:
    bench = Bench(address=VALVE)
    second = GuidanceValve(bench.node, WheelbaseCurvature(3.0), address=0x27)
    sent = []
    for tick in range(200):
        time = tick * 0.02
        for address, curvature in ((VALVE, 0.1), (0x27, -0.1)) if tick % 5 == 0 else ():
            data = encode_machine_info(replace(GOOD, curvature=curvature))
            frame = encode(Message(pgn=0xAC00, source=address, data=data))
            for valve in (second, bench.valve):
                valve.receive(time, frame)
        steer = tick >= 100
        for valve, angle in ((bench.valve, 0.1), (second, -0.2)):
            sent += [decode(frame) for frame in valve.send(time, bench.request(steer, angle))]
    assert sum(message.pgn == CLAIM for message in sent) == 1
    assert bench.valve.report(4.0).angle > 0.0 > second.report(4.0).angle
    last = {message.destination: decode_command(message.data) for message in sent[-4:]}
    assert last[VALVE].curvature == pytest.approx(math.tan(0.1) / WHEELBASE, abs=2e-4)
    assert last[0x27].curvature == pytest.approx(math.tan(-0.2) / 3.0, abs=2e-4)
    assert {command.intention for command in last.values()} == {ON}
    for valve in (second, bench.valve):
        valve.receive(4.0, CanFrame(-1, b""))
    assert bench.node.dropped == {"not ISO 11783": 1}


@pytest.mark.parametrize("data", [b"", bytes(7), bytes(8)[:3]])
@pytest.mark.parametrize("pgn", [0xAC00, 0xAD00])
def test_short_messages_are_counted(data: bytes, pgn: int) -> None:
    bench = Bench().engage()
    bench.receive(pgn, data)
    assert bench.valve.dropped["length"] == 1
    assert {what for _, what in bench.run(0.5, steer=True)} == {ON}


def test_frames_that_are_none_of_iso_11783_are_counted() -> None:
    bench = Bench().engage()
    for frame in (CanFrame(1 << 29, b""), CanFrame(-1, b""), CanFrame(0x0CACFF26, bytes(64))):
        bench.feed(frame)
    assert bench.node.dropped == {"not ISO 11783": 3}


def _what(message: Message) -> Intention | None:
    command = decode_command(message.data) if message.pgn == SYSTEM_COMMAND else None
    return command.intention if command is not None else None

"""The adapter of a steer board, rule by rule, in a closed loop with stand-ins of both firmwares and their clock."""

import math
import struct
from itertools import pairwise

import pytest
from steer_bench import HOST, Bench

from drawbar.errors import ConfigurationError
from drawbar.machine.stand_in.wheel import MotorWheel
from drawbar.protocols.actuator import Readiness, SteeringRequest
from drawbar.protocols.agopengps.frame import PREFIX, STEER_BOARD, Pgn, pack, parse
from drawbar.protocols.agopengps.network import HELLO
from drawbar.protocols.agopengps.steer_board import SteerBoard
from drawbar.protocols.agopengps.steering import decode_steer

RATES = (5.0, 10.0, 20.0, 50.0, 100.0)
OFF = SteeringRequest(steer=False, angle=0.0, speed=1.0)


@pytest.mark.parametrize("rate", RATES)
def test_engages_at_every_rate_of_calls_and_keeps_below_40_hz(firmware: str, rate: float) -> None:
    """Rule 5: 10 to 20 Hz, never above 40, whatever the rate of the control."""
    bench = Bench(firmware, rate)
    bench.engage()
    bench.run(3.0)
    assert bench.report.engaged
    first = next(place for place, (_, command) in enumerate(bench.sent) if command.steer)
    assert not any(command.steer for _, command in bench.sent[:first])
    assert first >= 3
    times = [time for time, _ in bench.sent]
    assert min(after - before for before, after in pairwise(times)) >= 0.025
    assert (len(times) - 1) / (times[-1] - times[0]) >= min(rate, 10.0) * 0.99


@pytest.mark.parametrize("after", [0.011, 0.03, 0.044])
def test_a_new_set_point_to_a_board_that_steers_does_not_wait_for_its_turn(firmware: str, after: float) -> None:
    bench = Bench(firmware)
    bench.engage()
    time = bench.sent[-1][0] + after
    assert not bench.adapter.send(time - 0.002, bench.request), "what was said already waits for its turn"
    bench.ask(steer=True, angle=0.2)
    (frame,) = bench.adapter.send(time, bench.request)
    assert frame[8:10] == struct.pack("<h", -round(100.0 * math.degrees(0.2)))
    third = SteeringRequest(steer=True, angle=0.1, speed=1.0)
    assert not bench.adapter.send(time + 0.049 - after, third), "above 40 Hz"
    assert bench.adapter.send(time + max(0.051 - after, 0.011), third)


def test_a_new_set_point_waits_while_the_board_does_not_steer_yet(firmware: str) -> None:
    bench = Bench(firmware)
    bench.run(2.5)
    bench.ask(steer=True)
    bench.tick()
    edge, command = bench.sent[-1]
    assert command.steer
    bench.ask(steer=True, angle=0.2)
    assert not bench.adapter.send(edge + 0.06, bench.request), "an AIO v4 would forget the edge"


def test_set_points_that_change_all_the_time_stay_below_40_hz(firmware: str) -> None:
    """Rule 5: nor by set points that are new each time."""
    bench = Bench(firmware, rate=200.0)
    bench.engage()
    for step in range(400):
        bench.ask(steer=True, angle=0.1 + 0.0005 * step)
        bench.tick()
    assert bench.report.engaged
    times = [time for time, _ in bench.sent]
    assert min(after - before for before, after in zip(times, times[2:], strict=False)) >= 0.05 - 1e-9
    assert (len(times[-50:]) - 1) / (times[-1] - times[-50]) > 35.0


@pytest.mark.parametrize("phase", range(25))
def test_no_phase_between_computer_and_board_loses_the_edge(phase: int) -> None:
    bench = Bench("v4", 100.0)
    bench.board.restart(bench.start + phase / 1000.0)
    bench.engage()
    assert bench.board.driving


def test_the_wheel_follows_the_set_point(firmware: str) -> None:
    bench = Bench(firmware, wheel=MotorWheel())
    bench.engage()
    bench.ask(steer=True, angle=-0.15)
    bench.run(5.0)
    assert bench.wheel.angle == pytest.approx(-0.15, abs=math.radians(0.3))
    assert bench.report.angle == pytest.approx(bench.wheel.angle, abs=math.radians(0.1))
    assert bench.time - bench.report.angle_time <= 0.1


def test_a_request_that_stands_from_the_beginning_is_no_edge(firmware: str) -> None:
    """Rule 1 of hardware.md 3.4: it engages by an edge, never by a level."""
    bench = Bench(firmware)
    bench.ask(steer=True)
    bench.run(6.0)
    assert bench.ones_after(0.0) == 0
    assert bench.report.readiness is Readiness.SILENT  # as it was when it was asked
    bench.ask(steer=False)
    bench.run(0.1)
    bench.ask(steer=True)
    bench.run(1.0)
    assert bench.report.engaged


def test_a_request_before_the_board_is_ready_is_refused_until_it_is_made_again(firmware: str) -> None:
    bench = Bench(firmware)
    bench.run(0.5)
    bench.ask(steer=True)
    bench.run(4.0)
    assert bench.ones_after(0.0) == 0
    assert bench.report.readiness is Readiness.TOO_NEW


def test_engages_again_and_again_whenever_it_is_asked(firmware: str) -> None:
    bench = Bench(firmware, 100.0)
    for late in range(6):  # set points leave with every fifth call
        bench.run(0.01 * late)
        bench.engage()
        bench.ask(steer=False)
        bench.run(1.0)
    assert not bench.adapter.releases


def test_a_board_that_falls_silent_is_no_longer_ready(firmware: str) -> None:
    bench = Bench(firmware)
    bench.run(2.5)
    bench.replies_pass = False
    bench.run(0.4)
    assert bench.report.readiness is Readiness.READY
    bench.run(0.2)
    assert bench.report.readiness is Readiness.SILENT
    bench.ask(steer=True)
    bench.run(1.0)
    assert bench.ones_after(0.0) == 0


def test_a_board_whose_angle_jumps_is_not_ready_until_it_has_kept_still_for_a_second(firmware: str) -> None:
    bench = Bench(firmware)
    bench.run(2.5)
    bench.wheel.angle += math.radians(8.0)
    bench.run(0.2)
    jumped = bench.time
    assert bench.report.readiness is Readiness.FAULT
    while bench.report.readiness is Readiness.FAULT:
        bench.tick()
    assert bench.report.readiness is Readiness.READY
    assert 0.75 <= bench.time - jumped <= 1.0


def test_a_board_must_be_heard_for_a_second_without_a_break(firmware: str) -> None:
    """Rule 1: heard for a second before every engagement."""
    bench = Bench(firmware)
    for _ in range(2):
        bench.replies_pass = False
        bench.run(2.0)
        bench.replies_pass = True
        heard = bench.time
        while bench.report.readiness is not Readiness.READY:
            bench.tick()
            assert bench.time <= heard + 1.3
        assert bench.time >= heard + 1.0


@pytest.mark.parametrize("rate", [5.0, 10.0])
def test_a_fast_wheel_is_plausible(rate: float) -> None:
    bench = Bench("v4", rate)
    bench.engage()
    for _ in range(5):
        bench.wheel.angle += math.radians(40.0) / rate
        bench.tick()
    assert bench.report.engaged


def test_set_points_beyond_the_machines_limit_are_clamped() -> None:
    """Rule 6: clamped before it is rounded."""
    bench = Bench("v4")
    bench.engage()
    for angle in (1.0, -1e300):
        bench.ask(steer=True, angle=angle)
        bench.run(0.1)
        assert bench.sent[-1][1].angle == pytest.approx(math.copysign(math.radians(35.0), angle), abs=1e-4)


def test_hello_goes_out_every_two_seconds() -> None:
    adapter = SteerBoard(board="192.168.5.126", max_angle=0.5)
    times = [t / 50.0 for t in range(500) if HELLO in adapter.send(t / 50.0, OFF)]
    assert times == [0.0, 2.0, 4.0, 6.0, 8.0]


def test_an_inverted_joint_turns_both_ways_of_the_wire() -> None:
    plain, inverted = (SteerBoard(board="192.168.6.126", max_angle=0.349, inverted=each) for each in (False, True))
    reply = pack(STEER_BOARD, Pgn.STEER_REPLY, struct.pack("<hhhBB", 200, 9999, 8888, 7, 0))
    for board in (plain, inverted):
        board.receive(0.0, reply, "192.168.6.126:8888")
    assert plain.report(0.0).angle == pytest.approx(-math.radians(2.0))
    assert inverted.report(0.0).angle == pytest.approx(math.radians(2.0))
    assert plain.send(0.0, OFF)[0] == inverted.send(0.0, OFF)[0]  # both say: stay at 2 degrees of the wire
    signs = []
    for board in (plain, inverted):
        for step in range(1, 60):
            time = 0.05 * step
            board.receive(time, reply, "192.168.6.126:8888")
            sent = board.send(time, SteeringRequest(steer=step > 50, angle=0.1, speed=1.0))
        frame = parse(sent[0])
        command = decode_steer(frame)  # type: ignore[arg-type]
        assert command is not None
        assert command[0].steer
        signs.append(command[0].angle)
    assert signs == pytest.approx([0.1, -0.1], abs=1e-4)


@pytest.mark.parametrize(
    ("board", "taken"), [("192.168.5.126", True), ("192.168.5.126:8888", True), (HOST[:-1], False)]
)
def test_boards_are_told_apart_by_their_senders(board: str, taken: bool) -> None:
    adapter = SteerBoard(board=board, max_angle=0.5)
    reply = pack(STEER_BOARD, Pgn.STEER_REPLY, bytes(8))
    adapter.receive(1.0, reply, HOST)
    assert (adapter.report(1.0).angle_time == 1.0) is taken
    adapter.receive(2.0, reply, "192.168.6.126:8888")
    assert adapter.report(2.0).angle_time < 2.0
    assert adapter.dropped["other sender"] == (1 if taken else 2)


def test_what_is_dropped_is_counted_by_kind() -> None:
    adapter = SteerBoard(board="192.168.5.126", max_angle=0.5)
    reply = pack(STEER_BOARD, Pgn.STEER_REPLY, bytes(8))
    for datagram in (b"", reply[:-1] + b"\0", reply[:-1], b"x" * 20, pack(STEER_BOARD, 17, b""), PREFIX + b"\x7f\xfd"):
        adapter.receive(1.0, datagram, HOST)
    assert adapter.report(1.0).angle_time == -math.inf
    assert sorted(adapter.dropped.values()) == [1, 1, 1, 1, 2]


@pytest.mark.parametrize("angle", [0.0, -0.1, math.nan, math.inf, math.radians(50.0)])
def test_a_limit_beyond_what_boards_steer_is_refused(angle: float) -> None:
    with pytest.raises(ConfigurationError, match="50°"):
        SteerBoard(board="192.168.5.126", max_angle=angle)

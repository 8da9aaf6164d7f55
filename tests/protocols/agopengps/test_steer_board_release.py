"""When the adapter of a steer board releases or is refused, in a closed loop with stand-ins of both firmwares."""

import math
import struct
from dataclasses import replace

import pytest
from steer_bench import HOST, Bench

from drawbar.machine.stand_in.wheel import HeldWheel
from drawbar.protocols.actuator import Readiness
from drawbar.protocols.agopengps.frame import STEER_BOARD, Pgn, pack
from drawbar.protocols.agopengps.steering import SteerCommand

RATES = (5.0, 10.0, 20.0, 50.0, 100.0)
OTHER = SteerCommand(steer=True, angle=-0.2, speed=2.0).encode()


def test_a_release_stops_the_motor_with_the_next_call(firmware: str) -> None:
    bench = Bench(firmware, 100.0)
    bench.engage()
    bench.ask(steer=False)
    bench.tick()
    assert not bench.sent[-1][1].steer
    assert bench.sent[-1][0] == bench.time
    bench.run(0.03)
    assert not bench.board.driving


def test_a_board_that_was_just_released_is_not_said_to_be_switched_on(firmware: str) -> None:
    bench = Bench(firmware, 100.0)
    bench.engage()
    bench.ask(steer=False)
    said = set()
    for _ in range(200):
        bench.tick()
        said.add(bench.report.readiness)
    assert said == {Readiness.TOO_NEW, Readiness.READY}


def test_a_board_that_steers_a_second_after_its_release_is_switched_on(firmware: str) -> None:
    bench = Bench(firmware)
    bench.engage()
    bench.replies_pass = False
    bench.ask(steer=False)
    on = pack(STEER_BOARD, Pgn.STEER_REPLY, struct.pack("<hhhBB", 0, 9999, 8888, 5, 0))
    for _ in range(30):
        bench.tick()
        bench.adapter.receive(bench.time, on, HOST)
    assert bench.report.readiness is Readiness.SWITCHED_ON


def test_after_a_release_a_second_of_zeros_comes_first(firmware: str) -> None:
    """Rule 1: three frames of zeros with the steer bit off before the next edge."""
    bench = Bench(firmware)
    bench.engage()
    bench.board.override()
    bench.run(0.2)
    released = bench.time
    bench.ask(steer=False)
    bench.run(0.5)
    bench.ask(steer=True)
    bench.run(3.0)
    assert bench.ones_after(released) == 0
    assert bench.report.readiness is Readiness.TOO_NEW


def test_an_operator_who_takes_over_stops_the_motor_within_one_call(firmware: str) -> None:
    """Rule 2: the steer bit that goes off is an override; zeros at once, no engagement by itself."""
    bench = Bench(firmware)
    bench.engage()
    bench.board.override()
    bench.run(0.15)  # the board notices, says so with its next reply, and hears status 0
    taken = bench.time
    assert not bench.board.driving
    assert bench.report.overridden
    assert not bench.report.engaged
    bench.run(5.0)
    assert bench.ones_after(taken) == 0
    assert not any(driving for time, driving in bench.driven if time > taken)
    assert bench.report.readiness is Readiness.OVERRIDDEN
    assert bench.adapter.releases == {"operator took over": 1}
    bench.ask(steer=False)
    bench.run(2.0)
    assert not bench.report.overridden
    assert bench.report.readiness is Readiness.READY


def test_override_is_answered_with_status_0_at_once_whatever_the_pace() -> None:
    """Rule 2: that frame is what stops the motor."""
    bench = Bench("v4", 100.0)
    bench.engage()
    while bench.sent[-1][0] != bench.time:
        bench.tick()
    off = pack(STEER_BOARD, Pgn.STEER_REPLY, struct.pack("<hhhBB", 0, 9999, 8888, 7, 60))
    bench.adapter.receive(bench.time + 0.005, off, HOST)
    bench.tick()
    assert bench.sent[-1][0] == bench.time
    assert not bench.sent[-1][1].steer


@pytest.mark.parametrize("rate", [3.0, *RATES])
def test_missing_replies_release_for_good(firmware: str, rate: float) -> None:
    """Rule 3: 200 ms without a reply."""
    bench = Bench(firmware, rate)
    bench.engage()
    bench.replies_pass = False
    lost = bench.time
    bench.run(1.0)
    last = max(time for time, command in bench.sent if command.steer)
    assert 0.1 <= last - lost <= max(0.2, min(2.5 / rate, 0.5)) + 1e-9
    bench.replies_pass = True
    again = bench.time
    bench.run(5.0)
    assert bench.ones_after(again) == 0
    assert bench.report.readiness is Readiness.SILENT


@pytest.mark.parametrize("rate", RATES)
def test_single_lost_replies_are_borne(rate: float) -> None:
    bench = Bench("v4", rate)
    bench.engage()
    for _ in range(20):
        bench.replies_pass = False
        bench.tick()
        bench.replies_pass = True
        bench.tick()
    assert bench.report.engaged


def test_a_short_own_gap_is_no_silence_of_the_board(firmware: str) -> None:
    bench = Bench(firmware)
    bench.engage()
    bench.ticks += 10
    bench.run(1.0)
    assert bench.report.engaged
    assert not bench.adapter.releases


@pytest.mark.parametrize("outage", [0.0, 0.03, 0.1, 0.3, 1.0, 4.0])
def test_a_board_that_starts_anew_while_engaged_is_never_driven_again(firmware: str, outage: float) -> None:
    """Rule 3: such a board would engage by itself on the next frames with status 1."""
    bench = Bench(firmware)
    bench.engage()
    bench.board.restart(bench.time, outage)
    began = bench.time
    bench.run(8.0)
    assert bench.ones_after(began + 0.3) == 0
    assert not any(driving for time, driving in bench.driven if time > began + 0.3)
    assert bench.adapter.releases


def test_an_implausible_angle_releases(firmware: str) -> None:
    """Rule 3: a jump of the angle in one reply is the same."""
    for angle in (math.radians(5.2), math.radians(51.0)):
        bench = Bench(firmware)
        bench.engage()
        bench.wheel.angle = angle
        bench.run(0.2)
        assert bench.report.readiness is Readiness.FAULT
        assert not bench.board.driving
        assert bench.adapter.releases == {"implausible angle": 1}


def test_a_board_that_measures_what_cannot_be_is_refused(firmware: str) -> None:
    bench = Bench(firmware, wheel=HeldWheel(math.radians(-51.0)))
    bench.run(3.0)
    assert bench.report.readiness is Readiness.FAULT
    bench.ask(steer=True)
    bench.run(1.0)
    assert bench.ones_after(0.0) == 0


def test_engaged_means_that_the_board_says_so() -> None:
    bench = Bench("v4")
    bench.run(2.5)
    bench.replies_pass = False
    bench.ask(steer=True)
    bench.run(0.15)
    assert bench.sent[-1][1].steer
    assert bench.board.driving
    assert not bench.report.engaged


def test_an_own_gap_releases_and_asks_for_a_second_of_zeros(firmware: str) -> None:
    """Rule 4: no silence is followed by status 1."""
    bench = Bench(firmware)
    bench.engage()
    bench.ticks += 30
    bench.board.advance(bench.time + 1.5)  # what it sends meanwhile is lost too
    bench.run(0.3)
    assert not bench.report.engaged
    assert not bench.board.driving
    bench.ask(steer=False)
    bench.run(0.5)
    assert bench.report.readiness in (Readiness.TOO_NEW, Readiness.SWITCHED_ON)


def test_after_an_own_gap_the_first_second_is_zeros() -> None:
    """Rule 4: zeros for a second after an own gap."""
    bench = Bench("v26")
    bench.run(3.0)
    for _ in range(40):  # replies continue, no set points
        bench.ticks += 1
        bench.carry(bench.board.advance(bench.start + bench.ticks / bench.rate))
    gap_ended = bench.start + bench.ticks / bench.rate
    for _ in range(100):
        bench.ask(steer=not bench.request.steer)
        bench.tick()
        if bench.sent[-1][1].steer:
            break
    assert bench.time >= gap_ended + 1.0


def test_another_computer_releases_and_then_is_left_alone(firmware: str) -> None:
    bench = Bench(firmware)
    bench.engage()
    met = bench.time

    def other_sends() -> None:
        for _ in range(60):
            bench.adapter.receive(bench.time, OTHER, "192.168.5.20:9999")
            bench.tick()

    other_sends()
    assert bench.ones_after(met) == 0
    assert bench.report.readiness is Readiness.OTHER_MASTER
    assert bench.adapter.releases == {"another computer commands": 1}
    zeros = [time for time, _ in bench.sent if time > met]
    assert len(zeros) >= 10
    assert max(zeros) <= met + 1.2
    bench.ask(steer=False)
    bench.run(4.0)  # it has gone
    assert bench.sent[-1][0] >= bench.time - 0.1
    bench.run(1.0)
    assert bench.report.readiness is Readiness.READY


@pytest.mark.parametrize(
    ("source", "readiness"),
    [
        ("192.168.5.20:9999", Readiness.OTHER_MASTER),
        ("192.168.5.10:4000", Readiness.OTHER_MASTER),
        ("192.168.5.10:9999", Readiness.READY),
        ("192.168.6.20:9999", Readiness.READY),
        ("", Readiness.READY),
    ],
)
def test_set_points_of_others_count_in_the_boards_network_only(source: str, readiness: Readiness) -> None:
    bench = Bench("v4")
    bench.run(2.5)
    broken = OTHER[:-1] + b"\0"  # an AIO v4 obeys it all the same
    bench.adapter.receive(bench.time, broken, source)
    assert bench.report.readiness is readiness


def test_a_board_that_does_not_begin_is_given_up() -> None:
    bench = Bench("v4")
    bench.run(2.5)
    bench.set_points_pass = False  # replies come from elsewhere: the board never hears the edge
    bench.ask(steer=True)
    asked = bench.time
    off = pack(STEER_BOARD, Pgn.STEER_REPLY, struct.pack("<hhhBB", 0, 9999, 8888, 7, 0))
    for _ in range(40):
        bench.adapter.receive(bench.time + 0.01, off, HOST)
        bench.tick()
    assert 1 <= bench.ones_after(asked) <= 10
    assert bench.report.readiness is Readiness.NOT_READY
    assert bench.adapter.releases == {"did not begin": 1}


def test_a_motor_that_is_not_ready_is_given_up() -> None:
    bench = Bench("v26")
    bench.board.motor_ready = False  # type: ignore[attr-defined]
    bench.run(2.5)
    bench.ask(steer=True)
    asked = bench.time
    bench.run(3.0)
    assert bench.ones_after(asked + 0.6) == 0
    assert not bench.report.engaged


def test_a_board_that_is_switched_on_is_refused(firmware: str) -> None:
    bench = Bench(firmware)
    bench.run(2.5)
    on = pack(STEER_BOARD, Pgn.STEER_REPLY, struct.pack("<hhhBB", 0, 9999, 8888, 5, 0))
    bench.adapter.receive(bench.time, on, HOST)
    assert bench.report.readiness is Readiness.SWITCHED_ON
    bench.ask(steer=True)
    bench.run(3.0)
    assert bench.ones_after(0.0) == 0


@pytest.mark.parametrize(
    ("angle", "speed"),
    [(math.nan, 1.0), (math.inf, 1.0), (0.1, math.nan), (0.1, 25.2 / 3.6), (0.1, -math.inf), (0.1, 1e300)],
)
def test_what_may_not_be_sent_releases(firmware: str, angle: float, speed: float) -> None:
    """Rule 6: no NaN reaches the wire."""
    bench = Bench(firmware)
    bench.engage()
    bench.ask(steer=True, angle=angle, speed=speed)
    asked = bench.time
    bench.run(1.0)
    assert bench.ones_after(asked) == 0
    assert not bench.board.driving
    bench.ask(steer=False, angle=angle, speed=speed)
    bench.run(3.0)
    bench.ask(steer=True, angle=angle, speed=speed)
    bench.run(1.0)
    assert bench.ones_after(asked) == 0


def test_overspeed_is_refused_before_the_board_does() -> None:
    bench = Bench("v4")
    bench.engage()
    bench.ask(steer=True, speed=25.0 / 3.6)
    bench.run(0.5)
    assert bench.report.engaged
    bench.ask(steer=True, speed=25.01 / 3.6)
    bench.tick()
    assert bench.adapter.releases == {"set point or speed not allowed": 1}


def test_frames_that_release_hold_the_wheel_where_it_is() -> None:
    bench = Bench("v4")
    bench.wheel.angle = 0.2
    bench.run(1.0)
    assert bench.sent[-1][1] == replace(bench.sent[-1][1], steer=False, speed=1.0)
    assert bench.sent[-1][1].angle == pytest.approx(0.2, abs=math.radians(0.05))

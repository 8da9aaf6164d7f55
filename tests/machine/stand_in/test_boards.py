"""What the stand-in boards do beyond the recorded traces: settings, restart, and AiO_26's own rules."""

import math
import struct

import pytest

from drawbar.machine.stand_in.aio_26 import Aio26
from drawbar.machine.stand_in.aio_v4 import AioV4
from drawbar.machine.stand_in.board import Output, StandInBoard
from drawbar.machine.stand_in.wheel import HeldWheel, MotorWheel
from drawbar.protocols.agopengps.board_settings import SteerConfig, SteerSettings
from drawbar.protocols.agopengps.frame import COMPUTER, Frame, Pgn, checksum, pack, parse
from drawbar.protocols.agopengps.network import HELLO, SCAN, decode_scan_reply
from drawbar.protocols.agopengps.steering import SteerCommand, decode_steer_reply

ZERO = SteerCommand(steer=False, angle=0.0, speed=1.0).encode()
ONE = SteerCommand(steer=True, angle=0.1, speed=1.0).encode()


def feed(board: StandInBoard, start: float, datagrams: list[bytes], *, port: int = 9999) -> list[Output]:
    """Send datagrams 0.1 s apart, and return all that came back until 0.1 s after the last."""
    outputs = []
    for place, datagram in enumerate(datagrams):
        outputs += board.receive(start + 0.1 * place, datagram, port)
    return outputs + board.advance(start + 0.1 * len(datagrams))


def reported(outputs: list[Output]) -> float:
    frame = parse(outputs[-1].data)
    assert isinstance(frame, Frame)
    reply = decode_steer_reply(frame)
    assert reply is not None
    return reply.angle


def test_five_bytes_are_taken_for_a_whole_set_point() -> None:
    board = AioV4(HeldWheel())
    feed(board, 0.0, [ZERO, ONE, ONE])
    assert board.driving
    board.receive(0.3, ZERO)
    board.advance(0.33)
    assert not board.driving
    board.receive(0.4, ONE[:5])  # the buffer still holds the zero
    board.advance(0.43)
    assert not board.driving


@pytest.mark.parametrize("counts", [20.0, -45.0])
def test_settings_that_fit_the_sensor_give_the_true_angle(counts: float) -> None:
    board = AioV4(HeldWheel(0.2), sensor_counts=counts, sensor_offset=77)
    memory = SteerSettings(counts_per_degree=abs(int(counts)), offset=-77 if counts > 0.0 else 77).encode()
    outputs = feed(board, 0.0, [memory, SteerConfig(invert_sensor=counts < 0.0).encode(), ZERO, ZERO])
    assert reported(outputs) == pytest.approx(0.2, abs=math.radians(0.06))
    board.restart(1.0)
    assert reported(feed(board, 1.1, [ZERO, ZERO])) == pytest.approx(0.2, abs=math.radians(0.06))


def test_ackermann_scales_angles_to_the_left_only() -> None:
    for angle, expected in ((0.2, 0.1), (-0.2, -0.2)):
        board = AioV4(HeldWheel(angle))
        assert reported(feed(board, 0.0, [SteerSettings(ackermann=50).encode(), ZERO, ZERO])) == pytest.approx(
            expected, abs=math.radians(0.06)
        )


def test_no_counts_per_degree_report_half_a_hundred_degrees() -> None:
    board = AioV4(HeldWheel(0.1))
    impossible = pack(COMPUTER, Pgn.STEER_SETTINGS, bytes((40, 60, 10, 9, 0, 0, 0, 100)))
    assert reported(feed(board, 0.0, [impossible, ZERO, ZERO])) == pytest.approx(math.radians(50.0))


def test_a_new_subnet_restarts_the_board_there() -> None:
    board = AioV4(HeldWheel())
    feed(board, 0.0, [ZERO, ONE, ONE])
    feed(board, 0.3, [pack(COMPUTER, Pgn.SUBNET, bytes((0xC9, 0xC9, 10, 0, 7)))])
    assert not board.driving
    (scan,) = feed(board, 0.5, [SCAN])
    frame = parse(scan.data)
    assert isinstance(frame, Frame)
    reply = decode_scan_reply(frame)
    assert reply is not None
    assert reply.address == "10.0.7.126"
    assert feed(board, 0.6, [ZERO])[0].destination == "10.0.7.255:9999"


def test_a_motor_turned_around_runs_away() -> None:
    board = AioV4(MotorWheel(), start=0.0)
    feed(board, 0.0, [SteerConfig(invert_motor=True).encode(), ZERO] + [ONE] * 20)
    assert board.wheel.angle < -0.05


def test_an_override_leaves_the_motor_on_until_the_next_set_point() -> None:
    board = AioV4(HeldWheel())
    feed(board, 0.0, [ZERO, ONE, ONE])
    board.override()
    board.advance(1.0)
    assert board.driving
    assert board.steer_off
    board.receive(1.0, ONE)
    board.advance(1.03)
    assert not board.driving


def test_a_following_machine_is_told_the_set_point_while_the_board_drives() -> None:
    for board in (AioV4(HeldWheel()), Aio26(HeldWheel())):
        assert board.set_point is None
        feed(board, 0.0, [ZERO, ONE, ONE])
        assert board.set_point == pytest.approx(0.1, abs=1e-4)


class TestAio26:
    @pytest.fixture
    def board(self) -> Aio26:
        return Aio26(HeldWheel())

    def test_reports_unasked_at_100_hz_with_zeros_for_heading_and_roll(self, board: Aio26) -> None:
        outputs = board.advance(1.0)
        assert len(outputs) == 100
        assert all(output.data[7:11] == bytes(4) for output in outputs)

    def test_obeys_port_9999_with_right_checksum_and_length_only(self, board: Aio26) -> None:
        for bad in (ONE[:-1] + b"\0", ONE + b"\0", ONE[:-1]):
            feed(board, board.next_tick, [ZERO, bad, bad])
            assert not board.driving
        feed(board, 2.0, [ZERO, ONE, ONE], port=9998)
        assert not board.driving
        feed(board, 3.0, [ZERO, ONE, ONE])
        assert board.driving

    def test_greetings_need_their_constant(self, board: Aio26) -> None:
        def answers(datagram: bytes) -> list[Output]:
            return [output for output in board.receive(0.001, datagram) if output.data[3] == Pgn.STEER_HELLO_REPLY]

        assert answers(HELLO[:-1] + bytes((checksum(HELLO[:-1]),))) == []
        assert [output.data[5:10] for output in answers(HELLO)] == [bytes(5)]

    def test_does_not_engage_by_its_first_frame(self, board: Aio26) -> None:
        feed(board, 0.0, [ONE] * 10)
        assert not board.driving
        feed(board, 1.0, [ZERO, ONE])
        assert board.driving

    def test_silence_stops_the_motor_after_two_seconds_and_frames_drive_on(self, board: Aio26) -> None:
        feed(board, 0.0, [ZERO, ONE])
        board.advance(2.09)
        assert board.driving
        board.advance(2.12)
        assert not board.driving
        feed(board, 60.0, [ONE])
        assert board.driving

    def test_status_0_disarms_after_a_while_except_with_a_switch(self, board: Aio26) -> None:
        for config, armed in ((SteerConfig(), False), (SteerConfig(steer_switch=True), True)):
            start = board.next_tick
            feed(board, start, [config.encode(), ZERO, ONE, ZERO, ZERO, ZERO, ZERO, ZERO])
            assert not board.driving
            assert board.steer_off is not armed

    def test_kick_out_stops_at_once_until_a_new_edge_or_the_button(self, board: Aio26) -> None:
        feed(board, 0.0, [ZERO, ONE, ONE])
        board.override()
        assert not board.driving
        feed(board, 0.3, [ONE, ONE])
        assert not board.driving
        board.press(pressed=True)
        feed(board, 0.5, [ONE])
        assert board.driving
        board.override()
        feed(board, 0.6, [ZERO, ONE])
        assert board.driving
        board.press(pressed=True)
        feed(board, 0.8, [ONE])
        assert not board.driving

    def test_a_lost_link_stops_the_motor_at_once(self, board: Aio26) -> None:
        feed(board, 0.0, [ZERO, ONE, ONE])
        board.link = False
        assert board.advance(0.31) == []
        assert not board.driving

    def test_a_motor_that_does_not_answer_disarms_after_200_ms(self, board: Aio26) -> None:
        board.motor_ready = False
        feed(board, 0.0, [ZERO, ONE])
        assert not board.steer_off
        feed(board, 0.2, [ONE, ONE])
        assert board.steer_off

    def test_below_its_minimum_speed_it_does_not_begin(self, board: Aio26) -> None:
        feed(board, 0.0, [SteerConfig(minimum_speed=50).encode(), ZERO, ONE, ONE])
        assert board.steer_off

    def test_power_rises_over_half_a_second(self, board: Aio26) -> None:
        feed(board, 0.0, [ZERO, ONE])
        rising = abs(board.pwm)
        feed(board, 0.2, [ONE] * 6)
        assert 0 < rising < abs(board.pwm) == 60

    def test_angles_it_cannot_report_are_bounded(self, board: Aio26) -> None:
        board.wheel.angle = 100.0
        assert struct.unpack("<h", board.advance(0.002)[0].data[5:7]) == (-30000,)


def test_the_motor_wheel_follows_its_equation_and_stops_at_its_ends() -> None:
    wheel = MotorWheel(rate=1.0, lag=0.1, stiction=5, stop=0.5)
    wheel.turn(5, 10.0)
    assert wheel.angle == 0.0
    coarse, fine = MotorWheel(rate=1.0, stop=2.0), MotorWheel(rate=1.0, stop=2.0)
    coarse.turn(255, 0.5)
    for _ in range(100):
        fine.turn(255, 0.005)
    assert coarse.angle == pytest.approx(fine.angle)
    assert coarse.angle == pytest.approx(0.5 - 0.1 * (1.0 - math.exp(-5.0)))
    wheel.turn(255, 10.0)
    assert wheel.angle == 0.5
    wheel.turn(-255, 0.1)
    assert wheel.angle < 0.5

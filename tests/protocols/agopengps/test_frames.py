"""AgOpenGPS frames beyond the golden ones: what is refused, and messages the golden file does not hold."""

import math
import subprocess
import sys
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drawbar.errors import HardwareError
from drawbar.protocols.agopengps import agio, board_settings, imu_board, machine_board, network, steering
from drawbar.protocols.agopengps.frame import COMPUTER, Frame, Refusal, pack, parse

SteerCommand = steering.SteerCommand


@pytest.mark.parametrize(
    "encode",
    [
        SteerCommand(steer=True, angle=math.nan, speed=1.0).encode,
        SteerCommand(steer=True, angle=math.inf, speed=1.0).encode,
        SteerCommand(steer=True, angle=5.8, speed=1.0).encode,
        SteerCommand(steer=True, angle=0.0, speed=math.nan).encode,
        SteerCommand(steer=True, angle=0.0, speed=2000.0).encode,
        SteerCommand(steer=True, angle=0.0, speed=1.0, cross_track=math.nan).encode,
        SteerCommand(steer=True, angle=0.0, speed=1.0, sections=1 << 16).encode,
        board_settings.SteerSettings(counts_per_degree=0).encode,
        board_settings.SteerSettings(ackermann=0).encode,
        board_settings.SteerSettings(offset=40000).encode,
        board_settings.SteerConfig(threshold=-1).encode,
        lambda: machine_board.encode_machine((17,)),
        lambda: machine_board.encode_machine((0,)),
        lambda: machine_board.encode_machine((1,), speed=8.0),
        lambda: machine_board.encode_machine((1,), lift=3),
        lambda: machine_board.encode_machine_pins((22,)),
        lambda: machine_board.encode_machine_pins((0,) * 25),
        lambda: machine_board.encode_machine_config(raise_time=256, lower_time=0, lift=True),
        lambda: machine_board.encode_machine_config(raise_time=1, lower_time=0, lift=True, user=b"12345"),
        lambda: machine_board.encode_section_widths((700.0,)),
        lambda: machine_board.encode_section_widths((1.0,) * 17),
        lambda: machine_board.encode_sections((65,), left_speed=0, right_speed=0),
        lambda: network.encode_subnet(256, 0, 0),
        lambda: network.encode_location(90.1, 0.0),
        lambda: network.encode_location(0.0, math.nan),
        lambda: steering.encode_tool_steer(tool_offset=33.0, steer=True, vehicle_offset=0.0, speed=0.0),
        agio.Position(longitude=181.0, latitude=0.0, fix=4).encode,
        agio.Position(longitude=0.0, latitude=math.nan, fix=4).encode,
        agio.Position(longitude=0.0, latitude=0.0, fix=10).encode,
        agio.Position(longitude=0.0, latitude=0.0, fix=4, imu_yaw=math.nan).encode,
        agio.Position(longitude=0.0, latitude=0.0, fix=4, dual_yaw=math.inf).encode,
        agio.Position(longitude=0.0, latitude=0.0, fix=4, altitude=math.nan).encode,
        agio.Position(longitude=0.0, latitude=0.0, fix=4, hdop=655.35).encode,
    ],
)
def test_what_does_not_fit_the_wire_is_refused_with_its_range(encode: Callable[[], bytes]) -> None:
    with pytest.raises(HardwareError, match=r"allowed|holds"):
        encode()


@pytest.mark.parametrize(
    ("datagram", "refusal"),
    [
        (b"", Refusal.SHORT),
        (b"\x80\x81\x7e\xfd\x00", Refusal.SHORT),
        (b"$GPGGA,1", Refusal.FOREIGN),
        (b"\x80\x81\x7e\xfd\x01\x00", Refusal.LENGTH),
        (b"\x80\x81\x7e\xfd\x00\x7c", Refusal.CHECKSUM),
        (network.HELLO[:-1] + b"\x46", Refusal.CHECKSUM),
        (pack(COMPUTER, 254, bytes(8))[:-1] + b"\x47", Refusal.CHECKSUM),
    ],
)
def test_what_is_no_message_says_why(datagram: bytes, refusal: Refusal) -> None:
    assert parse(datagram) is refusal


@pytest.mark.parametrize("turn", range(-3, 4))
def test_headings_for_agopengps_lie_within_one_turn(turn: int) -> None:
    yaw = math.radians(90.0 - 359.97) + turn * math.tau
    position = agio.Position(longitude=0.0, latitude=0.0, fix=4, imu_yaw=yaw).encode()
    assert int.from_bytes(position[48:50], "little") == 0


def test_what_is_not_measured_is_the_largest_number_of_its_type() -> None:
    position = agio.Position(longitude=0.0, latitude=0.0, fix=1).encode()
    assert position[21:41] == b"\xff\xff\x7f\x7f" * 5
    assert position[41:43] == b"\xff\xff"
    assert position[44:56] == b"\xff\xff" * 3 + b"\xff\x7f" * 3


def test_subnet_and_location_come_back() -> None:
    frame = parse(network.encode_location(-50.9, 179.9))
    assert isinstance(frame, Frame)
    assert network.decode_location(frame) == pytest.approx((-50.9, 179.9), abs=1e-7)


def test_machine_boards_and_switch_boxes_are_read() -> None:
    hello = Frame(0x7B, 123, bytes((0b101, 0x80, 0, 0, 0)))
    assert machine_board.decode_machine_hello(hello) == {1, 3, 16}
    for source in (0x7B, COMPUTER):  # the published firmware takes the computer's source
        assert machine_board.decode_machine_reply(Frame(source, 237, bytes(range(8)))) == bytes(range(4))
    box = machine_board.decode_switch_box(Frame(0x77, 234, bytes(range(8))))
    assert box == machine_board.SwitchBox(main=0, auto=b"\1\2", sections=3, on=b"\4\6", off=b"\5\7")


def test_texts_hold_nothing_that_cannot_be_shown() -> None:
    assert machine_board.decode_text(Frame(0x7E, 221, b"Weld\x1b[2J \xc3\xa9\xff\0")) == "Weld?[2J é\ufffd"


def test_settings_come_back() -> None:
    for settings_, decode in (
        (board_settings.SteerSettings(gain=7, offset=-300), board_settings.decode_steer_settings),
        (
            board_settings.SteerConfig(shaft_encoder=True, danfoss=True, imu_across=True, minimum_speed=11),
            board_settings.decode_steer_config,
        ),
    ):
        frame = parse(settings_.encode())
        assert isinstance(frame, Frame)
        assert decode(frame) == settings_


DECODERS: tuple[Callable[[Frame], object], ...] = (
    steering.decode_steer,
    steering.decode_steer_reply,
    steering.decode_sensor,
    steering.decode_steer_hello,
    board_settings.decode_steer_settings,
    board_settings.decode_steer_config,
    network.decode_scan_reply,
    network.decode_location,
    machine_board.decode_machine_reply,
    machine_board.decode_machine_hello,
    machine_board.decode_switch_box,
    machine_board.decode_text,
    imu_board.decode_imu,
    imu_board.decode_imu_gone,
)


@settings(max_examples=300, deadline=None, derandomize=True)
@given(st.builds(Frame, st.integers(0, 255), st.sampled_from([121, 123, 126, *range(200, 256)]), st.binary()))
def test_no_message_of_any_length_raises(frame: Frame) -> None:
    for decode in DECODERS:
        decode(frame)


def test_the_gate_can_import_them_without_numpy_or_pydantic() -> None:
    modules = "agio, imu_board, machine_board, steer_board"
    heavy = "{'numpy', 'pydantic', 'casadi', 'scipy'}"
    code = (
        f"import sys; from drawbar.protocols.agopengps import {modules}; print({heavy} & sys.modules.keys() or 'none')"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "none"

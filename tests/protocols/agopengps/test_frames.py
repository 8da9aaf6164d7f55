"""AgOpenGPS frames beyond the golden ones: what is refused, and messages the golden file does not hold."""

import math
import subprocess
import sys
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drawbar.errors import HardwareError
from drawbar.protocols.agopengps import board_settings, network, steering
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
    board_settings.decode_steer_settings,
    board_settings.decode_steer_config,
    network.decode_scan_reply,
)


@settings(max_examples=300, deadline=None, derandomize=True)
@given(st.builds(Frame, st.integers(0, 255), st.sampled_from([121, 123, 126, *range(200, 256)]), st.binary()))
def test_no_message_of_any_length_raises(frame: Frame) -> None:
    for decode in DECODERS:
        decode(frame)


def test_the_gate_can_import_them_without_numpy_or_pydantic() -> None:
    heavy = "{'numpy', 'pydantic', 'casadi', 'scipy'}"
    code = f"import sys; import drawbar.protocols.agopengps.steer_board; print({heavy} & sys.modules.keys() or 'none')"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "none"

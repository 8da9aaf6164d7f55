"""The golden AgOpenGPS frames of all messages that drawbar speaks, exact; their names are those of the file."""

import math
from collections.abc import Callable
from dataclasses import replace

import pytest
from golden import load

from drawbar.protocols.agopengps import board_settings, network, steering
from drawbar.protocols.agopengps.frame import Frame, parse

DEGREE = math.radians(1.0)

ENCODED: dict[str, Callable[[], bytes]] = {
    "254 idle": steering.SteerCommand(steer=False, angle=0.0, speed=1.0).encode,
    "254 steer left 0.1 rad, 4 cm left of the line": steering.SteerCommand(
        steer=True, angle=0.1, speed=1.0, cross_track=0.04
    ).encode,
    "254 steer right 0.2 rad, 1 m right of the line": steering.SteerCommand(
        steer=True, angle=-0.2, speed=-2.5, cross_track=-1.0
    ).encode,
    "254 far off": steering.SteerCommand(steer=True, angle=-0.2, speed=1.0, cross_track=7.0).encode,
    "252 settings": board_settings.SteerSettings(offset=-120).encode,
    "251 config": board_settings.SteerConfig(single_ended=True, cytron=True).encode,
    "200 hello as AgIO sends it": lambda: network.HELLO,
    "202 scan as AgIO sends it": lambda: network.SCAN,
}

DECODED: dict[str, tuple[Callable[[Frame], object], object]] = {
    "253 from board": (
        steering.decode_steer_reply,
        steering.SteerReply(angle=-2.0 * DEGREE, steer_off=True, work_off=True, remote=True, pwm=0),
    ),
    "203 scan reply": (
        network.decode_scan_reply,
        network.ScanReply(board=0x7E, address="192.168.5.126", subnet="192.168.5"),
    ),
}


NOT_SPOKEN = frozenset((201, 214, 229, 233, 235, 236, 238, 239, 211, 212, 250, 126))
"""neither sent nor read, but by stand-ins: AgIO's, those of machine, tool and IMU boards, two of a steer board's"""


@pytest.fixture(scope="module")
def frames() -> dict[str, bytes]:
    return {each["name"]: bytes.fromhex(each["hex"]) for each in load("aog_frames.json")["frames"]}


def test_every_golden_frame_is_looked_at(frames: dict[str, bytes]) -> None:
    spoken = {name for name, frame in frames.items() if frame[3] not in NOT_SPOKEN}
    assert spoken == ENCODED.keys() | DECODED.keys()


@pytest.mark.parametrize("name", ENCODED)
def test_encodes_byte_for_byte(frames: dict[str, bytes], name: str) -> None:
    assert ENCODED[name]().hex() == frames[name].hex()


@pytest.mark.parametrize("name", DECODED)
def test_decodes_to_what_it_means(frames: dict[str, bytes], name: str) -> None:
    decode, expected = DECODED[name]
    frame = parse(frames[name])
    assert isinstance(frame, Frame)
    assert decode(frame) == _about(expected)


def _about(expected: object) -> object:
    return _Near(expected) if hasattr(expected, "__dataclass_fields__") else expected


class _Near:
    """Equal to a dataclass of the same values, numbers within rounding."""

    def __init__(self, expected: object) -> None:
        self.expected = expected

    def __eq__(self, other: object) -> bool:
        names = list(self.expected.__dataclass_fields__)  # type: ignore[attr-defined]
        return all(
            getattr(other, name) == pytest.approx(getattr(self.expected, name), abs=1e-12)
            if isinstance(getattr(self.expected, name), float)
            else getattr(other, name) == getattr(self.expected, name)
            for name in names
        )

    __hash__ = None  # type: ignore[assignment]


@pytest.mark.parametrize("name", [name for name in ENCODED if name.startswith("254")])
def test_set_points_are_read_back(frames: dict[str, bytes], name: str) -> None:
    frame = parse(frames[name])
    assert isinstance(frame, Frame)
    read = steering.decode_steer(frame)
    assert read is not None
    assert replace(read[0], sections=0).encode() == frames[name]

"""Node, heartbeat, curvature, the tractor's messages, speed command, facilities, cadence."""

import math
import subprocess
import sys
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drawbar.errors import ConfigurationError
from drawbar.protocols.isobus.address import CLAIM, AddressClaim
from drawbar.protocols.isobus.cadence import Cadence
from drawbar.protocols.isobus.curvature import CurvatureMap, TableCurvature, WheelbaseCurvature
from drawbar.protocols.isobus.heartbeat import HEARTBEAT, REPETITION_RATE, Heartbeat
from drawbar.protocols.isobus.identifier import Message, decode, encode
from drawbar.protocols.isobus.name import Name
from drawbar.protocols.isobus.node import IsobusNode
from drawbar.protocols.isobus.speed_command import SpeedCommand
from drawbar.protocols.isobus.tractor import Tractor
from drawbar.protocols.isobus.tractor_messages import (
    GROUND_SPEED,
    REAR_HITCH,
    REAR_PTO,
    SELECTED_SPEED,
    WHEEL_SPEED,
    Hitch,
    PowerTakeOff,
    SelectedSpeed,
    WheelOrGroundSpeed,
    decode_speed_command,
    encode_selected_speed,
    encode_speed,
)
from drawbar.transports.base import CanFrame

NAME = Name(identity=100, manufacturer=1407, function=29)
TABLE = TableCurvature([(-0.35, -0.2), (-0.1, -0.09), (0.0, 0.01), (0.3, 0.2)])


def held_node() -> IsobusNode:
    node = IsobusNode(AddressClaim(NAME, 0x90))
    for tick in range(80):
        node.send(tick * 0.01)
    assert node.claim.held
    return node


@given(angle=st.floats(-1.5, 1.5))
@settings(derandomize=True, deadline=None)
def test_wheelbase_curvature_has_an_exact_inverse(angle: float) -> None:
    front = WheelbaseCurvature(1.4)
    assert front.angle(front.curvature(angle)) == pytest.approx(angle, abs=1e-12)


@given(angle=st.floats(-0.35, 0.3))
@settings(derandomize=True, deadline=None)
def test_table_has_an_exact_inverse(angle: float) -> None:
    assert TABLE.angle(TABLE.curvature(angle)) == pytest.approx(angle, abs=1e-12)


@pytest.mark.parametrize(
    ("axle", "angle", "curvature"),
    [
        (WheelbaseCurvature(1.4), math.radians(30.0), 0.412),
        (WheelbaseCurvature(1.4), -0.1, -0.0717),
        (TABLE, -0.35, -0.2),
        (TABLE, 0.3, 0.2),
        (TABLE, 0.15, 0.105),
    ],
)
def test_curvature_of_an_angle(axle: CurvatureMap, angle: float, curvature: float) -> None:
    assert axle.curvature(angle) == pytest.approx(curvature, abs=5e-4)


@pytest.mark.parametrize("angle", [0.31, -0.36, math.nan, math.inf])
def test_a_table_knows_nothing_beyond_its_ends(angle: float) -> None:
    assert math.isnan(TABLE.curvature(angle))
    assert math.isnan(TABLE.angle(angle))
    assert math.isnan(WheelbaseCurvature(1.4).curvature(10.0 * angle))


@pytest.mark.parametrize(
    ("pairs", "text"),
    [
        ([(0.0, 0.0)], "fewer than two pairs"),
        ([(0.0, 0.0), (0.1, -0.1)], "must both rise"),
        ([(0.1, 0.0), (0.0, 0.1)], "must both rise"),
        ([(0.0, 0.0), (0.1, 0.0)], "must both rise"),
        ([(0.0, 0.0), (0.1, math.nan)], "finite"),
    ],
)
def test_a_table_that_has_no_inverse_is_refused(pairs: list[tuple[float, float]], text: str) -> None:
    with pytest.raises(ConfigurationError, match=text):
        TableCurvature(pairs)


@pytest.mark.parametrize("wheelbase", [0.0, -1.0, math.nan, math.inf])
def test_a_wheelbase_that_is_no_length_is_refused(wheelbase: float) -> None:
    with pytest.raises(ConfigurationError, match="wheelbase"):
        WheelbaseCurvature(wheelbase)


def test_cadence_keeps_its_mean_rate_and_catches_nothing_up() -> None:
    cadence = Cadence(0.1)
    times = [tick * 0.03 for tick in range(1000) if cadence.due(tick * 0.03)]
    assert len(times) == pytest.approx(300, abs=2)
    late = [time for time in (50.0, 50.01, 50.02, 50.09, 50.1, 50.11) if cadence.due(time)]
    assert late == [50.0, 50.1]


def test_heartbeat_begins_when_asked_and_counts_round() -> None:
    node = held_node()
    Heartbeat(node)
    assert node.send(1.0) == []
    node.receive(1.0, asked(REPETITION_RATE, HEARTBEAT.to_bytes(3, "little") + b"\x64\x00\xff\xff\xff"))
    frames = [frame for tick in range(26000) for frame in node.send(1.0 + tick * 0.01)]
    assert {frame.identifier for frame in frames} == {0x0CF0E490}
    counts = [frame.data[0] for frame in frames]
    assert len(counts) == 2600
    assert counts[:3] == [251, 0, 1]
    assert counts[251:254] == [250, 0, 1]


def test_tractor_keeps_each_reading_with_its_time() -> None:
    tractor = Tractor()
    wheel = encode_speed(WheelOrGroundSpeed(speed=-1.5, distance=3.0))
    selected = encode_selected_speed(SelectedSpeed(speed=1.4, source=0, limit=0, exit_reason=0))
    tractor.receive_message(1.0, Message(pgn=WHEEL_SPEED, source=0x80, data=wheel))
    tractor.receive_message(1.1, Message(pgn=SELECTED_SPEED, source=0x80, data=selected))
    assert (tractor.speed("wheel speed").speed, tractor.speed("wheel speed").time) == (-1.5, 1.0)
    assert tractor.speed("selected speed").speed == pytest.approx(1.4)
    assert tractor.speed("selected speed").time == 1.1
    assert math.isnan(tractor.speed("ground speed").speed)
    assert tractor.speed("ground speed").time == -math.inf


def test_a_facility_is_lost_without_its_message_and_comes_back_with_it() -> None:
    tractor = Tractor()
    data = encode_speed(WheelOrGroundSpeed(speed=1.0, distance=0.0))
    assert tractor.reading("ground speed", 0.0) is None
    for time, lost in ((0.2, 0.6), (1.0, 1.4)):
        tractor.receive_message(time, Message(pgn=GROUND_SPEED, source=0x80, data=data))
        assert tractor.reading("ground speed", time + 0.2) is not None
        assert tractor.reading("wheel speed", time + 0.2) is None
        assert tractor.reading("ground speed", lost) is None


def test_a_second_sender_is_believed_only_after_the_first_is_silent() -> None:
    tractor = Tractor()
    for time, source, speed in ((0.0, 0x80, 1.0), (0.1, 0x81, 9.0), (0.5, 0x81, 2.0)):
        data = encode_speed(WheelOrGroundSpeed(speed=speed, distance=0.0))
        tractor.receive_message(time, Message(pgn=WHEEL_SPEED, source=source, data=data))
        assert tractor.speed("wheel speed").speed == (1.0 if time < 0.3 else 2.0)
    assert tractor.dropped == {"second sender": 1}


def test_hitch_and_power_take_off() -> None:
    tractor = Tractor()
    tractor.receive_message(0.0, Message(pgn=REAR_HITCH, source=0, data=bytes([125, 0b01000000, *[255] * 6])))
    tractor.receive_message(0.0, Message(pgn=REAR_PTO, source=0, data=bytes([0xE0, 0x10, 0xFF, 0xFF, *[255] * 4])))
    assert tractor.reading("rear hitch", 0.0) == Hitch(position=0.5, in_work=True, limit=0)
    shaft = tractor.reading("rear PTO", 0.0)
    assert isinstance(shaft, PowerTakeOff)
    assert shaft.speed == pytest.approx(540.0 * 2.0 * math.pi / 60.0)
    assert math.isnan(shaft.set_point)


def test_speed_command_waits_for_none_and_says_none_at_once() -> None:
    node = held_node()
    command = SpeedCommand(node, 3.0)
    time, said = 1.0, []
    for speed, ticks in ((1.0, 20), (None, 20), (1.0, 20), (-0.5, 6), (None, 1)):
        for _ in range(ticks):
            said += [(time, decode_speed_command(frame.data)) for frame in command.send(time, speed)]
            time += 0.02
    assert [None if math.isnan(point) else point for _, (point, _) in said] == [
        *[None] * 8,
        *[1.0] * 4,
        *[-0.5] * 2,
        None,
    ]
    assert all(after - before <= 0.11 for (before, _), (after, _) in pairwise(said))
    assert {limit for _, (_, limit) in said} == {3.0}


@pytest.mark.parametrize("fault", ["range", "address", "duplicate", "not finite"])
def test_speed_command_is_latched_after_a_fault(fault: str) -> None:
    node = held_node()
    command = SpeedCommand(node, 3.0)
    command.send(1.0, None)
    assert _points(command.send(1.1, 1.0)) == [1.0]
    if fault in ("range", "not finite"):
        assert _points(command.send(1.12, 3.1 if fault == "range" else math.nan)) == [None]
        assert command.dropped == {"set point out of range": 1}
    else:
        pgn, data = (CLAIM, Name(identity=1, manufacturer=0, function=0).data) if fault == "address" else (1, b"")
        node.receive(1.12, encode(Message(pgn=pgn, source=0x90, data=data)))
        assert _points(command.send(1.12, 1.0)) == ([] if fault == "address" else [None])
    for tick in range(300):
        node.send(1.14 + 0.02 * tick)
        assert set(_points(command.send(1.14 + 0.02 * tick, 1.0))) <= {None}
    assert _points(command.send(9.0, None)) == [None]
    assert _points(command.send(9.1, 1.0)) == [1.0]


@pytest.mark.parametrize("ticks", range(10, 18))
def test_the_first_speed_command_from_a_new_address_is_none(ticks: int) -> None:
    node = held_node()
    command = SpeedCommand(node, 3.0)
    command.send(1.0, None)
    stronger = Name(identity=1, manufacturer=0, function=0).data
    node.receive(1.02, encode(Message(pgn=CLAIM, source=0x90, data=stronger)))
    points: list[float | None] = []
    for tick in range(40):
        node.send(1.02 + 0.02 * tick)
        points += _points(command.send(1.02 + 0.02 * tick, None if tick < ticks else 1.0))
    assert points[0] is None


@pytest.mark.parametrize("limit", [0.0, -1.0, 65.0, math.nan])
def test_speed_limit_that_cannot_be_is_refused(limit: float) -> None:
    with pytest.raises(ConfigurationError, match="speed limit"):
        SpeedCommand(held_node(), limit)


@given(pgn=st.sampled_from([WHEEL_SPEED, GROUND_SPEED, SELECTED_SPEED, REAR_HITCH, REAR_PTO]), data=st.binary())
@settings(derandomize=True, deadline=None, max_examples=200)
def test_no_tractor_message_raises(pgn: int, data: bytes) -> None:
    tractor = Tractor()
    tractor.receive_message(0.0, Message(pgn=pgn, source=0, data=data))
    assert bool(tractor.dropped["length"]) == (len(data) != 8)


def _points(frames: list[CanFrame]) -> list[float | None]:
    points = []
    for frame in frames:
        message = decode(frame)
        assert message is not None
        point, _ = decode_speed_command(message.data) or (math.nan, math.nan)
        points.append(None if math.isnan(point) else point)
    return points


def asked(pgn: int, data: bytes) -> CanFrame:
    return encode(Message(pgn=pgn, source=0x20, destination=0x90, data=data))


@pytest.mark.parametrize("module", ["protocols.isobus.guidance", "protocols.nmea2000.gnss", "machine.hardware.isobus"])
def test_the_gate_can_load_it_without_numpy_and_python_can(module: str) -> None:
    code = f"import sys, drawbar.{module}; sys.exit(bool({{'numpy', 'can', 'casadi'}} & sys.modules.keys()))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0

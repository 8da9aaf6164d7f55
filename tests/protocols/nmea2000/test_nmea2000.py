"""NMEA 2000: golden frames, fast packets that come spoilt or out of order, epochs joined by their identifier."""

import math
import struct
from collections.abc import Iterable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drawbar.protocols.isobus.identifier import decode
from drawbar.protocols.nmea2000.gnss import Nmea2000Epoch, Nmea2000Receiver
from drawbar.protocols.nmea2000.messages import (
    FixMethod,
    GnssPosition,
    decode_gnss_position,
    decode_heading,
    decode_motion,
)
from drawbar.transports.base import CanFrame

RAPID = CanFrame(0x09F8011C, bytes.fromhex("d431531e207acd02"))
MOTION = CanFrame(0x09F8021C, bytes.fromhex("07fc9b3b6400ffff"))
POSITION = [
    CanFrame(0x0DF8051C, bytes.fromhex(data))
    for data in (
        "602f072b51f01903",
        "61168060c38a7582",
        "620f0740879600f7",
        "630ca700b0b88502",
        "640000000043fd11",
        "6546008200da1100",
        "660001b0077800ff",
    )
]
HEADING = CanFrame(0x09F1121C, bytes.fromhex("072b54ff7fff7ffc"))
TURN = CanFrame(0x09F1131C, bytes.fromhex("077a592600ffffff"))
ATTITUDE = CanFrame(0x0DF1191C, bytes.fromhex("072b5426ffb401ff"))
REST = [MOTION, HEADING, TURN, ATTITUDE]
"""golden frames, decoded by nmea2000 2026.10.3"""


def epochs(frames: Iterable[CanFrame], receiver: Nmea2000Receiver | None = None) -> list[Nmea2000Epoch]:
    """Return the epochs of frames that come 1 ms apart, all that was waited for included."""
    receiver = receiver or Nmea2000Receiver()
    time = 0.0
    for time, frame in enumerate(frames):
        receiver.receive(1.0 + 1e-3 * time, frame)
    return receiver.epochs(1.1 + 1e-3 * time)


def joined(data: bytes, sid: int) -> CanFrame:
    return CanFrame(MOTION.identifier, bytes([sid]) + data[1:])


def packet(payload: bytes, sequence: int = 0) -> list[CanFrame]:
    """Return the frames of a fast packet of 129029."""
    padded = bytes([len(payload)]) + payload
    pieces = [padded[at : at + 7].ljust(7, b"\xff") for at in range(0, len(padded), 7)]
    return [CanFrame(0x0DF8051C, bytes([sequence << 5 | k]) + piece) for k, piece in enumerate(pieces)]


def payload(sid: int) -> bytes:
    whole = b"".join(frame.data[1:] for frame in POSITION)[1:48]
    return bytes([sid]) + whole[1:]


def check(position: GnssPosition) -> None:
    assert position.sid == 7
    assert position.utc == pytest.approx(1795342530.2, abs=1e-5)
    assert position.latitude == pytest.approx(50.87687242669999, abs=1e-12)
    assert position.longitude == pytest.approx(4.7020576117, abs=1e-12)
    assert position.altitude == pytest.approx(42.318)
    assert position.geoid_separation == pytest.approx(45.7)
    assert (position.method, position.integrity, position.satellites) == (FixMethod.RTK_FIXED, 1, 17)
    assert (position.hdop, position.pdop) == (pytest.approx(0.7), pytest.approx(1.3))
    assert (position.station, position.correction_age) == (123, pytest.approx(1.2))


def test_golden_messages_of_an_instant_are_one_epoch() -> None:
    receiver = Nmea2000Receiver()
    (epoch,) = epochs([RAPID, *POSITION, *REST], receiver)
    check(epoch.position)
    assert epoch.motion is not None
    assert epoch.heading is not None
    assert epoch.turn is not None
    assert epoch.attitude is not None
    assert epoch.time == pytest.approx(1.001)
    assert epoch.motion.course == pytest.approx(math.pi / 2 - 1.5259)
    assert epoch.motion.speed == pytest.approx(1.0)
    assert epoch.heading.yaw == pytest.approx(math.pi / 2 - 2.1547)
    assert epoch.turn.yaw_rate == pytest.approx(-0.0785398125)
    assert epoch.attitude.pitch == pytest.approx(-0.0218)
    assert epoch.attitude.roll == pytest.approx(0.0436)
    assert receiver.rapid is not None
    assert receiver.rapid[1].latitude == pytest.approx(50.8768724, abs=1e-9)
    assert receiver.rapid[1].longitude == pytest.approx(4.7020576, abs=1e-9)
    assert receiver.drops() == {}


def test_the_same_as_the_nmea2000_package_decodes() -> None:
    can = pytest.importorskip("can", reason="python-can is not installed: pip install 'drawbar[machine]'")
    package = pytest.importorskip("nmea2000.decoder", reason="nmea2000 is not installed: pip install nmea2000")
    decoder = package.NMEA2000Decoder()
    messages = []
    for frame in [*POSITION, *REST]:
        message = can.Message(arbitration_id=frame.identifier, data=frame.data, is_extended_id=True)
        messages.append(decoder.decode(message))
    values = {field.id: field.raw_value for message in messages if message is not None for field in message.fields}
    (epoch,) = epochs([*POSITION, *REST])
    assert epoch.position.latitude == pytest.approx(values["latitude"], abs=1e-12)
    assert epoch.position.utc % 86400.0 == pytest.approx(values["time"], abs=1e-5)
    assert math.pi / 2 - epoch.heading.yaw == pytest.approx(values["heading"])
    assert -epoch.turn.yaw_rate == pytest.approx(values["rate"])
    assert epoch.attitude.roll == pytest.approx(values["roll"])
    assert epoch.motion.speed == pytest.approx(values["sog"])


@given(order=st.permutations(POSITION))
@settings(derandomize=True, deadline=None)
def test_frames_out_of_order_are_joined(order: list[CanFrame]) -> None:
    assert epochs(order)[0].position == epochs(POSITION)[0].position


@pytest.mark.parametrize("missing", range(7))
def test_a_missing_frame_drops_its_message_and_no_other(missing: int) -> None:
    receiver = Nmea2000Receiver()
    assert epochs([frame for k, frame in enumerate(POSITION) if k != missing], receiver) == []
    later = packet(payload(8), sequence=4)
    for k, frame in enumerate(later):
        receiver.receive(1.5 + 1e-3 * k, frame)
    (epoch,) = receiver.epochs(2.0)
    assert epoch.position.sid == 8
    assert receiver.drops() == {"fast packet: unfinished": 1}


@pytest.mark.parametrize("missing", range(7))
def test_a_missing_frame_costs_one_message_where_the_sequence_number_stands_still(missing: int) -> None:
    receiver = Nmea2000Receiver()
    for sid in range(5):
        said = bytearray(payload(sid))
        said[33] = sid  # satellites, which are in another frame
        for k, frame in enumerate(packet(bytes(said))):
            if (sid, k) != (1, missing):
                receiver.receive(1.0 + 0.1 * sid + 1e-3 * k, frame)
    positions = [epoch.position for epoch in receiver.epochs(2.0)]
    assert [(position.sid, position.satellites) for position in positions] == [(0, 0), (2, 2), (3, 3), (4, 4)]


def test_a_new_message_of_the_same_sequence_number_replaces_one_that_lacks_a_frame() -> None:
    (epoch,) = epochs([*packet(payload(1))[:6], *packet(payload(2))])
    assert epoch.position.sid == 2


def test_a_frame_of_another_number_does_not_fill_a_gap() -> None:
    wrong = CanFrame(0x0DF8051C, bytes([0x60 | 9]) + bytes(7))
    assert epochs([*POSITION[:3], *POSITION[4:], wrong]) == []


def test_two_different_frames_of_one_number_spoil_the_message() -> None:
    receiver = Nmea2000Receiver()
    other = CanFrame(0x0DF8051C, POSITION[2].data[:1] + bytes(7))
    assert epochs([*POSITION[:3], other, *POSITION[3:]], receiver) == []
    assert receiver.drops()["fast packet: two frames of one number"] == 1


def test_a_frame_that_comes_twice_does_no_harm() -> None:
    assert len(epochs([frame for frame in POSITION for _ in range(2)][:-1])) == 1


def test_messages_join_by_their_identifier_only() -> None:
    (epoch,) = epochs([joined(MOTION.data, 6), *POSITION, joined(HEADING.data, 8)])
    assert (epoch.motion, epoch.heading) == (None, None)


def test_an_epoch_ends_as_soon_as_all_is_there_that_usually_is() -> None:
    receiver = Nmea2000Receiver()
    epochs([*POSITION, *REST], receiver)
    rest = [CanFrame(frame.identifier, b"\x08" + frame.data[1:]) for frame in REST]
    for frame in [*packet(payload(8)), *rest[:-1]]:
        receiver.receive(2.0, frame)
    assert receiver.epochs(2.001) == []
    receiver.receive(2.002, rest[-1])
    (epoch,) = receiver.epochs(2.002)
    assert epoch.attitude is not None


def test_an_epoch_does_not_wait_for_what_is_lost() -> None:
    receiver = Nmea2000Receiver()
    epochs([*POSITION, *REST], receiver)
    for frame in packet(payload(8)):
        receiver.receive(2.0, frame)
    assert receiver.epochs(2.02) == []
    (epoch,) = receiver.epochs(2.031)
    assert epoch.heading is None


def test_what_comes_late_is_counted_and_waited_for_next_time() -> None:
    receiver = Nmea2000Receiver()
    speeds = []
    for sid in (7, 8):
        for frame in packet(payload(sid)):
            receiver.receive(float(sid), frame)
        # The first epoch waits for anything, but not for ever; the second for what the first missed.
        pause = 0.04 if sid == 7 else 0.01
        early = receiver.epochs(sid + pause)
        receiver.receive(sid + pause, joined(MOTION.data, sid))
        (epoch,) = early + receiver.epochs(sid + pause)
        speeds.append(epoch.motion.speed if epoch.motion else None)
    assert speeds == [None, 1.0]
    assert receiver.drops() == {"late": 1}


def test_no_identifier_joins_nothing() -> None:
    receiver = Nmea2000Receiver()
    (epoch,) = epochs([joined(MOTION.data, 0xFF), *packet(payload(0xFF)), joined(MOTION.data, 0xFF)], receiver)
    assert epoch.position.sid is None
    assert epoch.motion is None


def test_a_second_receiver_is_left_out_until_the_first_is_silent() -> None:
    receiver = Nmea2000Receiver()
    second = [CanFrame(frame.identifier & ~0xFF | 0x1D, frame.data) for frame in packet(payload(9), 1)]
    assert len(epochs([*POSITION, *second], receiver)) == 1
    assert receiver.drops() == {"other receiver": 7}
    for frame in second:
        receiver.receive(5.0, frame)
    assert [epoch.position.sid for epoch in receiver.epochs(6.0)] == [9]


def test_a_receiver_that_is_chosen_is_heard_alone() -> None:
    assert epochs(POSITION, Nmea2000Receiver(source=0x1D)) == []
    assert len(epochs(POSITION, Nmea2000Receiver(source=0x1C))) == 1


def test_what_is_not_available_is_nan() -> None:
    position = decode_gnss_position(b"\xff\xff\xff" + b"\xff" * 4 + (b"\xff" * 7 + b"\x7f") * 3 + b"\xff" * 12)
    assert position is not None
    assert (position.sid, position.satellites, position.station) == (None, None, None)
    values = (position.utc, position.latitude, position.longitude, position.altitude, position.correction_age)
    assert all(map(math.isnan, values))
    motion = decode_motion(b"\x07\xfc" + b"\xff" * 6)
    assert motion is not None
    assert math.isnan(motion.course)
    assert math.isnan(motion.speed)


def test_directions_to_magnetic_north_are_left_out() -> None:
    motion, heading = decode_motion(b"\x07\xfd" + MOTION.data[2:]), decode_heading(HEADING.data[:7] + b"\xfd")
    assert motion is not None
    assert heading is not None
    assert math.isnan(motion.course)
    assert math.isnan(heading.yaw)


def test_a_position_off_the_earth_is_nan() -> None:
    far = bytearray(payload(7))
    far[7:15] = struct.pack("<q", round(91.0e16) if 91.0e16 < 2**63 else 2**62)
    position = decode_gnss_position(bytes(far))
    assert position is not None
    assert math.isnan(position.latitude)


def test_epochs_nobody_asks_for_do_not_grow_for_ever() -> None:
    receiver = Nmea2000Receiver()
    for number in range(300):
        for frame in packet(payload(number % 250), number % 8):
            receiver.receive(0.1 * number, frame)
    assert len(receiver.epochs(31.0)) <= 65
    assert receiver.drops()["epochs not asked for"] >= 300 - 65


@given(
    frames=st.lists(
        st.tuples(
            st.sampled_from([129025, 129026, 129029, 127250, 127251, 127257, 130306]),
            st.binary(max_size=9) | st.binary(min_size=8, max_size=8),
            st.floats(0.0, 0.4),
        ),
        max_size=80,
    )
)
@settings(derandomize=True, deadline=None, max_examples=200)
def test_no_frame_raises(frames: list[tuple[int, bytes, float]]) -> None:
    receiver, time = Nmea2000Receiver(source=0x1C), 0.0
    for pgn, data, pause in frames:
        time += pause
        receiver.receive(time, CanFrame(0x08000000 | pgn << 8 | 0x1C, data))
        receiver.epochs(time)
    oversized = sum(len(data) > 8 for _, data, _ in frames)
    assert receiver.dropped["not NMEA 2000"] == oversized


def test_frames_that_are_none_are_counted() -> None:
    receiver = Nmea2000Receiver()
    receiver.receive(0.0, CanFrame(-1, b""))
    assert receiver.drops() == {"not NMEA 2000": 1}
    assert decode(CanFrame(0x0DF8051C, b"")) is not None

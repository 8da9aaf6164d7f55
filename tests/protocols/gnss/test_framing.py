"""Framing: every intact frame comes out whatever stands around it, and everything else is counted."""

import random
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from receiver_frames import nmea, ubx

from drawbar.protocols.crc24q import crc24q
from drawbar.protocols.gnss.checksums import crc_ccitt
from drawbar.protocols.gnss.framing import LONGEST_NMEA, LONGEST_SBF, LONGEST_UBX, Frame, Framer, Protocol

GGA = nmea.sentence("GNGGA,101530.20,5052.6123456,N,00442.1234567,E,4,17,0.70,42.318,M,45.700,M,1.2,0123")


def rtcm(payload: bytes) -> bytes:
    body = b"\xd3" + len(payload).to_bytes(2, "big") + payload
    return body + crc24q(body).to_bytes(3, "big")


def block(body: bytes) -> bytes:
    tail = (4007).to_bytes(2, "little") + (8 + len(body)).to_bytes(2, "little") + body
    return b"$@" + crc_ccitt(tail).to_bytes(2, "little") + tail


text = st.text(
    [chr(code) for code in range(0x20, 0x7F) if chr(code) not in "$*"], min_size=1, max_size=LONGEST_NMEA - 4
)
frames = st.one_of(
    text.map(lambda body: nmea.sentence("G" + body).rstrip(b"\r\n")),
    st.builds(ubx.frame, st.integers(0, 255), st.integers(0, 255), st.binary(max_size=120)),
    st.integers(2, 30).flatmap(lambda words: st.binary(min_size=4 * words, max_size=4 * words)).map(block),
    st.binary(max_size=120).map(rtcm),
)
dull = st.binary(max_size=60).map(lambda noise: bytes(byte for byte in noise if byte not in b"$\xb5\xd3"))
usual = settings(max_examples=300, deadline=None, derandomize=True)


def pushed(framer: Framer, data: bytes, cuts: list[int]) -> list[Frame]:
    """Push data in pieces, each a second later than the one before, and end with a silence."""
    edges = [0, *sorted(cut % (len(data) + 1) for cut in cuts), len(data)]
    pieces = [data[start:end] for start, end in pairwise(edges)]
    found = [frame for time, piece in enumerate(pieces) for frame in framer.push(piece, float(time))]
    return found + framer.settle()


def accounted(framer: Framer, found: list[Frame]) -> int:
    """Return how many bytes are in frames or counted."""
    return sum(len(frame.data) for frame in found) + framer.dropped.total()


@usual
@given(st.lists(st.tuples(dull, frames), max_size=8), dull, st.lists(st.integers(0, 2000), max_size=8))
def test_every_intact_frame_comes_out_of_noise_however_it_is_cut(
    parts: list[tuple[bytes, bytes]], end: bytes, cuts: list[int]
) -> None:
    framer = Framer()
    data = b"".join(noise + frame for noise, frame in parts) + end
    found = pushed(framer, data, cuts)
    assert [frame.data for frame in found] == [frame for _, frame in parts]
    assert accounted(framer, found) == len(data) - sum(
        noise.count(b"\r") + noise.count(b"\n") for noise, _ in parts
    ) - (end.count(b"\r") + end.count(b"\n"))
    assert not framer.is_waiting


@usual
@given(st.lists(st.tuples(st.binary(max_size=60), frames), max_size=8), st.lists(st.integers(0, 2000), max_size=8))
def test_noise_that_looks_like_frames_hides_none(parts: list[tuple[bytes, bytes]], cuts: list[int]) -> None:
    found = pushed(Framer(), b"".join(noise + frame for noise, frame in parts), cuts)
    rest = iter([frame.data for frame in found])
    assert all(frame in rest for _, frame in parts)  # in their order


@usual
@given(frames, st.integers(0, 10**6), st.integers(0, 7))
def test_a_flipped_bit_costs_its_frame_alone(frame: bytes, place: int, bit: int) -> None:
    flipped = bytearray(frame)
    flipped[place % len(frame)] ^= 1 << bit
    found = [each.data for each in pushed(Framer(), GGA + bytes(flipped) + GGA, [])]
    assert found.count(GGA.rstrip()) == 2
    others = [each for each in found if each != GGA.rstrip()]
    assert all(each.upper() == frame.upper() for each in others)  # the case of a checksum's digit


@usual
@given(frames, frames, st.integers(0, 10**6))
def test_a_frame_that_was_cut_off_costs_itself_alone(first: bytes, second: bytes, place: int) -> None:
    cut = first[: place % len(first)]
    assert second in [frame.data for frame in pushed(Framer(), cut + second, [])]


@pytest.mark.parametrize(
    "header",
    [
        b"\xb5\x62\x01\x07\xff\xff",
        b"\xb5\x62\x01\x07\x00\x04",
        b"\xb5\x62\x01\x07\xf0\x03",
        b"$@\x12\x34\xa7\x4f\xfc\xff",
        b"$@\x12\x34\xa7\x4f\x00\x08",
        b"$@\x12\x34\xa7\x4f\x61\x00",
        b"\xd3\x03\xff",
        b"$" + b"G" * 150,
        b"$" + b"G" * 500,
        b"$",
        b"\xb5",
        b"\xd3",
    ],
)
def test_a_wrong_length_loses_no_sentence(header: bytes) -> None:
    framer = Framer()
    found = pushed(framer, GGA + header + 20 * GGA, [])
    assert [frame.data for frame in found] == 21 * [GGA.rstrip()]
    assert framer.dropped.total() == len(header)


def test_frames_behind_a_false_header_come_with_the_bytes_that_disprove_it() -> None:
    framer = Framer()
    assert framer.push(b"\xb5\x62\x01\x07\xe8\x03", 0.0) + framer.push(GGA, 1.0) == []
    assert framer.is_waiting
    found = framer.push(12 * GGA, 2.0)  # the header promised 1000 bytes
    assert [frame.time for frame in found] == [1.0] + 12 * [2.0]
    assert framer.dropped == {"UBX checksum": 1, "noise bytes": 5}


def test_frames_come_out_with_their_last_byte_and_carry_the_time_of_their_first() -> None:
    framer, data = Framer(), GGA.rstrip()
    for time, byte in enumerate(data[:-1]):
        assert framer.push(bytes([byte]), float(time)) == []
    assert framer.push(data[-1:], 500.0) == [Frame(protocol=Protocol.NMEA, data=data, time=0.0)]
    (second,) = framer.push(b"\r\n" + GGA, 501.0)
    assert second.time == 501.0
    assert framer.dropped == {}


@pytest.mark.parametrize(
    ("data", "counts"),
    [
        (b"$GPGGA,1*00\r\n", {"NMEA checksum": 1, "noise bytes": 10}),
        (b"$GPGGA,1*G0\r\n", {"NMEA checksum": 1, "noise bytes": 10}),
        (b"$GPGGA,1\r\n", {"NMEA without checksum": 1, "noise bytes": 7}),
        (b"$GPG\x00\r\n", {"NMEA character": 1, "noise bytes": 4}),
        (b"$" + b"A" * 300, {"NMEA length": 1, "noise bytes": 300}),
        (b"\xb5\x62\x01\x07\x00\x00\x00\x00", {"UBX checksum": 1, "noise bytes": 7}),
        (b"\xb5\x62\x01\x07\xf9\x03", {"UBX length": 1, "noise bytes": 5}),
        (b"$@" + b"\x00" * 4 + b"\x10\x00" + b"\x00" * 8, {"SBF checksum": 1, "noise bytes": 15}),
        (b"$@" + b"\x00" * 4 + b"\x0c\x00", {"SBF length": 1, "noise bytes": 7}),
        (b"$@" + b"\x00" * 4 + b"\x61\x00", {"SBF length": 1, "noise bytes": 7}),
        (b"\xd3\x00\x00\x00\x00\x00", {"RTCM checksum": 1, "noise bytes": 5}),
        (b"\xd3\x04\x00\r\n", {"noise bytes": 3}),
        (b"$GPGGA,1", {"incomplete": 1, "noise bytes": 7}),
    ],
)
def test_what_is_dropped_is_counted_by_kind(data: bytes, counts: dict[str, int]) -> None:
    framer = Framer()
    assert pushed(framer, data, []) == []
    assert framer.dropped == counts


def test_longest_frames_are_taken() -> None:
    longest = [
        nmea.sentence("A" * (LONGEST_NMEA - 4)).rstrip(),
        ubx.frame(1, 2, bytes(LONGEST_UBX - 8)),
        block(bytes(LONGEST_SBF - 8)),
        rtcm(bytes(1023)),
    ]
    assert [frame.data for frame in pushed(Framer(), b"".join(longest), [])] == longest


def test_a_megabyte_of_noise_hides_no_frame() -> None:
    chance = random.Random(1)
    noise = [chance.randbytes(10_000) for _ in range(100)]
    framer, found, sent = Framer(), [], []
    for piece in noise:
        frame = chance.choice((GGA.rstrip(), ubx.frame(1, 7, chance.randbytes(92)), rtcm(chance.randbytes(200))))
        sent.append(frame)
        found += pushed(framer, piece + frame, [])
    assert [frame.data for frame in found if frame.data in sent] == sent
    assert 900_000 < framer.dropped["noise bytes"] < 1_000_000


def test_golden_frames_of_all_protocols_in_one_stream(golden: Callable[[str], Any]) -> None:
    binary = golden("gnss_binary.json")
    sent = [each["sentence"].encode() for each in golden("nmea.json")["sentences"]]
    sent += [bytes.fromhex(each["hex"]) for each in binary["ubx"] + binary["sbf"]]
    sent.append(bytes.fromhex(golden("ntrip.json")["rtcm_1005_hex"]))
    random.Random(0).shuffle(sent)
    assert [frame.data for frame in pushed(Framer(), b"\r\n".join(sent), [7, 100, 777])] == sent

"""RTCM 3: golden frame, every intact frame out of any bytes, and what a stream says of itself."""

import math
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyrtcm import RTCMReader
from pyrtcm.rtcmhelpers import calc_crc24q

from drawbar.protocols import crc24q as crc24q_module
from drawbar.protocols.crc24q import SpanChecksums, crc24q
from drawbar.protocols.rtcm import RtcmFramer, RtcmStatus, message_type, rtcm_frame, station_of

GOLDEN = bytes.fromhex("d300133ed07b038960cdfeae00b6fc33600b743ff975f46bda")
"""message 1005 of station 123, as in shared/vectors/ntrip.json"""


def message(kind: int, station: int) -> bytes:
    return rtcm_frame((kind << 12 | station).to_bytes(3, "big") + bytes(20))


def test_golden_frame_comes_out_whole_however_it_is_cut() -> None:
    for cut in range(len(GOLDEN) + 1):
        framer = RtcmFramer()
        assert framer.feed(GOLDEN[:cut]) + framer.feed(GOLDEN[cut:]) == [GOLDEN]
        assert not +framer.dropped
    assert (message_type(GOLDEN), station_of(GOLDEN)) == (1005, 123)
    assert f"{crc24q(GOLDEN[:-3]):06x}" == "f46bda"


@settings(derandomize=True, deadline=None)
@given(st.binary(max_size=1023))
def test_frames_are_those_of_another_implementation(payload: bytes) -> None:
    frame = rtcm_frame(payload)
    assert calc_crc24q(frame) == 0
    assert RtcmFramer().feed(frame) == [frame]


@settings(derandomize=True, deadline=None)
@given(st.binary(min_size=1, max_size=3000), st.lists(st.tuples(st.integers(0, 3000), st.integers(0, 1029))))
def test_checksum_of_a_span_is_that_of_its_bytes(data: bytes, spans: list[tuple[int, int]]) -> None:
    checksums = SpanChecksums(data)
    first = min((begin for begin, _ in spans), default=0)
    assert checksums.of(min(first, len(data)), min(first, len(data))) == 0
    for begin, length in spans:
        begin = min(begin, len(data))
        span = data[begin : begin + length]
        assert checksums.of(begin, begin + len(span)) == crc24q(span)


def test_bytes_that_begin_a_frame_again_and_again_cost_one_step_each(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each checksum by itself would cost 340."""
    step, bytes_seen = crc24q_module._step, list[int]()
    monkeypatch.setattr(crc24q_module, "_step", lambda value, byte: bytes_seen.append(byte) or step(value, byte))
    assert RtcmFramer().feed(b"\xd3\x03\xff" * 20_000) == []
    assert 50_000 < len(bytes_seen) <= 60_000


def test_too_long_payload_is_refused() -> None:
    with pytest.raises(ValueError, match="1024 bytes; RTCM 3 allows 1023"):
        rtcm_frame(bytes(1024))


@settings(derandomize=True, max_examples=300, deadline=None)
@given(
    st.lists(st.tuples(st.binary(max_size=40), st.binary(max_size=60)), max_size=6),
    st.lists(st.integers(0, 600), max_size=8),
)
def test_every_intact_frame_comes_out_of_noise_cut_anywhere(pieces: list[tuple[bytes, bytes]], cuts: list[int]) -> None:
    frames = [rtcm_frame(payload) for payload, _ in pieces]
    stream = b"".join(frame + noise for frame, (_, noise) in zip(frames, pieces, strict=True)) + bytes(1100)
    framer = RtcmFramer()
    bounds = sorted({0, len(stream), *(cut for cut in cuts if cut < len(stream))})
    found = [frame for start, end in pairwise(bounds) for frame in framer.feed(stream[start:end])]
    assert found == frames
    assert framer.dropped["bytes"] == len(stream) - sum(map(len, frames))


def test_beginning_of_a_frame_in_noise_hides_none_behind_it() -> None:
    false = b"\xd3\x00\x40"
    framer = RtcmFramer()
    assert framer.feed(false + GOLDEN) == []
    assert framer.feed(GOLDEN * 2) == [GOLDEN] * 3
    assert framer.dropped == {"bytes": 3, "checksum": 1}


def test_flipped_bit_costs_its_frame_only() -> None:
    for bit in range(8 * len(GOLDEN)):
        broken = bytearray(GOLDEN)
        broken[bit // 8] ^= 1 << bit % 8
        framer = RtcmFramer()
        found = framer.feed(bytes(broken) + GOLDEN + bytes(1100))
        assert found == [GOLDEN], f"bit {bit}"


def test_memory_is_bounded_whatever_comes() -> None:
    framer = RtcmFramer()
    for _ in range(20):
        framer.feed(b"\xd3\x03\xff" * 100)
        assert len(framer._held) <= 1029 + 300


@pytest.mark.parametrize("kind", [1004, 1012, 1074, 1077, 1087, 1097, 1107, 1117, 1127, 1137])
def test_observations_make_the_age(kind: int) -> None:
    status = RtcmStatus()
    assert status.observation_age(5.0) == math.inf
    status.take(10.0, message(kind, 7))
    status.take(12.0, message(1005, 7))
    status.take(12.5, message(1230, 7))
    assert status.observation_age(13.0) == 3.0
    assert status.types == {kind: 1, 1005: 1, 1230: 1}


@pytest.mark.parametrize("frame", [rtcm_frame(b""), rtcm_frame(b"\x43"), rtcm_frame(b"\x43\x50"), message(1019, 9)])
def test_frame_that_names_no_station_changes_none(frame: bytes) -> None:
    status = RtcmStatus()
    status.take(0.0, message(1077, 7))
    status.take(1.0, frame)
    assert status.station == 7


def test_library_agrees_about_type_and_station() -> None:
    parsed = RTCMReader.parse(GOLDEN)
    assert (int(parsed.identity), parsed.DF003) == (message_type(GOLDEN), station_of(GOLDEN))

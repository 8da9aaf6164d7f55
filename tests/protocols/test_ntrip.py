"""NTRIP: golden handshakes byte for byte, replies and chunks cut anywhere, and the position upload."""

import math
import re

import pytest
from golden import load
from hypothesis import given, settings
from hypothesis import strategies as st

from drawbar.protocols.ntrip import Answer, ChunkReader, ReplyReader, gga_sentence, ntrip_request, upload_of
from drawbar.protocols.rtcm import RtcmFramer, station_of

RTCM = bytes.fromhex("d300133ed07b038960cdfeae00b6fc33600b743ff975f46bda")
V2 = b"HTTP/1.1 200 OK\r\nNtrip-Version: Ntrip/2.0\r\nContent-Type: gnss/data\r\n"
GGA = b"$GNGGA,120000.00,5054.0000000,N,00442.0000000,E,4,12,0.8,50.000,M,45.000,M,1.0,0123*"


def with_checksum(sentence: bytes) -> bytes:
    value = 0
    for byte in sentence[1:-1]:
        value ^= byte
    return sentence + f"{value:02X}\r\n".encode()


def answered(*pieces: bytes) -> tuple[Answer | None, bytes, bool]:
    reader = ReplyReader()
    stream = b"".join([reader.feed(piece) for piece in pieces])
    return reader.answer, stream, reader.ended


@pytest.mark.parametrize("version", [1, 2])
def test_request_is_the_golden_one(version: int) -> None:
    vectors = load("ntrip.json")
    request = ntrip_request(
        mount=vectors["mount"],
        host="127.0.0.1",
        port=2101,
        agent="drawbar/0.2",
        version=version,
        login=vectors["credentials"],
    )
    assert request.decode() == vectors[f"v{version}_request"]


def test_golden_replies_are_understood() -> None:
    vectors = load("ntrip.json")
    body, frame = bytes.fromhex(vectors["v2_body_two_chunks_hex"]), bytes.fromhex(vectors["rtcm_1005_hex"])
    assert answered(vectors["v1_ok"].encode() + frame) == (Answer.STREAM, frame, False)
    assert answered(vectors["v1_ok_seen"].encode() + frame) == (Answer.STREAM, frame, False)
    assert answered(vectors["v2_ok"].encode() + body) == (Answer.STREAM, frame, False)
    assert answered(vectors["sourcetable_v1"].encode())[0] is Answer.SOURCE_TABLE
    assert answered(vectors["unauthorized"].encode())[0] is Answer.NO_LOGIN
    assert [station_of(found) for found in RtcmFramer().feed(frame)] == [vectors["rtcm_1005"]["station"]]


def test_an_address_with_colons_stands_in_brackets() -> None:
    request = ntrip_request(mount="MOUNT", host="::1", port=2101, agent="drawbar/0.2", version=2)
    assert b"\r\nHost: [::1]:2101\r\n" in request


def test_request_without_login_and_with_position() -> None:
    sentence = upload_of(with_checksum(GGA))
    request = ntrip_request(mount="M", host="h", port=1, agent="a/1", version=2, position=sentence)
    assert b"Authorization" not in request
    assert b"\r\nNtrip-GGA: $GPGGA,120000.00," in request
    assert request.endswith(b"\r\n\r\n")
    assert request.count(b"\r\n\r\n") == 1
    assert b"Ntrip-GGA" not in ntrip_request(mount="M", host="h", port=1, agent="a/1", version=1, position=sentence)


HEADS = {
    "v1": b"ICY 200 OK\r\n\r\n",
    "v1, one line end": b"ICY 200 OK\r\n",
    "v1, bare line ends": b"ICY 200 OK\n\n",
    "v1 with headers": b"ICY 200 OK\r\nServer: NTRIP Caster 2.0\r\nDate: 01/Jan/2026\r\n\r\n",
    "v2 plain": V2 + b"Connection: close\r\n\r\n",
    "v2 without type": b"HTTP/1.0 200 OK\r\n\r\n",
}


@pytest.mark.parametrize("head", HEADS)
@pytest.mark.parametrize("stream", [RTCM, b"\x00" + RTCM, b"A mess" + RTCM], ids=["frame", "late", "text"])
def test_stream_begins_behind_every_head_cut_anywhere(head: str, stream: bytes) -> None:
    reply = HEADS[head] + stream
    for cut in range(len(reply)):
        assert answered(reply[:cut], reply[cut:]) == (Answer.STREAM, stream, False), f"cut at {cut}"
    assert answered(*(reply[at : at + 1] for at in range(len(reply)))) == (Answer.STREAM, stream, False)


def test_v1_is_accepted_before_its_stream_begins() -> None:
    assert answered(b"ICY 200 OK\r\n") == (Answer.STREAM, b"", False)


ANSWERS = {
    b"HTTP/1.1 401 Unauthorized\r\n": Answer.NO_LOGIN,
    b"HTTP/1.0 403 Forbidden\r\n": Answer.NO_LOGIN,
    b"ICY 401 Unauthorized\r\n": Answer.NO_LOGIN,
    b"ERROR - Bad Password\r\n": Answer.NO_LOGIN,
    b"ERROR - Mount Point Taken\r\n": Answer.REFUSED,
    b"HTTP/1.1 404 Not Found\r\n": Answer.NO_MOUNT,
    b"HTTP/1.1 302 Found\r\n": Answer.REDIRECT,
    b"HTTP/1.1 503 Service Unavailable\r\n": Answer.REFUSED,
    b"SOURCETABLE 200 OK\r\n": Answer.SOURCE_TABLE,
    b"HTTP/1.1 200 OK\r\ncontent-type: GNSS/Sourcetable\r\n\r\n": Answer.SOURCE_TABLE,
    b"SSH-2.0-OpenSSH\r\n": Answer.NONSENSE,
    b"\n": Answer.NONSENSE,
    b"x" * 9000: Answer.NONSENSE,
    b"HTTP/1.1 200 OK\r\n" + b"A: b\r\n" * 2000: Answer.NONSENSE,
}


@pytest.mark.parametrize("reply", ANSWERS, ids=lambda reply: reply[:20].decode())
def test_answer_that_is_no_stream_is_known(reply: bytes) -> None:
    assert answered(reply)[0] is ANSWERS[reply]
    assert answered(reply, RTCM)[1] == b"", "nothing of it is taken for corrections"


def chunked(pieces: list[bytes], extension: bytes = b"") -> bytes:
    return b"".join(b"%X%b\r\n%b\r\n" % (len(piece), extension, piece) for piece in pieces if piece)


@settings(derandomize=True, max_examples=300, deadline=None)
@given(
    st.lists(st.binary(min_size=1, max_size=40), max_size=8),
    st.sampled_from([b"", b";a=b", b" ; name"]),
    st.lists(st.integers(1, 30), min_size=1),
    st.booleans(),
)
def test_chunks_are_taken_apart_however_they_are_cut(
    pieces: list[bytes], extension: bytes, steps: list[int], last: bool
) -> None:
    coded = chunked(pieces, extension) + (b"0\r\n\r\n" if last else b"")
    reader, body, position = ChunkReader(), bytearray(), 0
    while position < len(coded):
        step = steps[position % len(steps)]
        body += reader.feed(coded[position : position + step])
        position += step
    assert bytes(body) == b"".join(pieces)
    assert (reader.ended, reader.broken) == (last, False)


@pytest.mark.parametrize(
    "coded",
    [b"hello\r\n", b"\r\n", b"-1\r\n", b"3\r\nabcX\r\n", b"123456789\r\n", b"1" * 300, b"5 5\r\n", b"\xd3\x00\n"],
)
def test_what_is_no_chunk_ends_the_stream(coded: bytes) -> None:
    reader = ChunkReader()
    reader.feed(coded)
    assert reader.broken
    assert reader.ended
    assert reader.feed(b"1\r\na\r\n") == b""


@settings(derandomize=True, max_examples=500, deadline=None)
@given(
    st.lists(st.binary(max_size=100)),
    st.sampled_from([b"", V2 + b"Transfer-Encoding: chunked\r\n\r\n", b"ICY 200 OK\r\n"]),
)
def test_any_reply_is_read_without_an_error(pieces: list[bytes], head: bytes) -> None:
    reader = ReplyReader()
    for piece in [head, *pieces]:
        reader.feed(piece)
        assert len(reader._held) <= 8292


def test_receivers_own_sentence_is_sent_with_the_talker_that_all_casters_know() -> None:
    sentence = with_checksum(GGA)
    assert upload_of(sentence) == with_checksum(b"$GPGGA" + GGA[6:])
    assert upload_of(upload_of(sentence)) == upload_of(sentence)


BAD_SENTENCES = {
    "no fix": with_checksum(GGA.replace(b",E,4,", b",E,0,")),
    "no quality": with_checksum(GGA.replace(b",E,4,", b",E,,")),
    "no position": with_checksum(GGA.replace(b"5054.0000000", b"")),
    "wrong checksum": GGA + b"00\r\n",
    "no checksum": GGA[:-1] + b"\r\n",
    "another sentence": with_checksum(b"$GNVTG,,T,,M,0.0,N,0.0,K,A*"),
    "a field too few": with_checksum(GGA.replace(b",0123*", b"*")),
    "two lines": with_checksum(GGA) + with_checksum(GGA),
    "line end inside": with_checksum(GGA.replace(b"0123", b"0\r\n3")),
    "nothing": b"",
    "noise": bytes(range(256)),
}


@pytest.mark.parametrize("name", BAD_SENTENCES)
def test_sentence_that_no_caster_should_see_is_not_sent(name: str) -> None:
    assert upload_of(BAD_SENTENCES[name]) == b""


POSITION = {
    "time_of_day": 43200.0,
    "latitude": math.radians(50.9),
    "longitude": math.radians(4.7),
    "quality": 4,
    "satellites": 12,
    "dilution": 0.8,
    "height": 50.0,
    "separation": 45.0,
}


def test_made_sentence_is_one_that_is_sent() -> None:
    sentence = gga_sentence(**POSITION)  # type: ignore[arg-type]
    fields = b"$GPGGA,120000.00,5054.0000000,N,00442.0000000,E,4,12,0.8,50.000,M,45.000,M,,*"
    assert sentence == with_checksum(fields)
    assert upload_of(sentence) == sentence


@settings(derandomize=True, max_examples=300, deadline=None)
@given(
    st.floats(-math.pi / 2, math.pi / 2),
    st.floats(-math.pi, math.pi),
    st.floats(0.0, 86400.0),
    st.floats(-500.0, 9000.0),
)
def test_made_sentence_says_the_position(latitude: float, longitude: float, time: float, height: float) -> None:
    place = {"latitude": latitude, "longitude": longitude, "time_of_day": time, "height": height}
    sentence = gga_sentence(**(POSITION | place))  # type: ignore[arg-type]
    assert upload_of(sentence) == sentence
    fields = sentence.decode().split(",")
    for text, side, digits, angle in ((fields[2], fields[3], 2, latitude), (fields[4], fields[5], 3, longitude)):
        assert re.fullmatch(rf"\d{{{digits}}}[0-5]\d\.\d{{7}}", text)
        degrees = int(text[:digits]) + float(text[digits:]) / 60.0
        assert math.radians(degrees) * (-1 if side in "SW" else 1) == pytest.approx(angle, abs=2e-11)
    assert re.fullmatch(r"([01]\d|2[0-3])[0-5]\d[0-5]\d\.\d\d", fields[1])


@pytest.mark.parametrize(
    "wrong",
    [{"quality": 0}, {"quality": 10}, {"latitude": math.nan}, {"longitude": 3.2}, {"height": math.inf},
     {"time_of_day": math.nan}, {"separation": math.nan}, {"dilution": math.nan}, {"satellites": -1}],
    ids=str,
)  # fmt: skip
def test_what_is_no_position_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=r"is no position|height"):
        gga_sentence(**(POSITION | wrong))  # type: ignore[arg-type]

"""The caster stand-in, judged by other software: http.client reads its chunks, pyrtcm its frames."""

import base64
import http.client
import socket
import threading
import time

import pytest
from pyrtcm import RTCMReader

from drawbar.machine.stand_in.caster import Caster, CasterFault, CasterSettings, Dialect, empty_corrections
from drawbar.protocols.rtcm import RtcmFramer

FAST = 0.005
LOGIN = "farmer:s3cret"
EXPECTED = b"".join(map(empty_corrections, range(200)))


def request(mount: str = "MP1", login: str = "") -> bytes:
    authorization = f"Authorization: Basic {base64.b64encode(login.encode()).decode()}\r\n" if login else ""
    return f"GET /{mount} HTTP/1.0\r\nUser-Agent: NTRIP test/1\r\n{authorization}\r\n".encode()


def reply(caster: Caster, sent: bytes, count: int) -> bytes:
    """Return the first bytes of what the caster says, or all if it says less."""
    with socket.create_connection(("127.0.0.1", caster.port), timeout=10.0) as client:
        client.sendall(sent)
        data = b""
        while len(data) < count and (piece := client.recv(count - len(data))):
            data += piece
    return data


def test_http_client_reads_what_is_chunked() -> None:
    with Caster(CasterSettings(dialect=Dialect.V2_CHUNKED, interval=FAST)) as caster:
        connection = http.client.HTTPConnection("127.0.0.1", caster.port, timeout=10.0)
        connection.request("GET", "/MP1", headers={"Ntrip-Version": "Ntrip/2.0", "User-Agent": "NTRIP test/1"})
        response = connection.getresponse()
        assert (response.status, response.getheader("Content-Type")) == (200, "gnss/data")
        assert response.read(300) == EXPECTED[:300]
        response.close()
        connection.close()


def test_chunks_are_cut_inside_frames() -> None:
    with Caster(CasterSettings(dialect=Dialect.V2_CHUNKED, interval=FAST)) as caster:
        body = reply(caster, request(), 250).partition(b"\r\n\r\n")[2]
    size, _, rest = body.partition(b"\r\n")
    assert RtcmFramer().feed(rest[: int(size, 16)]) == [], "the first chunk holds no whole frame"


@pytest.mark.parametrize(
    ("dialect", "head"),
    [
        (Dialect.V1, b"ICY 200 OK\r\n\r\n"),
        (Dialect.V1_ONE_LINE_END, b"ICY 200 OK\r\n"),
        (
            Dialect.V2_PLAIN,
            b"HTTP/1.1 200 OK\r\nNtrip-Version: Ntrip/2.0\r\nContent-Type: gnss/data\r\nConnection: close\r\n\r\n",
        ),
    ],
)
def test_other_dialects_begin_the_stream_behind_their_head(dialect: Dialect, head: bytes) -> None:
    with Caster(CasterSettings(dialect=dialect, interval=FAST)) as caster:
        assert reply(caster, request(), len(head) + 100) == head + EXPECTED[:100]


@pytest.mark.parametrize("dialect", [Dialect.V1, Dialect.V2_PLAIN])
def test_wrong_mount_gets_the_table(dialect: Dialect) -> None:
    with Caster(CasterSettings(dialect=dialect)) as caster:
        table = reply(caster, request("MP2"), 10000)
    assert table.startswith(b"SOURCETABLE 200 OK\r\n" if dialect is Dialect.V1 else b"HTTP/1.1 200 OK\r\n")
    assert b"\r\n\r\nSTR;MP1;" in table
    assert table.endswith(b"\r\nENDSOURCETABLE\r\n")
    assert table.split(b"STR;")[1].split(b";")[10] == b"0", "field 12, nmea"


@pytest.mark.parametrize(("login", "code"), [("", b"401"), ("farmer:wrong", b"401"), (LOGIN, b"200")])
def test_login_is_asked_for(login: str, code: bytes) -> None:
    with Caster(CasterSettings(login=LOGIN, dialect=Dialect.V2_PLAIN)) as caster:
        assert reply(caster, request(login=login), 12) == b"HTTP/1.1 " + code


def test_nothing_is_sent_before_a_position_where_one_is_needed() -> None:
    with (
        Caster(CasterSettings(dialect=Dialect.V1, interval=FAST, needs_position=True)) as caster,
        socket.create_connection(("127.0.0.1", caster.port), timeout=10.0) as client,
    ):
        client.sendall(request())
        assert client.recv(100) == b"ICY 200 OK\r\n\r\n"
        client.settimeout(0.1)
        with pytest.raises(TimeoutError):
            client.recv(100)
        client.settimeout(10.0)
        client.sendall(b"$GPGGA,x*00\r\n")
        assert EXPECTED.startswith(client.recv(100))


@pytest.mark.parametrize("fault", [CasterFault.CLOSE, CasterFault.STALL])
def test_fault_comes_after_its_epochs(fault: CasterFault) -> None:
    good = b"".join(map(empty_corrections, range(5)))
    with Caster(CasterSettings(dialect=Dialect.V1, interval=FAST, fault=fault, after=5)) as caster:
        assert reply(caster, request(), 14 + len(good) + (fault is CasterFault.CLOSE))[14:] == good


def test_frames_are_what_a_library_takes_them_for() -> None:
    frames = RtcmFramer().feed(empty_corrections(10, station=77))
    parsed = [RTCMReader.parse(frame) for frame in frames]
    assert [message.identity for message in parsed] == ["1077", "1005"]
    assert [message.DF003 for message in parsed] == [77, 77]
    assert parsed[0].DF004 == 10000
    assert parsed[0].NSat == 0


def test_stop_leaves_no_thread_behind_even_beside_a_silent_client() -> None:
    caster = Caster(CasterSettings())
    with socket.create_connection(("127.0.0.1", caster.start()), timeout=10.0):
        time.sleep(0.05)
        caster.stop()
    assert not [thread for thread in threading.enumerate() if thread.name == "caster"]

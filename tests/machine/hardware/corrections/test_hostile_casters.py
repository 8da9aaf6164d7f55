"""Casters that are broken or mean harm: each is told and given up; no call waits, and nothing of theirs is kept."""

import gzip
import socket
import sys
import tracemalloc
from collections.abc import Callable
from types import FrameType

import pytest
from caster_bench import Bench

from drawbar.machine.hardware.corrections.session import AT_ONCE
from drawbar.machine.hardware.corrections.status import CorrectionsState
from drawbar.machine.stand_in.caster import empty_corrections

MEGABYTE = 1_000_000
OK = b"HTTP/1.1 200 OK\r\nNtrip-Version: Ntrip/2.0\r\n"
CHUNKED = OK + b"Transfer-Encoding: chunked\r\n\r\n"
FRAMES = b"".join(map(empty_corrections, range(20)))

HOSTILE = {
    "first line without an end": (b"ICY 200 OK" + b" " * MEGABYTE, "answers something that is not NTRIP"),
    "header without an end": (OK + b"X-Filler: " + b"x" * MEGABYTE, "answers something that is not NTRIP"),
    "headers without an end": (OK + b"X-Filler: x\r\n" * 80_000, "answers something that is not NTRIP"),
    "headers of version 1 without an end": (b"ICY 200 OK\r\n" + b"X-Filler: x\r\n" * 80_000, "no byte for"),
    "long headers of version 1": (
        b"ICY 200 OK\r\n" + (b"X: %b\r\n" % (b"x" * 9000)) * 100,
        "no intact frame of RTCM 3",
    ),
    "a chunk of 1e12 bytes": (CHUNKED + b"E8D4A51000\r\n" + b"\0" * MEGABYTE, "has ended the stream"),
    "a chunk of 4e9 bytes of noise": (CHUNKED + b"FFFFFFFF\r\n" + b"\x55" * MEGABYTE, "no intact frame of RTCM 3"),
    "a negative chunk": (CHUNKED + b"-5\r\nabcde\r\n", "has ended the stream"),
    "a chunk's size without an end": (CHUNKED + b"5;x=" + b"y" * MEGABYTE, "has ended the stream"),
    "chunks of one byte of noise": (CHUNKED + b"1\r\n$\r\n" * 80_000, "no intact frame of RTCM 3"),
    "frames that begin and never end": (OK + b"\r\n" + b"\xd3\x03\xff" * 100_000, "no intact frame of RTCM 3"),
    "gzip": (OK + b"Content-Encoding: gzip\r\n\r\n" + gzip.compress(FRAMES * 100), "no byte for 10 s"),
    "a redirect": (b"HTTP/1.1 302 Found\r\nLocation: http://127.0.0.1:1/MP1\r\n\r\n", "leads to another page (302)"),
    "go on": (b"HTTP/1.1 100 Continue\r\n\r\n" + OK + b"\r\n" + FRAMES, "refuses the request (100)"),
    "another protocol": (b"SSH-2.0-OpenSSH_9.6\r\n" + b"\0" * 500, "answers something that is not NTRIP"),
    "TLS": (b"\x15\x03\x01\0\x02\x02\x28" * 2000, "answers something that is not NTRIP"),
}


CALLS = 10 * AT_ONCE
"""of Python's and C's functions within one turn, which takes in AT_ONCE bytes: a few for each of them"""


def calls_of(turn: Callable[[], object]) -> int:
    """Return how many functions a turn calls; its time would be that of this machine and its load."""
    count = 0

    def called(frame: FrameType, event: str, argument: object) -> None:
        nonlocal count
        count += event in ("call", "c_call")

    sys.setprofile(called)
    try:
        turn()
    finally:
        sys.setprofile(None)
    return count


class Serving:
    """A caster that says something once it was asked, as fast as the client takes it."""

    def __init__(self, server: socket.socket, bench: Bench, reply: bytes) -> None:
        bench.until_state(CorrectionsState.ASKING)
        self._line, self._left, self._bench = server.accept()[0], memoryview(reply), bench
        self._line.setblocking(False)

    def serve(self) -> None:
        """Send what goes, and let the client take its turn, which costs it little."""
        try:
            sent = self._line.send(self._left[:65536]) if self._left else 0
        except BlockingIOError:
            sent = 0  # the client takes some first
        except OSError:
            sent = len(self._left)  # the client has closed the line
        self._left = self._left[sent:]
        assert calls_of(self._bench.advance) < CALLS
        if not self._left:
            self._bench.clock.now += 1.0

    def close(self) -> None:
        self._line.close()


@pytest.mark.parametrize("kind", HOSTILE)
def test_a_hostile_reply_is_reported_and_given_up(connect: Callable[..., Bench], kind: str) -> None:
    reply, told = HOSTILE[kind]
    with socket.create_server(("127.0.0.1", 0)) as server:
        bench = connect(server.getsockname()[1])
        serving = Serving(server, bench, reply)
        tracemalloc.start()
        before = tracemalloc.get_traced_memory()[0]
        turns = 0
        while bench.status.state is not CorrectionsState.WAITING:
            serving.serve()
            turns += 1
            assert turns < 2 * len(reply) // AT_ONCE + 1000
        kept, _ = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        serving.close()
    assert told in bench.status.message
    assert bench.stream == b""
    assert kept - before < 100_000
    assert bench.status.next_attempt > 0.0

"""TCP clients on loopback: reconnecting after every kind of loss, slower each time, and never waiting."""

import socket
import struct
import threading
from collections.abc import Iterator
from typing import Any

import pytest
from waiting import FakeClock, until

from drawbar.transports.address import TcpAddress
from drawbar.transports.tcp import ATTEMPT, TcpTransport


@pytest.fixture
def server() -> Iterator[socket.socket]:
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(10.0)
        yield server


def client_of(server: socket.socket, clock: FakeClock, host: str = "127.0.0.1") -> TcpTransport:
    return TcpTransport(TcpAddress(host=host, port=server.getsockname()[1]), clock)


def connect(transport: TcpTransport, server: socket.socket) -> socket.socket:
    transport.read()
    until(lambda: transport.read() or transport.connected)
    return server.accept()[0]


def next_attempt(transport: TcpTransport, clock: FakeClock) -> float:
    """Return after what pause it begins another attempt."""
    start = clock.now
    while transport.fileno() == -1:
        clock.now += 0.25
        transport.read()
        assert clock.now < start + 60.0
    return clock.now - start


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost"])
def test_bytes_cross_both_ways(server: socket.socket, host: str) -> None:
    clock = FakeClock()
    transport = client_of(server, clock, host)
    assert not transport.connected
    assert not transport.write(b"early")
    assert transport.unsent == 5
    with connect(transport, server) as other:
        other.sendall(b"hello")
        (piece,) = until(transport.read)
        assert (piece.data, piece.time) == (b"hello", clock.now)
        assert transport.write(b"answer")
        assert other.recv(100) == b"answer"
        assert transport.trouble == ""
        transport.close()
        assert other.recv(100) == b""


@pytest.mark.parametrize("linger", [False, True], ids=["closed", "reset"])
def test_lost_connection_is_opened_again(server: socket.socket, linger: bool) -> None:
    clock = FakeClock()
    transport = client_of(server, clock)
    other = connect(transport, server)
    if linger:
        other.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    other.close()
    until(lambda: transport.read() == [] and not transport.connected)
    assert ("reset" in transport.trouble) == linger
    assert next_attempt(transport, clock) == pytest.approx(1.0)
    with connect(transport, server) as other:
        other.sendall(b"again")
        assert until(transport.read)[0].data == b"again"
    until(lambda: transport.read() == [] and not transport.connected)
    assert transport.trouble.endswith("next attempt in 1 s"), "bytes came in between"
    transport.close()


def test_silent_other_end_is_taken_for_dead_after_a_second(server: socket.socket) -> None:
    clock = FakeClock()
    transport = client_of(server, clock)
    with connect(transport, server) as other:
        clock.now += 0.99
        transport.read()
        assert transport.connected
        other.sendall(b"x")
        until(transport.read)
        clock.now += 0.99
        transport.read()
        assert transport.connected, "a byte counts from when it came"
        clock.now += 0.02
        transport.read()
        assert not transport.connected
        assert "no byte for 1 s; next attempt in 1 s" in transport.trouble
    transport.close()


def test_refused_connections_are_tried_ever_more_slowly(server: socket.socket) -> None:
    clock = FakeClock()
    transport = client_of(server, clock)
    server.close()
    pauses = []
    for _ in range(5):
        until(lambda: transport.read() == [] and transport.fileno() == -1)
        assert "Connection refused" in transport.trouble
        pauses.append(next_attempt_of_refused(transport, clock))
    assert pauses == pytest.approx([1.0, 2.0, 5.0, 10.0, 10.0])


def next_attempt_of_refused(transport: TcpTransport, clock: FakeClock) -> float:
    """Loopback refuses at once: an attempt shows by the pause it announces being longer than what is left."""
    announced = float(transport.trouble.rpartition("in ")[2].removesuffix(" s"))
    clock.now += announced - 0.01
    failures = transport._failures
    transport.read()
    assert transport._failures == failures
    clock.now += 0.01
    until(lambda: transport.read() == [] and transport._failures > failures)
    return announced


def test_attempt_without_an_answer_is_given_up(server: socket.socket) -> None:
    server.listen(0)
    port = server.getsockname()[1]
    clock = FakeClock()
    crowd = [TcpTransport(TcpAddress(host="127.0.0.1", port=port), clock) for _ in range(4)]
    for each in crowd:
        each.read()
    until(lambda: [each for each in crowd if each.read() == [] and each.connected])
    waiting = [each for each in crowd if each.read() == [] and not each.connected and each.fileno() != -1]
    assert waiting, "a full backlog answers nobody"
    clock.now += ATTEMPT
    waiting[0].read()
    assert "no answer" in waiting[0].trouble
    for each in crowd:
        each.close()


def test_unknown_name_is_reported_without_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    whole, answers = socket.getaddrinfo, threading.Event()

    def look_up(*asked: Any, flags: int, **kind: Any) -> Any:
        if not flags & socket.AI_NUMERICHOST:
            assert answers.wait(60.0), "it is waited for"
        return whole(*asked, flags=flags | socket.AI_NUMERICHOST, **kind)

    monkeypatch.setattr(socket, "getaddrinfo", look_up)
    transport = TcpTransport(TcpAddress(host="no-such-host.invalid", port=1), FakeClock())
    assert transport.read() == []
    assert not transport.trouble
    answers.set()
    until(lambda: transport.read() == [] and transport.trouble)
    assert "no-such-host.invalid is not found" in transport.trouble


def test_bytes_a_full_socket_does_not_take_are_counted(server: socket.socket) -> None:
    transport = client_of(server, FakeClock())
    with connect(transport, server):
        assert not transport.write(bytes(64 << 20))
        assert 0 < transport.unsent < 64 << 20
        assert transport.connected
    transport.close()

"""Connections with TLS: bytes that come with the end of the handshake, large ones both ways, garbage; names."""

import socket
import ssl
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from certificates import certificate
from waiting import until

from drawbar.transports.connection import Connection, NameLookUp, Phase

Serve = Callable[[Callable[[ssl.SSLSocket], None]], tuple[int, ssl.SSLContext]]


@pytest.fixture
def serve(tmp_path: Path) -> Iterator[Serve]:
    """Return a function that has one client served in a thread, over TLS 1.2, where a server may speak first."""
    threads: list[threading.Thread] = []

    def serve(talk: Callable[[ssl.SSLSocket], None]) -> tuple[int, ssl.SSLContext]:
        context, file = certificate(tmp_path)
        context.maximum_version = ssl.TLSVersion.TLSv1_2
        server = socket.create_server(("127.0.0.1", 0))
        server.settimeout(10.0)

        def run() -> None:
            with server, suppress(OSError), context.wrap_socket(server.accept()[0], server_side=True) as client:
                client.settimeout(10.0)
                talk(client)

        threads.append(threading.Thread(target=run, daemon=True))
        threads[-1].start()
        return server.getsockname()[1], ssl.create_default_context(cafile=str(file))

    yield serve
    for thread in threads:
        thread.join()


def test_bytes_that_come_with_the_end_of_the_handshake_are_read(serve: Serve) -> None:
    port, context = serve(lambda client: client.sendall(b"greeting") or client.recv(1))  # type: ignore[func-returns-value]
    connection = Connection("127.0.0.1", port, context)
    while connection.advance() is not Phase.OPEN:
        assert connection.phase is not Phase.CLOSED, connection.trouble
        time.sleep(0.1)  # so that all of the server's next flight is there at once
    assert until(connection.read) == b"greeting"
    connection.close()


def test_another_end_that_wants_to_agree_anew_is_left(tmp_path: Path) -> None:
    _, file = certificate(tmp_path)
    command = ["openssl", "s_server", "-tls1_2", "-accept", "127.0.0.1:0", "-cert", str(file)]
    command += ["-key", str(tmp_path / "key.pem")]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL, bufsize=0) as server:
        assert server.stdin is not None
        assert server.stdout is not None
        try:
            port = int(next(line for line in server.stdout if line.startswith(b"ACCEPT")).rpartition(b":")[2])
            connection = Connection("127.0.0.1", port, ssl.create_default_context(cafile=file))
            until(lambda: connection.advance() is Phase.OPEN)
            server.stdin.write(b"r\n")  # renegotiate
            until(lambda: (connection.read(), connection.write(b"position"))[1] == 0)
        finally:
            server.kill()
    assert connection.phase is Phase.CLOSED
    assert connection.trouble == "TLS: the other end wants to agree again on it"


def test_many_bytes_cross_both_ways(serve: Serve) -> None:
    data = bytes(range(256)) * 200

    def echo(client: ssl.SSLSocket) -> None:
        heard = b""
        while len(heard) < len(data):
            heard += client.recv(65536)
        client.sendall(heard)

    port, context = serve(echo)
    connection = Connection("127.0.0.1", port, context)
    until(lambda: connection.advance() is Phase.OPEN)
    assert connection.write(data) == len(data)
    heard = bytearray()
    until(lambda: heard.extend(connection.read()) or len(heard) == len(data))  # type: ignore[func-returns-value]
    assert bytes(heard) == data
    until(lambda: connection.read() == b"" and connection.phase is Phase.CLOSED)
    assert connection.trouble == "the other end has closed the connection"
    assert connection.write(b"x") == 0


def test_bytes_that_nobody_sealed_end_the_connection(serve: Serve) -> None:
    def spoil(client: ssl.SSLSocket) -> None:
        with socket.socket(fileno=client.detach()) as plain:
            plain.sendall(b"not sealed at all")

    port, context = serve(spoil)
    connection = Connection("127.0.0.1", port, context)
    until(lambda: connection.advance() is Phase.OPEN)
    until(lambda: connection.read() == b"" and connection.phase is Phase.CLOSED)
    assert "TLS" in connection.trouble


def test_next_address_is_tried_where_the_first_refuses() -> None:
    with socket.create_server(("127.0.0.2", 0)) as server:
        port = server.getsockname()[1]
        connection = Connection("127.0.0.1", port)
        connection._look_up.addresses = [(socket.AF_INET, (host, port)) for host in ("127.0.0.1", "127.0.0.2")]
        until(lambda: connection.advance() is Phase.OPEN)
        accepted, peer = server.accept()
        assert peer[0].startswith("127.")
        accepted.close()
        connection.close()


@pytest.mark.parametrize("host", ["127.0.0.1", "::1"])
def test_addresses_need_no_look_up(host: str) -> None:
    found = NameLookUp(host, 80).addresses
    assert found is not None
    assert found[0][1] == (host, 80)


@pytest.mark.parametrize("host", ["x" * 300, "a..b", ""])
def test_impossible_names_are_reported(host: str) -> None:
    look_up = NameLookUp(host, 80)
    assert until(lambda: look_up.trouble or look_up.addresses)

"""Two boards over one socket: each hears all, and is sent only its own."""

import socket
from collections.abc import Iterator

import pytest

from drawbar.machine.hardware.shared_socket import own_sources, share
from drawbar.transports.base import Received


class UdpSocket:
    """A socket of this computer, as far as it is shared."""

    def __init__(self) -> None:
        self.connected, self.trouble = True, ""
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.setblocking(False)

    def fileno(self) -> int:
        return self.socket.fileno()

    def read(self) -> list[Received]:
        received = []
        while True:
            try:
                data, (host, port) = self.socket.recvfrom(2048)
            except BlockingIOError:
                return received
            received.append(Received(0.0, data, f"{host}:{port}"))

    def write_to(self, data: bytes, peer: tuple[str, int]) -> bool:
        try:
            self.socket.sendto(data, peer)
        except OSError as error:
            self.trouble = str(error)
            return False
        return True

    def close(self) -> None:
        self.socket.close()


@pytest.fixture
def computer() -> Iterator[UdpSocket]:
    socket_ = UdpSocket()
    yield socket_
    socket_.close()


@pytest.fixture
def boards() -> Iterator[list[UdpSocket]]:
    sockets = [UdpSocket(), UdpSocket()]
    yield sockets
    for each in sockets:
        each.close()


def test_each_transport_writes_to_its_own_peer_and_hears_all(computer: UdpSocket, boards: list[UdpSocket]) -> None:
    transports = share(computer, [board.socket.getsockname() for board in boards])
    for transport, data in zip(transports, (b"tractor", b"trailer"), strict=True):
        assert transport.write(data)
        assert transport.fileno() == computer.fileno()
    assert [[each.data for each in board.read()] for board in boards] == [[b"tractor"], [b"trailer"]]
    for board, data in zip(boards, (b"one", b"two"), strict=True):
        board.write_to(data, computer.socket.getsockname())
    assert [[each.data for each in transport.read()] for transport in transports] == [[b"one", b"two"]] * 2
    assert [transport.read() for transport in transports] == [[], []]


def test_another_socket_is_heard_too_and_closed_with_the_last(computer: UdpSocket, boards: list[UdpSocket]) -> None:
    listener = UdpSocket()
    transports = share(computer, [board.socket.getsockname() for board in boards], [listener])  # type: ignore[list-item]
    boards[0].write_to(b"set point", listener.socket.getsockname())
    assert [[each.data for each in transport.read()] for transport in transports] == [[b"set point"]] * 2
    for transport in transports:
        assert listener.fileno() >= 0
        transport.close()
    assert listener.fileno() == -1


def test_own_datagrams_are_known_by_their_sender() -> None:
    peers = [("127.0.0.1", 8888), ("127.255.255.255", 8888), ("256.0.0.1", 8888)]
    assert own_sources(peers, 9999) == {"127.0.0.1:9999"}


def test_what_nobody_reads_is_bounded_and_counted(computer: UdpSocket, boards: list[UdpSocket]) -> None:
    first, second = share(computer, [board.socket.getsockname() for board in boards])
    for place in range(1100):
        boards[0].write_to(str(place).encode(), computer.socket.getsockname())
        first.read()
    received = second.read()
    assert len(received) == 1000
    assert received[-1].data == b"1099"
    assert second.lost == 100  # type: ignore[attr-defined]


def test_the_socket_closes_with_the_last_and_what_is_not_sent_is_reported(computer: UdpSocket) -> None:
    first, second = share(computer, [("127.0.0.1", 9), ("255.255.255.255", 9)])
    assert not second.write(b"12345")  # broadcasts are not allowed on this socket
    assert second.trouble
    assert second.unsent == 5
    first.close()
    assert first.fileno() == -1
    assert not first.write(b"1")
    assert first.trouble == "not sent: the transport is closed"
    assert computer.fileno() >= 0
    second.close()
    assert computer.fileno() == -1

"""UDP sockets on loopback: senders, kernel stamps, taken ports, and datagrams that cannot be sent."""

import socket
import sys
import time

import pytest
from waiting import until

from drawbar.errors import HardwareError
from drawbar.transports import udp
from drawbar.transports.address import UdpAddress
from drawbar.transports.base import Received
from drawbar.transports.open import open_transport
from drawbar.transports.udp import UdpTransport


def listening(peer: tuple[str, int] | None = None, broadcast: bool = False, host: str = "127.0.0.1") -> UdpTransport:
    return UdpTransport(UdpAddress(host=host, port=0, peer=peer, broadcast=broadcast))


def test_datagrams_keep_their_bounds_and_their_sender() -> None:
    board = listening()
    computer = listening(peer=("127.0.0.1", board.port))
    datagrams = [b"one", b"", bytes(60000)]
    assert all(computer.write(datagram) for datagram in datagrams)
    received: list[Received] = []
    until(lambda: received.extend(board.read()) or len(received) >= len(datagrams))  # type: ignore[func-returns-value]
    assert [piece.data for piece in received] == datagrams
    assert {piece.source for piece in received} == {f"127.0.0.1:{computer.port}"}
    assert board.write_to(b"reply", ("127.0.0.1", computer.port))
    assert until(computer.read)[0].data == b"reply"
    for each in (board, computer):
        each.close()
        assert each.read() == []
        assert each.fileno() == -1


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux stamps datagrams so")
def test_stamp_is_the_kernels_not_that_of_reading() -> None:
    board = listening()

    def stamped_on_arrival() -> bool:
        """Linux switches its stamps on some time after the first socket asks for them."""
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            before = time.monotonic()
            sender.sendto(b"x", ("127.0.0.1", board.port))
            after = time.monotonic()
        time.sleep(0.1)
        (piece,) = board.read()
        return before - 0.001 <= piece.time <= after + 0.05

    assert until(stamped_on_arrival)
    board.close()


def test_taken_port_is_reported_with_the_program_that_has_it(monkeypatch: pytest.MonkeyPatch) -> None:
    other = listening()
    address = UdpAddress(host="127.0.0.1", port=other.port)
    with pytest.raises(HardwareError, match=f"port {other.port} is taken: another program listens there; stop it"):
        UdpTransport(address)
    monkeypatch.setitem(udp.KNOWN_PORTS, other.port, "AgIO")
    with pytest.raises(HardwareError, match=r"another program \(AgIO\?\) listens there"):
        UdpTransport(address)
    with pytest.raises(HardwareError, match="is taken"):
        open_transport(f"udp://0.0.0.0:{other.port}")
    other.close()
    UdpTransport(address).close()


def test_foreign_address_is_refused() -> None:
    with pytest.raises(HardwareError, match=r"192\.0\.2\.1 is no address of this computer"):
        listening(host="192.0.2.1")


def test_what_cannot_be_sent_is_counted_and_told() -> None:
    deaf = listening()
    assert not deaf.write(b"four")
    assert (deaf.unsent, deaf.trouble) == (4, "not sent: the address has no peer")
    plain = listening(peer=("255.255.255.255", 9))
    assert not plain.write(b"four")
    assert "a broadcast address needs broadcast=1" in plain.trouble
    assert not plain.write_to(bytes(70000), ("127.0.0.1", 9))
    assert plain.unsent == 70004
    for each in (deaf, plain):
        each.close()


def test_broadcast_reaches_a_socket_of_all_addresses() -> None:
    board = listening(host="0.0.0.0")
    computer = listening(host="0.0.0.0", peer=("127.255.255.255", board.port), broadcast=True)
    assert computer.write(b"to all")
    assert until(board.read)[0].data == b"to all"
    board.close()
    computer.close()


def test_dead_port_of_the_other_end_disturbs_nothing() -> None:
    board = listening()
    gone = board.port
    board.close()
    computer = listening(peer=("127.0.0.1", gone))
    for _ in range(3):
        assert computer.write(b"x")
        assert computer.read() == []
    assert computer.connected
    computer.close()


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere the system chooses one network")
def test_a_broadcast_goes_out_on_every_network_that_takes_it(monkeypatch: pytest.MonkeyPatch) -> None:
    board, computer = listening(host="0.0.0.0"), listening(host="0.0.0.0", broadcast=True)
    names = socket.if_nameindex()
    (loopback,) = (number for number, name in names if name == "lo")
    monkeypatch.setattr(socket, "if_nameindex", lambda: [(loopback, "lo"), (99999, "gone"), (loopback, "lo")])
    computer.write_everywhere(b"scan", board.port)
    received: list[Received] = []
    until(lambda: received.extend(board.read()) or len(received) >= 2)  # type: ignore[func-returns-value]
    assert [piece.data for piece in received] == [b"scan", b"scan"]
    for each in (board, computer):
        each.close()

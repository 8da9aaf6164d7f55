"""Listening in: everything that goes in and out reaches the callback, and the transport behaves as without it."""

from waiting import FakeClock, until

from drawbar.transports.address import UdpAddress
from drawbar.transports.base import Received
from drawbar.transports.tapped import Direction, TappedTransport
from drawbar.transports.udp import UdpTransport


def test_bytes_in_and_out_reach_the_tap() -> None:
    board = UdpTransport(UdpAddress(host="127.0.0.1", port=0))
    heard: list[tuple[Direction, Received]] = []
    inner = UdpTransport(UdpAddress(host="127.0.0.1", port=0, peer=("127.0.0.1", board.port)))
    tapped = TappedTransport(inner, lambda direction, piece: heard.append((direction, piece)), FakeClock(7.0))
    assert tapped.connected
    assert tapped.fileno() == inner.fileno()
    assert tapped.write(b"out")
    board.write_to(b"in", ("127.0.0.1", inner.port))
    pieces = until(tapped.read)
    assert not tapped.write(bytes(70000))
    assert heard == [
        (Direction.OUT, Received(7.0, b"out")),
        (Direction.IN, pieces[0]),
        (Direction.UNSENT, Received(7.0, bytes(70000))),
    ]
    assert tapped.unsent == 70000
    assert "not sent" in tapped.trouble
    tapped.close()
    board.close()
    assert not tapped.connected

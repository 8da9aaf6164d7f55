"""Listening in: everything that goes in and out reaches the callback, and the transport behaves as without it."""

from waiting import FakeClock, until

from drawbar.transports.address import UdpAddress
from drawbar.transports.base import CanFrame, Received
from drawbar.transports.open import open_can
from drawbar.transports.tapped import Direction, TappedCanBus, TappedTransport
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


def test_frames_in_and_out_reach_the_tap() -> None:
    heard: list[tuple[Direction, float, CanFrame]] = []
    bus, other = open_can("can:virtual:tapped"), open_can("can:virtual:tapped")
    tapped = TappedCanBus(bus, lambda *all: heard.append(all), FakeClock(7.0))
    frame = CanFrame(0x18EEFF1C, b"\x01")
    assert tapped.write(frame)
    other.write(frame)
    ((moment, seen),) = until(tapped.read)
    tapped.close()
    assert not tapped.write(frame)
    assert seen == frame
    assert heard == [
        (Direction.OUT, 7.0, frame),
        (Direction.IN, moment, frame),
        (Direction.UNSENT, 7.0, frame),
    ]
    assert tapped.fileno() == -1
    other.close()

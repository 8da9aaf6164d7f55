"""Forwarding: unchanged to streams, in small pieces with pauses to boards; a jam is bounded and counted."""

import os
import pty
import tty
from itertools import pairwise
from random import Random

import pytest
from caster_bench import FAST, LOGIN
from waiting import until

from drawbar.machine.hardware.corrections.corrections import open_corrections
from drawbar.machine.hardware.corrections.forwarding import PacedOutlet, StreamOutlet
from drawbar.machine.hardware.corrections.settings import CorrectionsSettings
from drawbar.machine.stand_in.caster import Caster, CasterSettings
from drawbar.transports.address import SerialAddress, UdpAddress
from drawbar.transports.serial import SerialTransport
from drawbar.transports.udp import UdpTransport


def board_and_outlet() -> tuple[UdpTransport, PacedOutlet]:
    board = UdpTransport(UdpAddress(host="127.0.0.1", port=0))
    return board, PacedOutlet(UdpTransport(UdpAddress(host="127.0.0.1", port=0, peer=("127.0.0.1", board.port))))


def test_boards_get_every_byte_in_pieces_they_can_hold() -> None:
    board, outlet = board_and_outlet()
    data = Random(0).randbytes(1000)
    sent_at = []
    received: list[bytes] = []
    for tick in range(200):
        now = 0.001 * tick
        outlet.advance(now, data if tick == 0 else b"")
        found = [piece.data for piece in board.read()]
        sent_at += [now] * len(found)
        received += found
    assert b"".join(received) == data
    assert [len(piece) for piece in received] == [256, 256, 256, 232]
    assert all(later - earlier >= 0.02 - 1e-9 for earlier, later in pairwise(sent_at))
    assert sent_at[0] == 0.0
    outlet.transport.close()
    board.close()


def test_jam_drops_the_oldest_bytes_and_counts_them() -> None:
    board, outlet = board_and_outlet()
    outlet.advance(0.0, bytes(8192) + b"new")
    assert outlet.dropped["bytes"] == 3
    received = bytearray()
    for tick in range(100):
        outlet.advance(0.02 * tick, b"")
        received += b"".join(piece.data for piece in board.read())
    assert len(received) == 8192
    assert received.endswith(b"new")
    outlet.transport.close()
    board.close()


def test_serial_line_gets_the_bytes_at_once_and_unchanged() -> None:
    far, near = pty.openpty()
    tty.setraw(far)
    tty.setraw(near)
    outlet = StreamOutlet(SerialTransport(SerialAddress(device=os.ttyname(near), baud=115200)))
    data = Random(1).randbytes(700)
    outlet.advance(0.0, data)
    outlet.advance(0.0, b"")
    came = bytearray()
    until(lambda: came.extend(os.read(far, 1000)) or len(came) >= len(data))  # type: ignore[func-returns-value]
    assert came == data
    outlet.transport.close()
    os.close(far)
    os.close(near)


def test_section_of_a_configuration_feeds_a_board(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CASTER", LOGIN)
    board = UdpTransport(UdpAddress(host="127.0.0.1", port=0))
    with Caster(CasterSettings(login=LOGIN, interval=FAST)) as caster:
        settings = CorrectionsSettings(
            host="127.0.0.1",
            port=caster.port,
            mount="MP1",
            credentials="environment:CASTER",
            forward=(f"udp://127.0.0.1:0?peer=127.0.0.1:{board.port}",),
        )
        corrections = open_corrections(settings)
        now, returned, received = 0.0, bytearray(), bytearray()

        def fed() -> bool:
            nonlocal now
            now += 0.02
            returned.extend(corrections.advance(now))
            received.extend(b"".join(piece.data for piece in board.read()))
            return len(received) > 300

        until(fed)
        corrections.close()
    assert returned.startswith(received)
    board.close()

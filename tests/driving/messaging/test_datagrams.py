"""Datagrams to recorder and console: what goes in comes out, and what is none is refused."""

import pytest

from drawbar.driving.messaging.datagrams import CorrectionsFailure, EstimateDeviations, PackedStep, pack, unpack
from drawbar.recording.drive_records import Happening, Kind, Order, RawBytes
from drawbar.transports.tapped import Direction


@pytest.mark.parametrize(
    "datagram",
    [
        RawBytes(time=5, device="trailer_receiver", direction=Direction.UNSENT, data=b"\x00\xff$GGA"),
        RawBytes(time=6, device="sensors", direction=Direction.IN, data=b"", source="192.168.5.126:5120"),
        Order((Happening(kind=Kind.LOOK, time=1), Happening(kind=Kind.FIXES, time=2**45, sequence=2**32 - 1))),
        PackedStep(time=2**40, data=b'{"step":1}'),
        EstimateDeviations({"tractor_slip": 0.015625}),
        CorrectionsFailure("the caster sends \u201enothing\u201c; check devices.corrections.mount"),
        CorrectionsFailure(""),
    ],
)
def test_datagrams_arrive_as_they_were_sent(datagram):
    assert unpack(pack(datagram)) == datagram


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"DBr\0",
        b"DBs\0" + bytes(7),
        b"DBo\0",
        b"DBo\0" + bytes(14),
        b"DBv\0[1]",
        b"DBc\0\xff",
        b"DBr\0" + bytes(8) + b"\xff\x00",
        b"x" * 40,
    ],
)
def test_what_is_no_datagram_is_none(data):
    assert unpack(data) is None

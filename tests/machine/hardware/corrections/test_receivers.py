"""Corrections between a caster and receivers: what the caster is given of the receiver's position."""

import math
from types import SimpleNamespace

import pytest

from drawbar.machine.hardware.corrections.receivers import correct
from drawbar.protocols.ntrip import upload_of
from drawbar.signals import FixQuality


@pytest.mark.parametrize("hdop", [0.8, 9999.9, -0.01, math.nan])
@pytest.mark.parametrize("height", [120.0, 2e6, math.nan])
def test_whatever_a_receiver_reports_of_its_fix_the_caster_gets_a_position(hdop: float, height: float) -> None:
    epoch = SimpleNamespace(
        has_fix=True,
        utc=86399.9,
        latitude=51.5,
        longitude=-0.1,
        reported=FixQuality.FIXED,
        satellites=None,
        hdop=hdop,
        height=height,
    )
    positions: list[bytes] = []
    corrections = SimpleNamespace(position=positions.append, advance=lambda now: b"corrections")
    written: list[bytes] = []
    receiver = SimpleNamespace(last=epoch, transport=SimpleNamespace(write=written.append))
    correct(corrections, 1.0, receiver, [receiver])  # type: ignore[arg-type]
    assert [bool(upload_of(each)) for each in positions] == [True]
    assert written == [b"corrections"]

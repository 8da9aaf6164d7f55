"""Corrections between a caster and receivers: a position for the caster, its stream for the receivers."""

import math
from collections.abc import Iterable

from drawbar.machine.hardware.corrections.corrections import Corrections
from drawbar.machine.hardware.receiver import Receiver
from drawbar.protocols.ntrip import gga_sentence
from drawbar.signals import FixQuality

_GGA = {FixQuality.DIFFERENTIAL: 2, FixQuality.FIXED: 4, FixQuality.FLOAT: 5}
"""quality in a GGA sentence"""
_LARGEST_DILUTION, _HIGHEST = 100.0, 1e4
"""what a receiver may report beyond, 9999.9 for instance, casters do not need to know; m"""


def correct(corrections: Corrections, now: float, place: Receiver, receivers: Iterable[Receiver]) -> None:
    """Give the caster the position of one receiver, and receivers what it has sent; now: monotonic, s."""
    epoch = place.last
    if epoch is not None and epoch.has_fix:
        sentence = gga_sentence(
            time_of_day=epoch.utc % 86400.0,
            latitude=math.radians(epoch.latitude),
            longitude=math.radians(epoch.longitude),
            quality=_GGA.get(epoch.reported, 1),
            satellites=epoch.satellites or 12,
            dilution=epoch.hdop if 0.0 <= epoch.hdop < _LARGEST_DILUTION else 1.0,
            height=epoch.height if abs(epoch.height) < _HIGHEST else 0.0,
            separation=0.0,
        )
        corrections.position(sentence)
    data = corrections.advance(now)
    if data:
        for receiver in receivers:
            receiver.transport.write(data)

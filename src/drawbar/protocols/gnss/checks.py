"""Checks of a receiver before anything is driven by it: results in words, never silent."""

from drawbar.protocols.gnss.epoch import Epoch

COARSEST = 1e-6 / 60.0
"""degrees: 6 decimals of minutes, 1.9 mm"""


def resolution(epoch: Epoch) -> str:
    """Return why an epoch's position has too few digits to drive by, empty where it has enough."""
    if not epoch.has_fix or epoch.resolution <= COARSEST * 1.001:
        return ""
    return (
        f"positions come in steps of {epoch.resolution * 111e3:.2g} m; at most 2 mm are allowed: set the receiver to "
        f"at least 6 decimals of minutes in NMEA sentences, or to NAV-HPPOSLLH in addition to NAV-PVT"
    )

"""Checks of a receiver before anything is driven by it: results in words, never silent."""

from drawbar.protocols.gnss.epoch import Epoch

COARSEST = 1e-6 / 60.0
"""degrees: 6 decimals of minutes, 1.9 mm"""
_ENOUGH = 0.95
"""of the epochs that the controller takes"""


def resolution(epoch: Epoch) -> str:
    """Return why an epoch's position has too few digits to drive by, empty where it has enough."""
    if not epoch.has_fix or epoch.resolution <= COARSEST * 1.001:
        return ""
    return (
        f"positions come in steps of {epoch.resolution * 111e3:.2g} m; at most 2 mm are allowed: set the receiver to "
        f"at least 6 decimals of minutes in NMEA sentences, or to NAV-HPPOSLLH in addition to NAV-PVT"
    )


def too_slow(rate: float, sample_time: float) -> str:
    """Return why epochs at a rate, Hz, are too few for a controller's sample time, s; empty where they are enough."""
    if not rate < _ENOUGH / sample_time:
        return ""
    needed = f"{1.0 / sample_time:g}"
    return f"it sends {rate:.1f} epochs a second, the controller takes {needed}: set it to {needed} Hz"

"""Two antennas: whether the yaw that they measure on the tractor is plausible, or their line is stated wrongly."""

import math

import numpy as np

from drawbar.estimation.alignment import YAW_GATE
from drawbar.geometry import wrap
from drawbar.recording.log import Columns


def yaw_difference(log: Columns) -> float:
    """Return by how much the measured yaw is left of the estimated one, rad, median; NaN where none is measured."""
    measured, estimated = log.column("measurement.tractor_yaw"), log.column("estimate.tractor.yaw")
    turned = np.exp(1j * (measured - estimated))
    turned = turned[np.isfinite(turned)]
    if not turned.size:
        return math.nan
    middle = turned.sum()
    return wrap(float(np.angle(middle) + np.median(np.angle(turned * np.conj(middle)))))


def yaw_text(difference: float) -> str:
    """Return a sentence about a difference, rad; empty where it is small enough to be corrected for."""
    if not abs(difference) > YAW_GATE:
        return ""
    return (
        f"the yaw of the tractor's two antennas is {math.degrees(difference):+.1f}° from the "
        f"estimated one, median; beyond {math.degrees(YAW_GATE):.1f}° it is not believed: if the machine is real, add "
        f"{difference:+.4f} to devices.tractor_receiver.antennas.line"
    )

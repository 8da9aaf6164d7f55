"""Columns of a log, as arrays: what both bodies did, step by step; the truth, or the next best on a real machine."""

import numpy as np
from numpy.typing import NDArray

from drawbar.geometry import Floats
from drawbar.recording.log import Columns
from drawbar.signals import Flag, Status

_IDLE = [status for status in Status if status in (Status.POSITION, Status.START) or status.has_ended]
"""what a step is before a run has begun, and once it has ended"""


def along(log: Columns, body: str) -> Floats:
    """Return where a body is along the path, as the controller saw it, (n,) in m."""
    return log.column(f"reference.{body}.progress")


def estimated(log: Columns) -> NDArray[np.bool_]:
    """Return at which steps there was something to estimate and to solve, (n,)."""
    return np.isfinite(log.column("estimate.tractor.yaw"))


def engaged(log: Columns) -> NDArray[np.bool_]:
    """Return at which steps the autopilot steered and did not look on, (n,)."""
    released = (log.column("flags").astype(int) & Flag.RELEASED) != 0
    steers: NDArray[np.bool_] = ~released & ~np.isin(log.column("status"), _IDLE)
    return steers


def track(log: Columns, body: str) -> Floats:
    """Return where a body's point on the ground was, (n, 2) in m: the truth, or the estimate."""
    source = "truth" if log.has_truth else "estimate"
    return np.column_stack([log.column(f"{source}.{body}.{coordinate}") for coordinate in "xy"])


def actual_steering(log: Columns, body: str) -> Floats:
    """Return a body's steering, (n,) in rad: the truth, or what the sensor said."""
    source = "truth" if log.has_truth else "measurement"
    return log.column(f"{source}.{body}_steering")

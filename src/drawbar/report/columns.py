"""Columns of a log, as arrays: what both bodies did, step by step; the truth, or the next best on a real machine."""

import numpy as np
from numpy.typing import NDArray

from drawbar.geometry import Floats
from drawbar.recording.log import Columns
from drawbar.signals import Flag, Status

_WAITS = (Status.POSITION, Status.START)
"""what a step is that no run has begun with"""


def along(log: Columns, body: str) -> Floats:
    """Return where a body is along the path, as the controller saw it, (n,) in m."""
    return log.column(f"reference.{body}.progress")


def begun(log: Columns) -> NDArray[np.bool_]:
    """Return at which steps a run was on, (n,); before, nothing is estimated or solved."""
    return ~np.isin(log.column("status"), _WAITS)


def engaged(log: Columns) -> NDArray[np.bool_]:
    """Return at which steps the autopilot steered and did not look on, (n,)."""
    released = (log.column("flags").astype(int) & Flag.RELEASED) != 0
    steers: NDArray[np.bool_] = begun(log) & ~released
    return steers


def track(log: Columns, body: str) -> Floats:
    """Return where a body's point on the ground was, (n, 2) in m: the truth, or the estimate."""
    source = "truth" if log.has_truth else "estimate"
    return np.column_stack([log.column(f"{source}.{body}.{coordinate}") for coordinate in "xy"])


def actual_steering(log: Columns, body: str) -> Floats:
    """Return a body's steering, (n,) in rad: the truth, or what the sensor said."""
    source = "truth" if log.has_truth else "measurement"
    return log.column(f"{source}.{body}_steering")

"""Columns of a log, as arrays: what both bodies did, step by step; the truth, or the next best on a real machine."""

import numpy as np
from numpy.typing import NDArray

from drawbar.geometry import Floats
from drawbar.recording.log import Columns
from drawbar.signals import Flag, Status

_IDLE = [status for status in Status if status in (Status.POSITION, Status.START) or status.has_ended]
"""what a step is before a run has begun, and once it has ended"""

_BACK = 1.0
"""m; a way back along the path that is less is the noise of one that stands"""


def along(log: Columns, body: str) -> Floats:
    """Return where a body is along the path, as the controller saw it, (n,) in m."""
    return log.column(f"reference.{body}.progress")


def span_along(log: Columns) -> tuple[float, float]:
    """Return from where to where along the path the tractor was, m; (0, 1) where that is not known."""
    progress = along(log, "tractor")
    known = progress[np.isfinite(progress)]
    return (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)


def leads_on(log: Columns) -> bool:
    """Return whether the tractor went along the path, and nowhere back: then curves over it can be read."""
    progress = along(log, "tractor")
    known = progress[np.isfinite(progress)]
    if not known.size:
        return True
    back = float((np.maximum.accumulate(known) - known).max())
    return back < _BACK < float(np.ptp(known))


def estimated(log: Columns) -> NDArray[np.bool_]:
    """Return at which steps there was something to estimate and to solve, (n,)."""
    return np.isfinite(log.column("estimate.tractor.yaw"))


def engaged(log: Columns) -> NDArray[np.bool_]:
    """Return at which steps the autopilot steered and did not look on, (n,)."""
    released = (log.column("flags").astype(int) & Flag.RELEASED) != 0
    steers: NDArray[np.bool_] = ~released & ~np.isin(log.column("status"), _IDLE)
    return steers


def track(log: Columns, body: str) -> Floats:
    """Return where a body's tracked point on the ground was, (n, 2) in m: the truth, or the estimate."""
    return track_of(log, body, "truth" if log.has_truth else "estimate")


def track_of(log: Columns, body: str, source: str) -> Floats:
    """Return where a body's tracked point on the ground was, (n, 2) in m, by `truth` or `estimate`."""
    x, y, yaw = (log.column(f"{source}.{body}.{name}") for name in ("x", "y", "yaw"))
    forward, left = getattr(log.header.vehicle.tracked, body).arm
    if forward or left:
        x, y = x + forward * np.cos(yaw) - left * np.sin(yaw), y + forward * np.sin(yaw) + left * np.cos(yaw)
    return np.column_stack([x, y])


def line_points(log: Columns, body: str) -> Floats:
    """Return the points of the line beside a body's tracked point, (n, 2) in m; NaN where they are not known.

    Those of logs of drawbars that did not record them for a tool are of the body's own line.
    """
    # with a tool, `closest` is of the body's own line, which leads the tool
    names = ("line_x", "line_y") if any(getattr(log.header.vehicle.tracked, body).arm) else ("closest.0", "closest.1")
    return np.column_stack([log.column(f"reference.{body}.{name}") for name in names])


def actual_steering(log: Columns, body: str) -> Floats:
    """Return a body's steering, (n,) in rad: the truth, or what the sensor measured."""
    source = "truth" if log.has_truth else "measurement"
    return log.column(f"{source}.{body}_steering")

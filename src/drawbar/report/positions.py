"""Positions: what fixes show of an estimate's own error, which is in no estimated distance from the path.

- A fix lies beside the estimate for seconds on end: delays, play or a yaw rate that the estimator is not told of.
- The fixes of an antenna are rejected: they, or a stated length, are wrong.
- Both bodies side-slip by the same angle whichever way they face: no slope does that, but antennas that stand further
  aside than stated.
"""

import math

import numpy as np

from drawbar.geometry import GRAVITY, Floats
from drawbar.recording.log import Columns
from drawbar.report.columns import engaged
from drawbar.report.path_errors import Bodies
from drawbar.signals import FixStatus
from drawbar.vehicle.parameters import BODIES

_SPAN = 2.0
"""over which residuals are averaged, s"""
_RESIDUAL = 0.02
"""root mean square of the averages that is reported, m; on sound machines it is below 0.01"""
_REJECTED = 0.2
"""share of an antenna's fixes that is reported"""
_ASIDE = 0.05
"""m by which antennas stand aside that is reported"""
_INFLATION = 3.0
"""of the variance of a side-slip that is the same in all headings, by headings that hardly differ, at most"""
_CONDITION = 1e9
"""of the normal equations, beyond which nothing is told apart"""
_MOVES = 0.1
"""speed from which on a vehicle shows its side-slip, m/s"""


def lasting_residual(log: Columns, body: str) -> float:
    """Return how far accepted fixes lay beside the estimate, averaged over seconds, root mean square, m; NaN: none."""
    times, residuals = _residuals(log, body)
    if residuals.size < 2:
        return math.nan
    width = min(max(round(_SPAN / float(np.median(np.diff(times)))), 1), residuals.size)
    sums = np.concatenate([[0.0], np.cumsum(residuals)])
    return float(np.sqrt(np.mean(((sums[width:] - sums[:-width]) / width) ** 2)))


def rejected_share(log: Columns, body: str) -> float:
    """Return which share of an antenna's new fixes was rejected; NaN where there were none."""
    found = log.column(f"estimate.{body}_fix")[engaged(log)]
    rejected, accepted = (int((found == each).sum()) for each in (FixStatus.REJECTED, FixStatus.ACCEPTED))
    return rejected / (rejected + accepted) if rejected + accepted else math.nan


def antennas_aside(log: Columns) -> float:
    """Return how much further to the left of the trailer's antenna the tractor's stands than stated, m.

    NaN where the headings do not tell that from a slope.
    """
    vehicle = log.header.vehicle
    masts, apart = vehicle.masts, vehicle.hitch_length + vehicle.trailer_length - vehicle.trailer_antenna
    return -math.tan(_common_slip(log)) * (apart + masts.tractor.forward - masts.trailer.forward)


def position_texts(residual: Bodies[float], rejected: Bodies[float], aside: float) -> list[str]:
    """Return sentences about residuals, m, shares and antennas, m, that are to be reported."""
    lasting = [f"{body} {100.0 * of:.0f} cm" for body in BODIES if (of := getattr(residual, body)) > _RESIDUAL]
    texts = [
        f"{100.0 * of:.0f} % of the {body}'s positions were rejected: its antenna, or a stated length, is wrong"
        for body in BODIES
        if (of := getattr(rejected, body)) > _REJECTED
    ]
    if lasting:
        texts.append(
            f"for seconds on end positions lay beside the estimate ({', '.join(lasting)}, root mean square): "
            "estimated errors are too small by as much"
        )
    if abs(aside) > _ASIDE:
        texts.append(
            f"both bodies side-slip alike whichever way they face: across the vehicle the tractor's antenna stands "
            f"{100.0 * abs(aside):.0f} cm further to the {'left' if aside > 0.0 else 'right'} of the trailer's than "
            "stated (vehicle.masts), or a body leans unmeasured"
        )
    return texts


def _residuals(log: Columns, body: str) -> tuple[Floats, Floats]:
    """Return times, s, and how far the fix accepted then lay to the left of the estimate of its own time, m, (n,)."""
    time, yaw = log.column("measurement.time"), np.unwrap(log.column(f"estimate.{body}.yaw"))
    steps = np.flatnonzero(
        (log.column(f"estimate.{body}_fix") == FixStatus.ACCEPTED) & engaged(log) & np.isfinite(time + yaw)
    )
    if not steps.size:
        return time[steps], yaw[steps]
    ages = np.nan_to_num(log.column(f"measurement.{body}_fix_age")) + log.column("actuation.fix_latency")
    then = (time - ages)[steps]
    x, y, yaw = (
        np.interp(then, time[steps], of[steps]) for of in (*(log.column(f"estimate.{body}.{c}") for c in "xy"), yaw)
    )
    mast = getattr(log.header.vehicle.masts, body)
    if _lean_is_predicted(log, body):
        return time[:0], yaw[:0]
    attitudes = zip(
        yaw, *(log.column(f"measurement.{body}_{angle}")[steps] for angle in ("roll", "pitch")), strict=True
    )
    east, north = np.array([mast.measured_offset(*each) for each in attitudes]).reshape(-1, 2).T
    fix_x, fix_y = (log.column(f"measurement.{body}_{c}")[steps] for c in "xy")
    left: Floats = (fix_y - north - y) * np.cos(yaw) - (fix_x - east - x) * np.sin(yaw)
    return time[steps][np.isfinite(left)], left[np.isfinite(left)]


def _lean_is_predicted(log: Columns, body: str) -> bool:
    """Return whether the estimator takes the roll from the ground that the other body has recorded.

    The log does not hold how much that made a mast lean.
    """
    measured = {each: bool(np.isfinite(log.column(f"measurement.{each}_roll")).any()) for each in BODIES}
    return getattr(log.header.vehicle.masts, body).up > 0.0 and not measured[body] and any(measured.values())


def _common_slip(log: Columns) -> float:
    """Return the side-slip of both axles that is the same in all headings, rad: neither of a slope, nor of curves."""
    known = engaged(log) & (np.abs(log.column("estimate.speed")) > _MOVES)
    for body in BODIES:
        known &= (log.column(f"estimate.{body}_fix") == FixStatus.ACCEPTED) & np.isfinite(
            log.column(f"estimate.{body}_crab")
        )
    if known.sum() < 2:
        return math.nan
    rows, slips = [], []
    for body in BODIES:
        yaw = np.unwrap(log.column(f"estimate.{body}.yaw")[known])
        turns = log.column("estimate.speed")[known] * np.gradient(yaw, log.column("measurement.time")[known]) / GRAVITY
        rows.append(np.column_stack([np.ones_like(yaw), -np.sin(yaw), np.cos(yaw), -turns]))
        slips.append(log.column(f"estimate.{body}_crab")[known])
    regressors = np.concatenate(rows)
    normal = regressors.T @ regressors / len(regressors)
    if np.linalg.cond(normal) > _CONDITION or np.linalg.inv(normal)[0, 0] > _INFLATION:
        return math.nan
    return float(np.linalg.lstsq(regressors, np.concatenate(slips), rcond=None)[0][0])

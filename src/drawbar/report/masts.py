"""Masts: by how much they may mislead where no attitude sensor measures how the bodies lean."""

import math

import numpy as np

from drawbar.geometry import Floats
from drawbar.recording.log import Columns
from drawbar.vehicle.parameters import BODIES, VehicleParameters

SOFT = 0.36
"""Side-slip per angle of a slope on soft soil, which the estimated side-slips are taken for; on firm soil the slope is
steeper than that suggests"""
_NOTED = 2.0
"""Standard deviations that an offset has to be away from what is stated to be reported"""
_TURNED = 0.3
"""Standard deviation of the headings' cosines and sines from which on the world's part of the side-slips shows"""
_LEAST = 0.3
"""Smallest share of a side-slip that is taken to show behind masts of different heights"""


def mast_doubt(log: Columns, body: str) -> float:
    """Return by how much the point on the ground may be beside where the antenna puts it, m, root mean square.

    It is the height of the mast times the slope that the estimated side-slips suggest; 0 where the lean was
    measured, or predicted from the tractor's, and where the mast has no height; NaN where no side-slip was estimated.
    """
    vehicle = log.header.vehicle
    height: float = getattr(vehicle.masts, body).up
    if height == 0.0 or any(_measured(log, each) for each in {"tractor", body}):
        return 0.0
    slope = _side_slip(log) / (SOFT * _shown(vehicle))
    return height * math.sin(min(slope, 0.5 * math.pi))


def doubt_text(tractor: float, trailer: float) -> str:
    """Return sentences about the doubts of both bodies, m; empty where there are none."""
    doubts = {"tractor": tractor, "trailer": trailer}
    told = [f"{body} {100.0 * doubt:.0f} cm" for body, doubt in doubts.items() if doubt > 0.0]
    return f"without an attitude sensor the masts may mislead: {', '.join(told)}" if told else ""


def mounting_text(log: Columns, body: str) -> str:
    """Return what was found of how a roll sensor is mounted; empty where it may as well be as stated."""
    steps = (log.column(f"actuation.{body}_roll_{name}")[-1:] for name in ("offset", "deviation"))
    offset, deviation = (math.degrees(last[0]) if last.size else math.nan for last in steps)
    if not abs(offset) > _NOTED * deviation:
        return ""
    mast = f"vehicle.masts.{body}"
    stated = math.degrees(getattr(log.header.vehicle.masts, body).roll_offset)
    return (
        f"the {body}'s roll sensor shows {stated + offset:.1f}° ± {deviation:.1f}° while it stands level, which is "
        f"corrected for; {mast}.roll_offset = {math.radians(stated + offset):.4f} and {mast}.roll_deviation = "
        f"{math.radians(deviation):.4f} let the next run begin with it"
    )


def _measured(log: Columns, body: str) -> bool:
    return bool(np.isfinite(log.column(f"measurement.{body}_roll")).any())


def _shown(vehicle: VehicleParameters) -> float:
    """Return which share of a side-slip shows: masts of different heights lean apart, which turns the line of both."""
    masts, apart = vehicle.masts, vehicle.hitch_length + vehicle.trailer_length - vehicle.trailer_antenna
    return max(1.0 - (masts.tractor.up - masts.trailer.up) / (apart * SOFT), _LEAST)


def _side_slip(log: Columns) -> float:
    """Return the root mean square of the side-slips, rad: of what is the same in the world, if that shows."""
    bodies = [_seen(log, body) for body in BODIES]
    yaw, crab = np.concatenate([yaw for yaw, _ in bodies]), np.concatenate([crab for _, crab in bodies])
    if not crab.size:
        return math.nan
    rows = np.column_stack([-np.sin(yaw), np.cos(yaw), np.ones_like(yaw)])
    if min(rows[:, :2].std(axis=0)) < _TURNED:
        return float(np.sqrt(np.mean(crab**2)))
    east, north, _ = np.linalg.lstsq(rows, crab, rcond=None)[0]
    return math.hypot(east, north) / math.sqrt(2.0)


def _seen(log: Columns, body: str) -> tuple[Floats, Floats]:
    """Return yaws and side-slips (n,) of one body, without what is missing, rad."""
    yaw, crab = log.column(f"estimate.{body}.yaw"), log.column(f"estimate.{body}_crab")
    known = np.isfinite(yaw + crab)
    return yaw[known], crab[known]

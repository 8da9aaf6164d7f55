"""By how much masts may mislead where no attitude sensor tells how the bodies lean."""

import math

import numpy as np

from drawbar.recording.log import Columns

SOFT = 0.18
"""Estimated side-slip per angle of a slope on soft soil. The true one is 0.36; leaning masts hide half of it, as seen
in the simulated machine (tests/report/test_masts.py). On firm soil the slope is steeper than that suggests."""


def mast_doubt(log: Columns, body: str) -> float:
    """Return by how much the point on the ground may be beside where the antenna puts it, m, root mean square.

    It is the height of the mast times the slope that the estimated side-slip suggests. NaN where the lean was measured,
    or predicted from the tractor's, and where the mast has no height.
    """
    height = getattr(log.header.vehicle.masts, body).up
    if height == 0.0 or any(_measured(log, each) for each in {"tractor", body}):
        return math.nan
    crabs = np.array([log.column(f"estimate.{each}_crab") for each in ("tractor", "trailer")])
    present = crabs[np.isfinite(crabs)]
    if not present.size:
        return math.nan
    return float(height * math.sin(min(math.sqrt(np.mean(present**2)) / SOFT, 0.5 * math.pi)))


def doubt_text(tractor: float, trailer: float) -> str:
    """Return what there is to say of the doubts of both bodies, m; empty where there is nothing."""
    doubts = {"tractor": tractor, "trailer": trailer}
    told = [f"{body} {100.0 * doubt:.0f} cm" for body, doubt in doubts.items() if math.isfinite(doubt)]
    return f"without an attitude sensor the masts may mislead: {', '.join(told)}" if told else ""


def _measured(log: Columns, body: str) -> bool:
    return bool(np.isfinite(log.column(f"measurement.{body}_roll")).any())

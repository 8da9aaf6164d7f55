"""Distances: figures of one body's signed distance from the path over a run, cm, and those on its straights."""

import numpy as np

from drawbar.experiment.task import Result
from drawbar.geometry import Floats

BEGINS = 5.0
"""way along the path, and along a straight, that is left out at its start, m"""
_LEAST = 5
"""samples of a straight that have a standard deviation"""


def distance_figures(result: Result, body: str) -> dict[str, float]:
    """Return the figures of a body, by name.

    "mean", "95 %" and "largest" of the distance, "SD" of the signed distance, all after the first `BEGINS`; "straight
    SD", that of all straights together, and "each straight SD", of every straight by itself after its first `BEGINS`,
    the root of the mean of the squares. NaN where there are no samples.

    Args:
        result: with the columns `error.BODY`, m, `progress.BODY`, m, and `reference.BODY.closest.3`, curvature, 1/m.
        body: "tractor" or "trailer".
    """
    error, progress = 100.0 * result.columns[f"error.{body}"], result.columns[f"progress.{body}"]
    begun = progress - np.nanmin(progress) > BEGINS
    straight = begun & (result.columns[f"reference.{body}.closest.3"] == 0.0)
    whole, size = error[begun], np.abs(error[begun])
    return {
        f"{body} mean": float(size.mean()) if size.size else np.nan,
        f"{body} SD": _deviation(whole),
        f"{body} 95 %": float(np.percentile(size, 95.0)) if size.size else np.nan,
        f"{body} largest": float(size.max()) if size.size else np.nan,
        f"{body} straight SD": _deviation(error[straight]),
        f"{body} each straight SD": _each(error, progress, straight),
    }


def _deviation(error: Floats) -> float:
    return float(error.std()) if error.size else np.nan


def _each(error: Floats, progress: Floats, straight: Floats) -> float:
    """Return the root mean square of the standard deviations of all straights."""
    steps = np.flatnonzero(straight)
    straights = np.split(steps, np.flatnonzero(np.diff(steps) > 1) + 1)
    settled = [error[each[progress[each] - progress[each[0]] > BEGINS]] for each in straights if each.size]
    deviations = [each.std() for each in settled if each.size >= _LEAST]
    return float(np.sqrt(np.mean(np.square(deviations)))) if deviations else np.nan

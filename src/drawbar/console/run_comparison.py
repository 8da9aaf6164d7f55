"""Comparison: the figures of two runs side by side, from their metrics.json."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import reduce
from pathlib import Path
from typing import Any

METRICS = "metrics.json"


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """One row."""

    text: str
    """key of its name in the catalogue"""
    path: str
    """in metrics.json"""
    unit: str
    factor: float = 1.0
    decimals: int = 1
    body: str = ""
    """key of the body's name in the catalogue, where the figure is of one"""


def _of_bodies(text: str, path: str, unit: str, factor: float, decimals: int = 1) -> tuple[Figure, Figure]:
    return tuple(  # type: ignore[return-value]
        Figure(text=text, path=path.format(body=body), unit=unit, factor=factor, decimals=decimals, body=body)
        for body in ("tractor", "trailer")
    )


FIGURES = (
    Figure(text="duration", path="duration_s", unit="s", decimals=0),
    Figure(text="driven_length", path="length_m", unit="m", decimals=0),
    *_of_bodies("error_mean", "error_m.{body}.all.mean", "cm", 100.0),
    *_of_bodies("error_rms", "error_m.{body}.all.rms", "cm", 100.0),
    *_of_bodies("error_p95", "error_m.{body}.all.p95", "cm", 100.0),
    *_of_bodies("error_max", "error_m.{body}.all.max", "cm", 100.0),
    *_of_bodies("steering_effort", "steering_rate_mean_rad_s.{body}", "°/s", math.degrees(1.0)),
    *_of_bodies("tube_margin", "tube_margin_min.{body}", "%", 100.0, 0),
    Figure(text="rejected_fixes", path="rejected_fixes", unit="", decimals=0),
    Figure(text="solver_failures", path="solver_failures", unit="", decimals=0),
    Figure(text="refused_commands", path="refused_commands", unit="", decimals=0),
    Figure(text="estimator_time", path="solve_time_s.estimator.feedback.p99", unit="µs", factor=1e6, decimals=0),
)


def read_metrics(folder: Path) -> Mapping[str, Any] | None:
    """Return the figures of a run's folder; None: there are none, or they cannot be read."""
    try:
        found = json.loads((folder / METRICS).read_text("utf-8"))
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) else None


def value_of(figure: Figure, metrics: Mapping[str, Any]) -> float:
    """Return a figure in its unit; NaN: it is missing."""
    try:
        found = reduce(lambda section, key: section[key], figure.path.split("."), metrics)
    except (KeyError, TypeError):
        return math.nan
    return figure.factor * found if isinstance(found, int | float) else math.nan

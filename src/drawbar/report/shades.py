"""Shades: the classes of the path in figures along it; shaded stretches, and what they are called."""

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from drawbar.recording.path_table import PathTable
from drawbar.report import style

KINK = "kink"
"""class of a recorded line where it was tighter than the vehicle can turn"""
_SHADES = {KINK: style.KINK + "59"}
_SHADE = "#F1F3F6"
_MOST = 300
"""stretches that are shaded; of more, none is wider than a few pixels, and all together would weigh down the page"""
_LABELLED = 0.04
"""share of the path from which on a stretch has room for its label"""


class Stretch(NamedTuple):
    """A stretch of the path of one class, from arc length low to high, m."""

    label: str
    low: float
    high: float


def stretches(path: PathTable) -> list[Stretch]:
    """Return the stretches of the path that are not of its first class, in their order."""
    classes = path.label_of_piece
    changes = np.flatnonzero(np.diff(classes)) + 1
    nodes = [0, *changes.tolist(), len(classes)]
    return [
        Stretch(path.label_names[classes[start]], float(path.arc_length[start]), float(path.arc_length[end]))
        for start, end in pairwise(nodes)
        if classes[start] != 0
    ]


def class_shades(path: PathTable) -> dict[str, list[dict[str, Any]]]:
    """Return plotly shapes and labels: curvatures stand above their stretches, names in the legend."""
    shapes, labels = [], []
    in_legend = set[str]()
    found = stretches(path)
    if len(found) > _MOST:
        return {"shapes": [], "annotations": []}
    for stretch in found:
        named = not stretch.label[:1].isdigit()
        shapes.append(_shape(stretch, in_legend=named and stretch.label not in in_legend))
        in_legend.add(stretch.label)
        if not named and stretch.high - stretch.low >= _LABELLED * path.arc_length[-1]:
            labels.append(_label(stretch))
    return {"shapes": shapes, "annotations": labels}


def _shape(stretch: Stretch, *, in_legend: bool) -> dict[str, Any]:
    shape: dict[str, Any] = {"type": "rect", "xref": "x", "yref": "paper", "layer": "below", "line": {"width": 0}}
    shape |= {"x0": stretch.low, "x1": stretch.high, "y0": 0, "y1": 1}
    shape |= {"name": stretch.label.capitalize(), "legendgroup": stretch.label, "showlegend": in_legend}
    return shape | {"fillcolor": _SHADES.get(stretch.label, _SHADE)}


def _label(stretch: Stretch) -> dict[str, Any]:
    where = {"x": 0.5 * (stretch.low + stretch.high), "y": 1, "yref": "paper", "yanchor": "bottom"}
    return where | {"text": stretch.label, "showarrow": False, "font": {"size": 11, "color": style.REFERENCE}}

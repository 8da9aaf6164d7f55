"""The map of a run: the path, the tracks of both bodies, and what they looked like at a few moments."""

from typing import Any

import numpy as np

from drawbar.autopilot.log import RunLog
from drawbar.geometry import Floats
from drawbar.report import style
from drawbar.report.outline import tractor_outline, trailer_outline
from drawbar.report.style import Figure, axis, layout, line
from drawbar.signals import Pose, StepRecord

_OUTLINES = 12


def track(log: RunLog, body: str) -> Floats:
    """Return where a body's antenna was, (n, 2) in m: the truth, or the estimate on a real machine."""
    source = "estimate" if all(record.truth is None for record in log.records) else "truth"
    return np.column_stack([log.column(f"{source}.{body}.{coordinate}") for coordinate in "xy"])


def outlines(log: RunLog) -> tuple[Floats, Floats]:
    """Return the outlines of tractor and trailer at moments spread over the run, (n, 2) each in m."""
    steps = np.linspace(0, len(log.records) - 1, min(_OUTLINES, len(log.records))).round().astype(int)
    pairs = [_outline_pair(log, log.records[step]) for step in steps]
    tractors, trailers = zip(*pairs, strict=True) if pairs else ([np.empty((0, 2))], [np.empty((0, 2))])
    return np.vstack(tractors), np.vstack(trailers)


def _outline_pair(log: RunLog, record: StepRecord) -> tuple[Floats, Floats]:
    seen = record.truth or record.estimate
    tractor: Pose = seen.tractor
    vehicle = log.header.vehicle
    return tractor_outline(tractor, seen.tractor_steering, vehicle), trailer_outline(seen.trailer, vehicle)


def _track_trace(log: RunLog, body: str, colour: str) -> dict[str, Any]:
    points = track(log, body)
    hover = "%{x:.2f} m east, %{y:.2f} m north, at %{customdata:.1f} s"
    name = body.capitalize()
    return line(points[:, 0], points[:, 1], name, colour, meta="steps", hovertemplate=hover, width=1.8)


def _outline_trace(points: Floats, name: str, colour: str) -> dict[str, Any]:
    look = {"fill": "toself", "fillcolor": colour + "40", "width": 0.8, "hoverinfo": "skip"}
    return line(points[:, 0], points[:, 1], name, colour, showlegend=False, legendgroup="outlines", **look)


def map_figure(log: RunLog) -> Figure:
    """Draw the map, east to the right, both axes at the same scale; its last trace is the page's cursor."""
    path = log.header.path
    tractor, trailer = outlines(log)
    fixes = np.column_stack([log.column(f"measurement.tractor_{coordinate}") for coordinate in "xy"])
    fix_look = {"mode": "markers", "marker": {"size": 3, "color": style.REFERENCE}, "visible": "legendonly"}
    cursor = {
        "type": "scatter",
        "mode": "markers",
        "x": [],
        "y": [],
        "showlegend": False,
        "hoverinfo": "skip",
    }
    cursor["marker"] = {
        "size": 13,
        "color": list(style.BODY_COLOURS.values()),
        "line": {"color": "#FFF", "width": 2},
    }
    traces = [
        line(path.x, path.y, "Path", style.REFERENCE, width=5.0, opacity=0.35, hoverinfo="skip"),
        _track_trace(log, "trailer", style.TRAILER),
        _track_trace(log, "tractor", style.TRACTOR),
        _outline_trace(trailer, "Trailer", style.TRAILER),
        _outline_trace(tractor, "Tractor", style.TRACTOR),
        line(
            fixes[:, 0],
            fixes[:, 1],
            "GPS fixes of the tractor",
            style.REFERENCE,
            hoverinfo="skip",
            **fix_look,
        ),
        cursor,
    ]
    legend = {"x": 0.01, "y": 0.99, "yanchor": "top", "bgcolor": "rgba(255,255,255,0.85)"}
    east, north = axis("East, m", zeroline=False), axis("North, m", zeroline=False, scaleanchor="x")
    return {"data": traces, "layout": layout(east, north, hovermode="closest", dragmode="pan", legend=legend)}

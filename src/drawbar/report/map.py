"""The map of a run: the path, the tracks of both bodies, and what they looked like at a few moments."""

from typing import Any

import numpy as np

from drawbar.geometry import Floats
from drawbar.recording.log import Columns
from drawbar.recording.path_table import PathTable, RecordedPoints
from drawbar.report import style
from drawbar.report.columns import along, line_points, track
from drawbar.report.decimation import thinned
from drawbar.report.outline import tractor_outline, trailer_outline
from drawbar.report.shades import KINK, stretches
from drawbar.report.style import Figure, axis, layout, line
from drawbar.signals import Pose
from drawbar.vehicle.parameters import VehicleParameters

_OUTLINES = 12
"""at most so many of each body"""
_SPACING = 2.0
"""between two outlines along the track, in lengths of the vehicle"""
_BESIDE = 0.03
"""of the path, from which on a line is drawn by itself, m"""
_VERTICES = 4000
"""most vertices that draw a path: no screen shows more, and a page must stay light"""


def polyline(path: PathTable) -> Floats:
    """Return nodes that draw the path, (n, 2) in m: all of a short one, else most where it turns most."""
    nodes = np.column_stack([path.x, path.y])
    if len(nodes) <= _VERTICES:
        return nodes
    turned = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(path.yaw)))])
    detail = path.arc_length / path.arc_length[-1] + turned / max(turned[-1], 1.0)
    return nodes[np.unique(np.searchsorted(detail, np.linspace(0.0, detail[-1], _VERTICES)))]


def outlines(log: Columns) -> tuple[Floats, Floats]:
    """Return the outlines of tractor and trailer at moments spread over the run, (n, 2) each in m."""
    pairs = _outline_pairs(log, outlined_steps(log))
    tractors, trailers = zip(*pairs, strict=True) if pairs else ([np.empty((0, 2))], [np.empty((0, 2))])
    return np.vstack(tractors), np.vstack(trailers)


def outlined_steps(log: Columns) -> list[int]:
    """Return steps at equal distances along the tractor's track, the last one first."""
    if not log.steps:
        return []
    moved = np.hypot(*np.diff(track(log, "tractor"), axis=0).T)
    driven = np.concatenate([[0.0], np.cumsum(np.nan_to_num(moved))])
    count = 1 + int(driven[-1] / (_SPACING * _length(log.header.vehicle)))
    steps: list[int] = driven.searchsorted(np.linspace(driven[-1], 0.0, min(count, _OUTLINES))).tolist()
    return steps


def _length(vehicle: VehicleParameters) -> float:
    return vehicle.wheelbase + vehicle.hitch_length + vehicle.trailer_length


def _outline_pairs(log: Columns, steps: list[int]) -> list[tuple[Floats, Floats]]:
    seen, vehicle = "truth" if log.has_truth else "estimate", log.header.vehicle

    def poses(body: str) -> list[Pose]:
        columns = (log.column(f"{seen}.{body}.{name}")[steps].tolist() for name in ("x", "y", "yaw"))
        return [Pose(x=x, y=y, yaw=yaw) for x, y, yaw in zip(*columns, strict=True)]

    steerings = log.column(f"{seen}.tractor_steering")[steps].tolist()
    together = zip(poses("tractor"), steerings, poses("trailer"), strict=True)
    return [
        (tractor_outline(tractor, steering, vehicle), trailer_outline(trailer, vehicle))
        for tractor, steering, trailer in together
    ]


def _track_trace(log: Columns, body: str, colour: str, width: float) -> dict[str, Any]:
    points = track(log, body)[thinned(log.steps)]
    hover = "%{x:.2f} m east, %{y:.2f} m north, at %{customdata:.1f} s"
    name = body.capitalize()
    return line(points[:, 0], points[:, 1], name, colour, meta="steps", hovertemplate=hover, width=width)


def _outline_trace(points: Floats, name: str, colour: str) -> dict[str, Any]:
    look = {"fill": "toself", "fillcolor": colour + "40", "width": 0.8, "hoverinfo": "skip"}
    return line(points[:, 0], points[:, 1], name, colour, showlegend=False, legendgroup="outlines", **look)


def _marks(points: Floats, name: str, look: dict[str, Any], **options: Any) -> dict[str, Any]:
    """Return a trace of points (n, 2) in m that are not joined."""
    marks = line(points[:, 0], points[:, 1], name, look["color"], mode="markers", marker=look)
    return marks | {"hoverinfo": "skip"} | options


def _path_traces(path: PathTable) -> list[dict[str, Any]]:
    """Return the path as a wide line, and its kinks as a wider one that shows on the whole map."""
    look: dict[str, Any] = {"opacity": 0.35, "hoverinfo": "skip"}
    drawn = polyline(path)
    traces = [line(drawn[:, 0], drawn[:, 1], "Path", style.REFERENCE, width=5.0, **look)]
    kinks = [_nodes_between(path, each.low, each.high) for each in stretches(path) if each.label == KINK]
    if kinks:
        x, y = np.vstack(kinks).T
        traces.append(line(x, y, "Kink", style.KINK, width=14.0, **look))
    return traces


def _nodes_between(path: PathTable, low: float, high: float) -> Floats:
    """Return the nodes from one arc length to another, (n, 2) in m, and a gap."""
    first, last = path.arc_length.searchsorted((low, high)).tolist()
    nodes = slice(first, last + 1)
    return np.vstack([np.column_stack([path.x[nodes], path.y[nodes]]), np.full((1, 2), np.nan)])


def _beside_traces(log: Columns) -> list[dict[str, Any]]:
    """Return the line that the tractor followed, if that lies beside the path: nudged, or a neighbouring pass."""
    shown = thinned(log.steps)
    (x, y), progress = line_points(log, "tractor")[shown].T, along(log, "tractor")[shown]
    known = np.isfinite(x + y + progress)
    path_x, path_y, yaw, _ = log.header.path.path().sample(progress[known]).T
    left = np.cos(yaw) * (y[known] - path_y) - np.sin(yaw) * (x[known] - path_x)
    if not (np.abs(left) > _BESIDE).any():
        return []
    return [line(x, y, "Line beside the path", style.REFERENCE, width=1.5, dash="dash", hoverinfo="skip")]


def _recorded_traces(recorded: RecordedPoints) -> list[dict[str, Any]]:
    """Return the recorded points as dots, and a ring around the one furthest from the path."""
    dots = {"size": 3, "color": style.INK}
    ring = {"size": 14, "color": style.INK, "symbol": "circle-open", "line": {"width": 2}}
    worst = recorded.points[recorded.worst : recorded.worst + 1]
    text = {"mode": "markers+text", "text": [f"<b>{recorded.deviation:.2f} m</b>"], "textposition": "top center"}
    return [_marks(recorded.points, "Recorded points", dots), _marks(worst, "Furthest from the path", ring, **text)]


def _cursor() -> dict[str, Any]:
    """Return the dots that the page moves to where the pointer is along the path."""
    look = {"size": 13, "color": list(style.BODY_COLOURS.values()), "line": {"color": "#FFF", "width": 2}}
    return _marks(np.empty((0, 2)), "", look, showlegend=False)


def map_figure(log: Columns) -> Figure:
    """Draw the map, east to the right, both axes at the same scale; its last trace is the page's cursor."""
    recorded = log.header.recorded
    tractor, trailer = outlines(log)
    fixes = np.column_stack([log.column(f"measurement.tractor_{coordinate}") for coordinate in "xy"])[
        thinned(log.steps)
    ]
    fix_look = {"size": 3, "color": style.REFERENCE}
    traces = [
        *_path_traces(log.header.path),
        *(_recorded_traces(recorded) if recorded else []),
        *_beside_traces(log),
        _track_trace(log, "trailer", style.TRAILER, 4.0),  # wider: both drive on the same line
        _track_trace(log, "tractor", style.TRACTOR, 1.5),
        _outline_trace(trailer, "Trailer", style.TRAILER),
        _outline_trace(tractor, "Tractor", style.TRACTOR),
        _marks(fixes, "GPS fixes of the tractor", fix_look, visible="legendonly"),
        _cursor(),
    ]
    legend = {"orientation": "h", "x": 0, "y": 1.02, "yanchor": "bottom"}  # off the tracks, also on a phone
    east, north = axis("East, m", zeroline=False), axis("North, m", zeroline=False, scaleanchor="x")
    return {"data": traces, "layout": layout(east, north, hovermode="closest", dragmode="pan", legend=legend)}

"""The tube of one body as SVG: its sets in pairs of errors, and what every source takes off each bound."""

from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from itertools import combinations

import numpy as np

from drawbar.control.tube.bounds import OF_ESTIMATE, TightenedBound
from drawbar.control.tube.error_model import OPERATING_POINT
from drawbar.control.tube.tube import SubsystemTube
from drawbar.geometry import Floats
from drawbar.report import style
from drawbar.report.tube.units import shown, title

WIDTH = 880.0
_PANEL, _GAP, _TOP = 240.0, 60.0, 34.0
_BAR, _LABEL = 30.0, 130.0
_EDGES = 180
_POINTS = 1500
_TEXT = f'font-family="{style.FONT.replace(chr(34), chr(39))}" font-size="12" fill="{style.INK}"'
_LEFT, _SEEN = "#CBD5E1", "#0072B2"
_OF_BOTH_BODIES = {
    "steering_rate": "#009E73",
    "estimate of steering": "#8B5A2B",
    OPERATING_POINT: "#F0E442",
    OF_ESTIMATE: "#999999",
}
"""colours of the sources that both bodies have"""
_SOURCES = ("#D55E00", "#E69F00", "#CC79A7", "#56B4E9", "#5B4B8A", "#3F8F8F")


def outline(support: Callable[[Floats], Floats], across: Floats, up: Floats) -> Floats:
    """Return the corners (m, 2) of the polygon that m supporting lines make of a set's projection.

    Args:
        support: of the set, for directions (m, n).
        across: (n,) the error on the first axis, per its half-width.
        up: (n,) likewise on the second.
    """
    angles = 2.0 * np.pi * np.arange(_EDGES) / _EDGES
    normals = np.column_stack([np.cos(angles), np.sin(angles)])
    heights = support(normals @ np.array([across, up]))
    corners = np.stack([normals, np.roll(normals, -1, axis=0)], axis=1)
    return np.linalg.solve(corners, np.column_stack([heights, np.roll(heights, -1)])[..., None])[..., 0]


def render_tube(tube: SubsystemTube, deviations: Floats) -> str:
    """Return the picture as SVG text.

    Args:
        tube: of one body, with a set.
        deviations: recorded x^ - x̄ (k, n), none where k is 0.
    """
    panels = _panels(tube, deviations)
    top = _TOP + _PANEL + _GAP if panels else _TOP
    bars, height = _bars(tube, top)
    size = f'viewBox="0 0 {WIDTH:.0f} {height:.0f}" width="{WIDTH:.0f}" height="{height:.0f}"'
    body = "\n".join([*panels, *bars])
    background = '<rect width="100%" height="100%" fill="#FFFFFF"/>'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size} {_TEXT}>\n{background}\n{body}\n</svg>\n'


def _panels(tube: SubsystemTube, deviations: Floats) -> list[str]:
    around = tube.invariant_set
    pairs = list(combinations(around.bounded.tolist() if around else [], 2))
    parts = [part for k, pair in enumerate(pairs) for part in _panel(tube, pair, deviations, 40.0 + k * 285.0)]
    if parts:
        parts += _key(16.0, [("x̂ − x̄, what the law sees", _SEEN), ("x − x̄, the true error", style.REFERENCE)])
    return parts


@dataclass(frozen=True, slots=True, kw_only=True)
class _Frame:
    """A square of the picture that shows errors up to the reach of the larger set."""

    left: float
    reach: Floats
    """(2,)"""

    def polygon(self, points: Floats, look: str) -> str:
        """Return a closed line through points (m, 2)."""
        placed = " ".join(f"{x:.1f},{y:.1f}" for x, y in self.place(points).tolist())
        return f'<polygon points="{placed}" {look}/>'

    def place(self, points: Floats) -> Floats:
        """Return where points (m, 2) are in the picture, px."""
        half = 0.5 * _PANEL
        relative = points / self.reach * half
        return np.column_stack([self.left + half + relative[:, 0], _TOP + half - relative[:, 1]])


def _panel(tube: SubsystemTube, pair: tuple[int, int], deviations: Floats, left: float) -> list[str]:
    """Return one pair of errors: both sets, recorded errors, and the axes' names."""
    axes = np.eye(len(tube.gain))[list(pair)]
    widths = tube.support(axes)
    widths = np.maximum(widths, tube.seen(axes))
    frame = _Frame(left=left, reach=1.12 * widths)
    names = [title(tube.model.states[i]) for i in pair]
    units = [tube.model.units[i] for i in pair]
    corner = frame.place(np.array([[-1.0, -1.0], [1.0, 1.0]]) * frame.reach)
    parts = [
        f'<rect x="{corner[0, 0]:.1f}" y="{corner[1, 1]:.1f}" width="{_PANEL}" height="{_PANEL}" fill="none" '
        f'stroke="{style.GRID}"/>'
    ]
    for support, colour, opacity in ((tube.support, style.REFERENCE, 0.10), (tube.seen, _SEEN, 0.12)):
        points = outline(support, axes[0] / widths[0], axes[1] / widths[1]) * widths
        look = f'fill="{colour}" fill-opacity="{opacity}" stroke="{colour}" stroke-width="1.4"'
        parts.append(frame.polygon(points, look))
    step = max(1, len(deviations) // _POINTS)
    for x, y in frame.place(deviations[::step][:, list(pair)]).tolist() if len(deviations) else []:
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="1.1" fill="{_SEEN}" fill-opacity="0.45"/>')
    middle, bottom = left + 0.5 * _PANEL, _TOP + _PANEL
    across, up = (f"{name} ±{shown(width, unit)}" for name, width, unit in zip(names, widths, units, strict=True))
    parts.append(_label(middle, bottom + 18.0, across, "middle"))
    parts.append(
        f'<text x="{left - 10:.0f}" y="{_TOP + 0.5 * _PANEL:.0f}" text-anchor="middle" '
        f'transform="rotate(-90 {left - 10:.0f} {_TOP + 0.5 * _PANEL:.0f})">{escape(up)}</text>'
    )
    return parts


def _bars(tube: SubsystemTube, top: float) -> tuple[list[str], float]:
    """Return one bar for each bound, the key of their colours, and where the picture ends."""
    bounds = list(tube.bounds.values())
    names = list(bounds[0].contributions)
    own = (name for name in names if name not in _OF_BOTH_BODIES)
    colours = _OF_BOTH_BODIES | dict(zip(own, _SOURCES, strict=False))
    parts = [_label(20.0, top, "What is left of each bound for the nominal problem, and what every source takes")]
    for k, bound in enumerate(bounds):
        parts += _bar(bound, colours, top + 18.0 + 1.5 * k * _BAR)
    below = top + 36.0 + 1.5 * len(bounds) * _BAR
    key = [
        ("left", _LEFT),
        ("zero and original bound", style.INK),
        *((title(name), colours.get(name, style.INK)) for name in names),
    ]
    for row in range(0, len(key), 5):
        parts += _key(below + 4.0 * row, key[row : row + 5])
    return parts, below + 4.0 * len(key) + 24.0


def _bar(bound: TightenedBound, colours: dict[str, str], top: float) -> list[str]:
    """Return what is left of a bound, then what is taken off, up to what the machine can do."""
    start = min(0.0, bound.reach - bound.tightening)
    length = max(bound.original, bound.reach) - start
    room = WIDTH - _LABEL - 150.0

    def rectangle(low: float, high: float, colour: str) -> str:
        x, width = _LABEL + (low - start) / length * room, (high - low) / length * room
        return f'<rect x="{x:.1f}" y="{top:.1f}" width="{max(width, 0.0):.1f}" height="{_BAR}" fill="{colour}"/>'

    parts = [_label(_LABEL - 10.0, top + 19.0, title(bound.name), "end")]
    parts.append(rectangle(0.0, max(bound.reach - bound.tightening, 0.0), _LEFT))
    edge = bound.reach - bound.tightening
    for name, part in bound.contributions.items():
        parts.append(rectangle(edge, edge + part, colours.get(name, style.INK)))
        edge += part
    for value in (0.0, bound.original):
        mark = _LABEL + (value - start) / length * room
        parts.append(
            f'<line x1="{mark:.1f}" x2="{mark:.1f}" y1="{top - 4:.1f}" y2="{top + _BAR + 4:.1f}" '
            f'stroke="{style.INK}" stroke-width="1.6"/>'
        )
    left = shown(bound.tightened, bound.unit) if bound.tightened > 0.0 else "nothing left"
    return [*parts, _label(WIDTH - 140.0, top + 19.0, f"{left} of {shown(bound.original, bound.unit)}")]


def _key(y: float, entries: list[tuple[str, str]]) -> list[str]:
    """Return a row of coloured squares with their names."""
    parts, x = [], 24.0
    for name, colour in entries:
        parts.append(f'<rect x="{x:.0f}" y="{y - 9:.0f}" width="10" height="10" fill="{colour}"/>')
        parts.append(_label(x + 15.0, y, name))
        x += 36.0 + 6.4 * len(name)
    return parts


def _label(x: float, y: float, text: str, anchor: str = "start") -> str:
    return f'<text x="{x:.0f}" y="{y:.0f}" text-anchor="{anchor}">{escape(text)}</text>'

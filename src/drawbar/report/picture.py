"""A still picture of a run as SVG: the map, and below it the distance of both bodies from the path."""

import math
from dataclasses import dataclass

import numpy as np

from drawbar.geometry import Floats
from drawbar.recording.log import Columns
from drawbar.report import style
from drawbar.report.columns import along, track
from drawbar.report.decimation import extremes, thinned
from drawbar.report.map import outlines, polyline
from drawbar.report.path_errors import Bodies, PathErrors

_WIDTH, _HEIGHT = 880.0, 800.0
_TEXT = f'font-family="{style.FONT.replace(chr(34), chr(39))}" font-size="13" fill="{style.INK}"'


@dataclass(frozen=True, slots=True, kw_only=True)
class _Window:
    """A rectangle of the picture (left, top, width, height in px) that shows a rectangle of the data."""

    left: float
    top: float
    width: float
    height: float
    x: tuple[float, float]
    y: tuple[float, float]

    def place(self, x: Floats, y: Floats) -> Floats:
        """Return (n, 2) px of points of the data; y points up in the data, down in the picture."""
        across = self.left + (x - self.x[0]) / (self.x[1] - self.x[0]) * self.width
        down = self.top + (self.y[1] - y) / (self.y[1] - self.y[0]) * self.height
        return np.column_stack([across, down])

    def curve(self, x: Floats, y: Floats, look: str) -> str:
        """Return an SVG path through the points x (n,), y (n,), with gaps at NaN."""
        commands, pen_down = [], False
        for across, down in self.place(x, y).tolist():
            visible = math.isfinite(across) and math.isfinite(down)
            if visible:
                commands.append(f"{'L' if pen_down else 'M'}{across:.1f} {down:.1f}")
            pen_down = visible
        return f'<path d="{"".join(commands)}" {look}/>'


def _stroke(colour: str, width: float, more: str = 'fill="none"') -> str:
    return f'stroke="{colour}" stroke-width="{width}" stroke-linejoin="round" {more}'


def _range(values: Floats, least: float) -> tuple[float, float]:
    """Return the range of the values that are there, widened to at least `least` and by a twentieth."""
    present = values[np.isfinite(values)]
    low, high = (float(present.min()), float(present.max())) if present.size else (0.0, 0.0)
    half = 0.525 * max(high - low, least)
    return 0.5 * (low + high) - half, 0.5 * (low + high) + half


def _map_window(x: Floats, y: Floats) -> _Window:
    """Return the window of the map: equal scales, the data in the middle."""
    left, top, width, height = 20.0, 44.0, _WIDTH - 40.0, 520.0
    (west, east), (south, north) = _range(x, 10.0), _range(y, 10.0)
    scale = max((east - west) / width, (north - south) / height)
    middle = 0.5 * (west + east), 0.5 * (south + north)
    half = 0.5 * scale * width, 0.5 * scale * height
    x_range, y_range = ((m - h, m + h) for m, h in zip(middle, half, strict=True))
    return _Window(left=left, top=top, width=width, height=height, x=x_range, y=y_range)


def _map(log: Columns) -> list[str]:
    path = polyline(log.header.path)
    tracks = {body: track(log, body)[thinned(log.steps)] for body in style.BODY_COLOURS}
    window = _map_window(*np.vstack([path, *tracks.values()]).T)
    parts = [window.curve(path[:, 0], path[:, 1], _stroke("#D5DAE1", 5.0))]
    for body, colour in reversed(style.BODY_COLOURS.items()):
        parts.append(window.curve(tracks[body][:, 0], tracks[body][:, 1], _stroke(colour, 1.3)))
    for outline, colour in zip(outlines(log), style.BODY_COLOURS.values(), strict=True):
        look = _stroke(colour, 0.8, f'fill="{colour}" fill-opacity="0.35"')
        parts.append(window.curve(outline[:, 0], outline[:, 1], look))
    return [*parts, *_scale(window)]


def _scale(window: _Window) -> list[str]:
    """Return a bar in the window's lower left corner whose length, 1, 2 or 5 times a power of ten, stands above it."""
    room = 0.2 * (window.x[1] - window.x[0])
    power = 10.0 ** math.floor(math.log10(room))
    metres = power * max(factor for factor in (1, 2, 5) if factor * power <= room)
    ends = window.x[0] + np.array([0.0, metres]), np.full(2, window.y[0])
    (left, bottom), _ = window.place(*ends)
    return [window.curve(*ends, _stroke(style.INK, 2.0)), _label(left, bottom - 6.0, f"{metres:g} m")]


def _label(x: float, y: float, text: str, anchor: str = "start", colour: str = style.INK) -> str:
    return f'<text x="{x:.0f}" y="{y:.0f}" text-anchor="{anchor}" style="fill:{colour}">{text}</text>'


def _errors(log: Columns, errors: Bodies[PathErrors]) -> list[str]:
    curves = {body: getattr(errors, body).error * 100.0 for body in style.BODY_COLOURS}
    largest = _range(np.abs(np.concatenate([*curves.values(), np.zeros(1)])), 1.0)[1]
    length = log.header.path.arc_length[-1]
    window = _Window(left=60.0, top=610.0, width=_WIDTH - 80.0, height=140.0, x=(0.0, length), y=(-largest, largest))
    parts = [_label(60.0, 598.0, "Distance from the path, cm (left positive)")]
    for level in (-math.floor(largest), 0, math.floor(largest)):
        line = window.curve(np.array([0.0, length]), np.full(2, float(level)), _stroke(style.GRID, 1.0))
        parts += [
            line,
            _label(52.0, window.place(np.zeros(1), np.array([level]))[0, 1] + 4.0, f"{level}", "end"),
        ]
    for body, colour in reversed(style.BODY_COLOURS.items()):
        progress = along(log, body)
        on_path = np.where(progress >= 0.0, progress, np.nan)  # the trailer starts behind the path
        shown = extremes(curves[body])
        parts.append(window.curve(on_path[shown], curves[body][shown], _stroke(colour, 1.1)))
    parts += [_label(60.0, 776.0, "0 m"), _label(0.5 * _WIDTH + 20.0, 776.0, "along the path", "middle")]
    parts += [_label(_WIDTH - 20.0, 776.0, f"{length:.0f} m", "end")]
    return parts


def render_picture(log: Columns, errors: Bodies[PathErrors]) -> str:
    """Return the picture as SVG text; without truth the error strip stays empty."""
    legend = [
        _label(24.0, 28.0, "Path", colour=style.REFERENCE),
        _label(70.0, 28.0, "Tractor", colour=style.TRACTOR),
        _label(132.0, 28.0, "Trailer", colour=style.TRAILER),
    ]
    body = "\n".join([*legend, *_map(log), *_errors(log, errors)])
    size = f'viewBox="0 0 {_WIDTH:.0f} {_HEIGHT:.0f}" width="{_WIDTH:.0f}" height="{_HEIGHT:.0f}"'
    background = '<rect width="100%" height="100%" fill="#FFFFFF"/>'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size} {_TEXT}>\n{background}\n{body}\n</svg>\n'

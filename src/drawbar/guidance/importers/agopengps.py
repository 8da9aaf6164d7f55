"""AgOpenGPS fields: a folder with Field.txt (the origin) and TrackLines.txt (its guidance lines).

TrackLines.txt holds, after "$TrackLines", for each line: its name, heading (rad, clockwise from north),
points A and B ("easting,northing"), nudge distance (m), mode, visibility, a count and as many points
"easting,northing,heading". Coordinates are metres on the plane whose origin Field.txt gives (StartFix).
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import Floats
from drawbar.guidance.importers.line import RecordedLine, choose
from drawbar.guidance.importers.text import number, read_lines

_ORIGIN, _LINES = "Field.txt", "TrackLines.txt"
_HEADER = "$TrackLines"
_HEAD = 8
"""rows of a line before its points"""
_AB_LINE = 2
_AB_EXTENSION = 100.0
"""an AB line is endless in AgOpenGPS; here it is driven from A to B and this much further, m"""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Track:
    """Where one line stands in the file."""

    name: str
    head: int
    """index of the row that holds the name"""
    count: int
    """number of points after the head"""


def read_agopengps(folder: Path, track: str | None) -> RecordedLine:
    """Return a line of a field folder, east and north of the field's origin; None takes the only one.

    The points of the other lines are not looked at: not even a NaN there is refused. Raises PathError with
    file and line number for anything else that is not as AgOpenGPS writes it.
    """
    for name in (_ORIGIN, _LINES):
        if not (folder / name).exists():
            raise PathError(
                f"{folder}: has no {name}; give the folder of one AgOpenGPS field, which holds {_ORIGIN} and {_LINES}"
            )
    _require_origin(folder / _ORIGIN)
    file = folder / _LINES
    rows = read_lines(file)
    if rows[0] != _HEADER:
        raise PathError(f"{file}:1: is {rows[0][:40]!r}; an AgOpenGPS file of lines starts with {_HEADER}")
    tracks = _tracks(file, rows)
    return _line(file, rows, tracks[choose(file, [track.name for track in tracks], track)])


def _require_origin(file: Path) -> None:
    """Refuse a field without the origin (latitude, longitude in degrees) that its metres count from."""
    rows = read_lines(file)
    if "StartFix" not in rows[:-1]:
        raise PathError(
            f"{file}: has no row 'StartFix' with the field's origin 'latitude,longitude' below; "
            f"give a field folder as AgOpenGPS writes it"
        )
    index = rows.index("StartFix") + 1
    latitude, longitude = _numbers(rows[index], 2, f"{file}:{index + 1}")
    if not (abs(latitude) < 90.0 and abs(longitude) <= 180.0):
        raise PathError(f"{file}:{index + 1}: origin {rows[index]!r}; degrees within ±90 and ±180 are allowed")


def _tracks(file: Path, rows: list[str]) -> list[_Track]:
    """Return where the lines of the file stand."""
    tracks: list[_Track] = []
    head = 1
    while head < len(rows):
        if not rows[head]:
            head += 1
            continue
        left = len(rows) - head - _HEAD
        if left < 0:
            raise PathError(
                f"{file}:{len(rows)}: the file ends inside line {rows[head]!r}; export the field from AgOpenGPS again"
            )
        count = number(rows[head + 7], f"{file}:{head + 8}", "the number of points")
        if not (count.is_integer() and 0 <= count <= left):
            raise PathError(
                f"{file}:{head + 8}: line {rows[head]!r} announces {rows[head + 7]} points, but {left} rows "
                f"follow; export the field from AgOpenGPS again"
            )
        tracks.append(_Track(name=rows[head], head=head, count=int(count)))
        head += _HEAD + int(count)
    return tracks


def _line(file: Path, rows: list[str], track: _Track) -> RecordedLine:
    """Return the points of one line."""
    head, first = track.head, track.head + _HEAD
    nudge = number(rows[head + 4], f"{file}:{head + 5}", "the nudge distance")
    if nudge != 0.0:
        raise PathError(
            f"{file}:{head + 5}: line {track.name!r} has a nudge of {nudge:g} m; only 0 can be "
            f"driven: move the reference line itself in AgOpenGPS"
        )
    is_ab = number(rows[head + 5], f"{file}:{head + 6}", "the mode") == _AB_LINE
    indices = range(head + 2, head + 4) if is_ab else range(first, first + track.count)
    places = [f"{file}:{index + 1}" for index in indices]
    columns = 2 if is_ab else 3
    numbers = [_numbers(rows[i], columns, place) for i, place in zip(indices, places, strict=True)]
    points = np.array(numbers).reshape(-1, columns)[:, :2]
    at = places or [f"{file}:{first}"]
    return RecordedLine.checked(track.name, _extended(points) if is_ab else points, at)


def _extended(points: Floats) -> Floats:
    """Return A and B (2, 2) with B moved on, m."""
    a, b = points
    length = math.hypot(*(b - a))
    return np.array([a, b + (b - a) * _AB_EXTENSION / length]) if length > 0.0 else points


def _numbers(text: str, count: int, place: str) -> list[float]:
    """Return the numbers of one row "1.5,2.5"; the decimal commas of some locales are refused."""
    cells = text.split(",")
    if len(cells) != count:
        raise PathError(f"{place}: is {text!r}; {count} numbers with decimal points, separated by commas, are needed")
    return [number(cell, place, "a coordinate") for cell in cells]

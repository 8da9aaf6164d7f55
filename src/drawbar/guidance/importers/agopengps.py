"""AgOpenGPS fields: a folder with Field.txt (the origin) and TrackLines.txt (its guidance lines).

TrackLines.txt holds, after "$TrackLines", for each line: its name, heading (rad, clockwise from north),
points A and B ("easting,northing"), nudge distance (m), mode, visibility, a count and as many points
"easting,northing,heading". Coordinates are metres on the plane whose origin Field.txt gives (StartFix); that plane is
AgOpenGPS's own, 96 mm off at 1 km, so lines go by WGS84 to the frame that fixes are on too.
"""

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import Floats, LocalFrame
from drawbar.guidance.importers.line import RecordedLine, choose, on_frame
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
    """Return a line of a field folder, in the frame at the field's origin and height zero; None takes the only one.

    The points of the other lines are not looked at: not even a NaN there is refused. Raises PathError with
    file and line number for anything else that is not as AgOpenGPS writes it.
    """
    for name in (_ORIGIN, _LINES):
        if not (folder / name).exists():
            raise PathError(
                f"{folder}: has no {name}; give the folder of one AgOpenGPS field, which holds {_ORIGIN} and {_LINES}"
            )
    frame = _frame(folder / _ORIGIN)
    file = folder / _LINES
    rows = read_lines(file)
    if rows[0] != _HEADER:
        raise PathError(f"{file}:1: is {rows[0][:40]!r}; an AgOpenGPS file of lines starts with {_HEADER}")
    tracks = _tracks(file, rows)
    line = _line(file, rows, tracks[choose(file, [track.name for track in tracks], track)])
    points = on_frame(*plane_to_wgs84(line.x, line.y, frame), frame, [f"{file}: line {line.name!r}"] * len(line.x))
    return replace(line, x=points[:, 0].copy(), y=points[:, 1].copy(), frame=frame)


def plane_to_wgs84(east: Floats, north: Floats, origin: LocalFrame) -> tuple[Floats, Floats]:
    """Return latitude and longitude (degrees, (n,)) of points on AgOpenGPS's plane, m.

    The inverse of AgOpenGPS.Core/Models/Base/LocalPlane.cs: a degree of latitude is measured at the origin, a degree of
    longitude at the point.
    """
    phi = np.radians(origin.latitude)
    degree = 111132.92 - 559.82 * np.cos(2.0 * phi) + 1.175 * np.cos(4.0 * phi) - 0.0023 * np.cos(6.0 * phi)
    latitude = origin.latitude + north / degree
    phi = np.radians(latitude)
    degree = 111412.84 * np.cos(phi) - 93.5 * np.cos(3.0 * phi) + 0.118 * np.cos(5.0 * phi)
    return latitude, origin.longitude + east / degree


def _frame(file: Path) -> LocalFrame:
    """Return the frame at the field's origin (latitude, longitude in degrees), where its metres count from."""
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
    return LocalFrame(latitude=latitude, longitude=longitude)


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

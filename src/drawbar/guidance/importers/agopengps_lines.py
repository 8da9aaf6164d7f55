"""The guidance lines of AgOpenGPS, by the files that hold them.

TrackLines.txt holds, after "$TrackLines", for each line: its name, heading (rad, clockwise from north), points A and B
("easting,northing"), nudge distance (m), mode, visibility, a count and as many points "easting,northing,heading".
CurveLines.txt, of earlier versions, holds after "$CurveLines" name, heading, count and points; ABLines.txt a row for
each line: "name,heading in degrees,easting,northing". Source: AgOpenGPS, SaveOpen.Designer.cs.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import Floats
from drawbar.guidance.importers.boundary import Boundary
from drawbar.guidance.importers.line import RecordedLine
from drawbar.guidance.importers.text import number, numbers, read_lines

_AB_LINE = 2
_AB_EXTENSION = 100.0
"""m that an A-B line continues where neither a boundary nor the user ends it"""

Read = Callable[[Boundary | None, float], RecordedLine]


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundLine:
    """A line of a file, not yet read."""

    name: str
    read: Read
    """returns the line, its A-B line extended to a boundary, or if that is None so far, m"""


def find_tracks(file: Path) -> list[FoundLine]:
    """Return the lines of a TrackLines.txt."""
    rows = _rows(file, "$TrackLines")
    heads = _heads(file, rows, before=8)
    return [FoundLine(name=rows[head], read=partial(_track, file, rows, head)) for head in heads]


def find_curves(file: Path) -> list[FoundLine]:
    """Return the lines of a CurveLines.txt."""
    rows = _rows(file, "$CurveLines")
    heads = _heads(file, rows, before=3)
    return [FoundLine(name=rows[head], read=partial(_curve, file, rows, head, 3)) for head in heads]


def find_straights(file: Path) -> list[FoundLine]:
    """Return the lines of an ABLines.txt."""
    found = []
    for index, row in enumerate(read_lines(file)):
        if row and not row.startswith("$"):
            name, heading, east, north = _straight(row, f"{file}:{index + 1}")
            ahead = (math.sin(math.radians(heading)), math.cos(math.radians(heading)))
            points = np.array([[east, north], [east + ahead[0], north + ahead[1]]])
            found.append(FoundLine(name=name, read=partial(_endless, name, points, [f"{file}:{index + 1}"] * 2)))
    return found


FORMATS: Mapping[str, Callable[[Path], list[FoundLine]]] = {
    "TrackLines.txt": find_tracks,
    "ABLines.txt": find_straights,
    "CurveLines.txt": find_curves,
}


def _rows(file: Path, header: str) -> list[str]:
    rows = read_lines(file)
    if rows[0] != header:
        raise PathError(f"{file}:1: is {rows[0][:40]!r}; an AgOpenGPS file of lines starts with {header}")
    return rows


def _heads(file: Path, rows: list[str], *, before: int) -> list[int]:
    """Return where the lines of a file begin, each with so many rows before its points."""
    heads: list[int] = []
    head = 1
    while head < len(rows):
        if not rows[head]:
            head += 1
            continue
        left = len(rows) - head - before
        if left < 0:
            raise PathError(
                f"{file}:{len(rows)}: the file ends inside line {rows[head]!r}; export the field from AgOpenGPS again"
            )
        count = number(rows[head + before - 1], f"{file}:{head + before}", "the number of points")
        if not (count.is_integer() and 0 <= count <= left):
            raise PathError(
                f"{file}:{head + before}: line {rows[head]!r} announces points: "
                f"{rows[head + before - 1]}, but holds {left}; export the field from AgOpenGPS again"
            )
        heads.append(head)
        head += before + int(count)
    return heads


def _track(file: Path, rows: list[str], head: int, boundary: Boundary | None, extension: float) -> RecordedLine:
    """Return one line of a TrackLines.txt."""
    name = rows[head]
    (nudge,) = numbers(rows[head + 4], 1, f"{file}:{head + 5}", "the nudge distance")
    if nudge != 0.0:
        raise PathError(
            f"{file}:{head + 5}: line {name!r} has a nudge of {nudge:g} m; only 0 can be "
            f"driven: move the reference line itself in AgOpenGPS"
        )
    if number(rows[head + 5], f"{file}:{head + 6}", "the mode") != _AB_LINE:
        return _curve(file, rows, head, 8, boundary, extension)
    places = [f"{file}:{index + 1}" for index in (head + 2, head + 3)]
    points = np.array([numbers(rows[head + 2 + i], 2, place) for i, place in enumerate(places)])
    return _endless(name, points, places, boundary, extension)


def _curve(file: Path, rows: list[str], head: int, before: int, _: Boundary | None, __: float) -> RecordedLine:
    """Return the line whose points stand so many rows after its head; it has an end of its own."""
    first = head + before
    count = int(number(rows[first - 1], f"{file}:{first}", "the number of points"))
    places = [f"{file}:{index + 1}" for index in range(first, first + count)]
    points = [numbers(row, 3, place)[:2] for row, place in zip(rows[first : first + count], places, strict=True)]
    return RecordedLine.checked(rows[head], np.array(points).reshape(-1, 2), places or [f"{file}:{first}"])


def _endless(name: str, points: Floats, places: list[str], boundary: Boundary | None, extension: float) -> RecordedLine:
    """Return the line through two points (2, 2): to the boundary on both sides, or so far beyond the second, m."""
    a, b = points
    length = math.hypot(*(b - a))
    if length > 0.0 and math.isfinite(length):
        ahead = (b - a) / length
        ends = boundary.chord(a, ahead, places[0]) if boundary else (0.0, length + (extension or _AB_EXTENSION))
        points = np.array([a + end * ahead for end in ends])
    return RecordedLine.checked(name, points, places)


def _straight(row: str, place: str) -> tuple[str, float, float, float]:
    """Return name, heading (degrees), easting and northing (m) of a row of an ABLines.txt; names may hold commas."""
    cells = row.split(",")
    with_points = len(cells) == 4 or all("." in cell for cell in cells[-3:])
    count = 3 if with_points else 6
    if name := ",".join(cells[:-count]):
        heading, east, north = numbers(",".join(cells[-count:]), 3, place)
        return name, heading, east, north
    raise PathError(f"{place}: is {row!r}; a row of ABLines.txt is name,heading,easting,northing")

"""CSV files of local coordinates: x (east) and y (north) in m, with or without a header "x,y"."""

from pathlib import Path

import numpy as np

from drawbar.errors import PathError
from drawbar.guidance.importers.line import RecordedLine, choose
from drawbar.guidance.importers.text import number, read_lines

_SEPARATORS = ";\t,"


def read_csv(path: Path, track: str | None) -> RecordedLine:
    """Return the one line of the file, named after it.

    Columns are separated by comma, semicolon or tabulator; with the latter two a decimal comma is understood.
    Raises PathError with file and line number.
    """
    choose(path, [path.stem], track)
    rows = [(f"{path}:{index}", text) for index, text in enumerate(read_lines(path), start=1) if text]
    separator = next((mark for mark in _SEPARATORS if mark in rows[0][1]), ",")
    if [cell.strip(' "').lower() for cell in rows[0][1].split(separator)] == ["x", "y"]:
        rows = rows[1:]
    points = [_point(text, place, separator) for place, text in rows]
    places = [place for place, _ in rows] or [str(path)]
    return RecordedLine.checked(path.stem, np.array(points).reshape(-1, 2), places)


def _point(text: str, place: str, separator: str) -> list[float]:
    """Return x and y (m) of one row."""
    cells = text.split(separator)
    if len(cells) != 2:
        raise PathError(f"{place}: {text!r} has {len(cells)} columns; two are needed, x and y in m, as in '12.5,-3.0'")
    if separator != ",":
        cells = [cell.replace(",", ".") for cell in cells]
    return [number(cell, place, name) for cell, name in zip(cells, "xy", strict=True)]

"""CSV files of local coordinates: x (east) and y (north) in m, with or without a header "x,y"."""

from pathlib import Path

import numpy as np

from drawbar.errors import PathError
from drawbar.guidance.importers.line import RecordedLine, choose
from drawbar.guidance.importers.text import is_number, number, read_lines

_SEPARATORS = ";\t,"
_COMMENT = "#"


def read_csv(path: Path, track: str | None) -> RecordedLine:
    """Return the one line of the file, named after it.

    Columns are separated by comma, semicolon or tabulator; with the latter two a decimal comma is understood.
    Cells may be quoted; empty rows and those that start with # are skipped. Raises PathError with file and
    line number.
    """
    choose(path, [path.stem], track)
    numbered = enumerate(read_lines(path), start=1)
    rows = [(f"{path}:{index}", text) for index, text in numbered if text and not text.startswith(_COMMENT)]
    first = rows[0][1] if rows else ""
    separator = separator_of(first)
    if rows and _is_header(*rows[0], separator):
        rows = rows[1:]
    points = [_point(text, place, separator) for place, text in rows]
    places = [place for place, _ in rows] or [str(path)]
    return RecordedLine.checked(path.stem, np.array(points).reshape(-1, 2), places)


def separator_of(row: str) -> str:
    """Return what separates the columns of a table, by its first row."""
    return next((mark for mark in _SEPARATORS if mark in row), ",")


def _is_header(place: str, text: str, separator: str) -> bool:
    """Return whether the first row is the header "x,y"; any other header is refused."""
    cells = _cells(text, separator)
    if len(cells) == 1 or any(map(is_number, cells)):
        return False
    if [cell.lower() for cell in cells] != ["x", "y"]:
        raise PathError(
            f"{place}: header {text!r}; two columns are read, x (east) and y (north) in m: name them x,y in this "
            f"order or remove the header; degrees belong in GeoJSON, or, for the console's import, under the header "
            f"line,latitude,longitude"
        )
    return True


def _point(text: str, place: str, separator: str) -> list[float]:
    """Return x and y (m) of one row."""
    cells = _cells(text, separator)
    if len(cells) != 2:
        columns = "1 column" if len(cells) == 1 else f"{len(cells)} columns"
        raise PathError(f"{place}: {text!r} has {columns}; two are needed, x and y in m, as in '12.5,-3.0'")
    return [number(cell, place, name) for cell, name in zip(cells, "xy", strict=True)]


def _cells(text: str, separator: str) -> list[str]:
    """Return the cells of one row, without quotes and with decimal points."""
    cells = [_unquoted(cell.strip()) for cell in text.split(separator)]
    return cells if separator == "," else [cell.replace(",", ".") for cell in cells]


def _unquoted(cell: str) -> str:
    return cell[1:-1].strip() if len(cell) > 1 and cell[0] == cell[-1] == '"' else cell

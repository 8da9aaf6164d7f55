"""CSV of lines: "line,latitude,longitude" in degrees, or, as `path.file` takes it, "x,y" in m of the drive's frame.

Columns are separated by comma, semicolon or tabulator; with the latter two a decimal comma is understood.
"""

import csv
import io
import re
from pathlib import Path

import numpy as np

from drawbar.errors import PathError
from drawbar.fields.field import Degrees, Field, make_field
from drawbar.fields.lines import on_earth
from drawbar.geometry import LocalFrame
from drawbar.guidance.importers.csv import read_csv, separator_of
from drawbar.guidance.importers.text import number, read_text

_HEADER = ["line", "latitude", "longitude"]
_ABOVE = re.compile(r"\A(?:[^\S\r\n]*(?:#[^\r\n]*)?(?:\r\n|\r|\n))*")
"""empty rows and comments above the header; below it a # begins a name"""


def read(path: Path, frame: LocalFrame) -> tuple[Field, ...]:
    """Return the lines of a file; x and y count from the frame's origin. Raises PathError with the row."""
    text = read_text(path)
    below = _ABOVE.sub("", text, count=1)
    above = len(text[: len(text) - len(below)].splitlines())
    separator = separator_of(next(iter(below.splitlines()), ""))
    try:
        rows = list(csv.reader(io.StringIO(below, newline=None), delimiter=separator)) or [[]]
    except csv.Error as error:
        raise PathError(f"{path}: is no table: {error}; export it again") from None
    if [cell.strip().lower() for cell in rows[0]] != _HEADER:
        line = read_csv(path, None)
        points = on_earth(np.column_stack([line.x, line.y]), frame)
        return (make_field(str(path), path.stem, [(line.name, [(p[0], p[1]) for p in points.tolist()])]),)
    lines: dict[str, list[tuple[float, float]]] = {}
    for index, row in enumerate(rows[1:], above + 2):
        if not row:
            continue
        place = f"{path}:{index}"
        if len(row) != len(_HEADER):
            raise PathError(f"{place}: is {separator.join(row)!r}; {','.join(_HEADER)} is needed")
        latitude, longitude = (cell if separator == "," else cell.replace(",", ".") for cell in row[1:])
        point = number(latitude, place, "the latitude"), number(longitude, place, "the longitude")
        lines.setdefault(row[0], []).append(point)
    found: list[tuple[str, Degrees]] = list(lines.items())
    return (make_field(str(path), path.stem, found),)


def write(field: Field) -> bytes:
    """Return the field's lines; its boundary is not written."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_HEADER)
    for line in field.lines:
        writer.writerows([line.name, f"{lat:.9f}", f"{lon:.9f}"] for lat, lon in line.points.tolist())
    return text.getvalue().encode()

"""CSV of lines: "line,latitude,longitude" in degrees, or, as `path.file` takes it, "x,y" in m of the drive's frame."""

import csv
import io
from pathlib import Path

import numpy as np

from drawbar.errors import PathError
from drawbar.fields.field import Degrees, Field, make_field
from drawbar.fields.lines import on_earth
from drawbar.geometry import LocalFrame
from drawbar.guidance.importers.csv import read_csv
from drawbar.guidance.importers.text import number, read_text

_HEADER = ["line", "latitude", "longitude"]


def read(path: Path, frame: LocalFrame) -> tuple[Field, ...]:
    """Return the lines of a file; x and y count from the frame's origin. Raises PathError with the row."""
    rows = list(csv.reader(io.StringIO(read_text(path))))
    if [cell.strip().lower() for cell in rows[0]] != _HEADER:
        line = read_csv(path, None)
        points = on_earth(np.column_stack([line.x, line.y]), frame)
        return (make_field(str(path), path.stem, [(line.name, [(p[0], p[1]) for p in points.tolist()])]),)
    lines: dict[str, list[tuple[float, float]]] = {}
    for index, row in enumerate(rows[1:], 2):
        if not row:
            continue
        place = f"{path}:{index}"
        if len(row) != len(_HEADER):
            raise PathError(f"{place}: {row!r} has {len(row)} cells; {','.join(_HEADER)} is needed")
        point = number(row[1], place, "the latitude"), number(row[2], place, "the longitude")
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

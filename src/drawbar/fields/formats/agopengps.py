"""AgOpenGPS field folders: Field.txt, TrackLines.txt and Boundary.txt; read by the importer of `path.file`."""

import io
import math
import zipfile
from pathlib import Path

import numpy as np

from drawbar.fields.field import Field, make_field
from drawbar.geometry import Floats, LocalFrame
from drawbar.guidance.importers.agopengps import field_lines, plane_to_wgs84, wgs84_to_plane

_STRAIGHT, _CURVE = 2, 4


def read(folder: Path) -> tuple[Field, ...]:
    """Return the field of a folder. Its A-B lines go from boundary to boundary, or 100 m on; raises PathError.

    Lines that cannot be driven are left out.
    """
    frame, lines, boundary, left_out = field_lines(folder)

    def degrees(points: Floats) -> list[tuple[float, float]]:
        latitude, longitude = plane_to_wgs84(points[:, 0], points[:, 1], frame)
        return list(zip(latitude.tolist(), longitude.tolist(), strict=True))

    found = [(line.name, degrees(np.column_stack([line.x, line.y]))) for line in lines]
    return (make_field(str(folder), folder.name, found, degrees(boundary.ring) if boundary else None, left_out),)


def write(field: Field) -> bytes:
    """Return a zip with the field's folder."""
    origin = field.frame()
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, rows in (
            ("Field.txt", _origin_rows(field, origin)),
            ("TrackLines.txt", _track_rows(field, origin)),
            ("Boundary.txt", _boundary_rows(field, origin)),
        ):
            archive.writestr(f"{field.name}/{name}", "\n".join(rows) + "\n")
    return content.getvalue()


def _origin_rows(field: Field, origin: LocalFrame) -> list[str]:
    place = f"{origin.latitude:.9f},{origin.longitude:.9f}"
    rows = ["2000-January-01 00:00:00 AM", "$FieldDir", field.name, "$Offsets", "0,0", "Convergence", "0", "StartFix"]
    return [*rows, place]


def _track_rows(field: Field, origin: LocalFrame) -> list[str]:
    rows = ["$TrackLines"]
    for line in field.lines:
        points = _on_plane(line.points, origin)
        headings = _headings(points)
        curve = [] if line.is_straight else [_row(*each) for each in zip(points, headings, strict=True)]
        whole = points[-1] - points[0]
        heading = math.atan2(whole[0], whole[1]) % (2.0 * math.pi)
        ends = [f"{end[0]:.7f},{end[1]:.7f}" for end in (points[0], points[-1])]  # A-B lines continue far beyond them
        kind = _STRAIGHT if line.is_straight else _CURVE
        rows += [line.name, f"{heading:.9f}", *ends, "0", str(kind), "True", str(len(curve)), *curve]
    return rows


def _boundary_rows(field: Field, origin: LocalFrame) -> list[str]:
    if field.boundary is None:
        return ["$Boundary"]
    points = _on_plane(field.boundary, origin)
    rows = [_row(*each) for each in zip(points, _headings(points), strict=True)]
    return ["$Boundary", "False", str(len(rows)), *rows]


def _on_plane(points: Floats, origin: LocalFrame) -> Floats:
    return np.column_stack(wgs84_to_plane(points[:, 0], points[:, 1], origin))


def _headings(points: Floats) -> list[float]:
    """Return the heading at each point, clockwise from north, rad."""
    steps = np.diff(points, axis=0)
    headings = np.arctan2(steps[:, 0], steps[:, 1]) % (2.0 * math.pi)
    return [*headings.tolist(), float(headings[-1])]


def _row(point: Floats, heading: float) -> str:
    return f"{point[0]:.4f},{point[1]:.4f},{heading:.5f}"

"""AgOpenGPS fields: a folder with Field.txt (the origin) and its guidance lines.

The lines stand in TrackLines.txt, in ABLines.txt and CurveLines.txt of earlier versions, or in all three
(agopengps_lines.py). Coordinates are metres on the plane whose origin Field.txt gives (StartFix); that plane is
AgOpenGPS's own, 96 mm off at 1 km, so lines go by WGS84 to the frame that fixes are on too. File names may be in any
case, and numbers may have decimal commas where that leaves no doubt.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import Floats, LocalFrame
from drawbar.guidance.importers.agopengps_lines import FORMATS, FoundLine
from drawbar.guidance.importers.boundary import Boundary, read_boundary
from drawbar.guidance.importers.line import RecordedLine, choose, on_frame
from drawbar.guidance.importers.text import lines_of, numbers, read_text

_ORIGIN, _BOUNDARY = "Field.txt", "Boundary.txt"


def read_agopengps(folder: Path, track: str | None, extension: float = 0.0) -> RecordedLine:
    """Return a line of a field folder, in the frame at the field's origin and height zero; None takes the only one.

    An A-B line, endless in AgOpenGPS, goes `extension` m beyond its points; with 0 to the field's boundary on both
    sides, or where there is none 100 m on. The points of the other lines are not looked at: not even a NaN there is
    refused. Raises PathError with file and line number for anything else that is not as AgOpenGPS writes it.
    """
    files = _files(folder)
    frame = _frame(files[_ORIGIN.lower()])
    lines, looked_for = _lines(files)
    if not lines:
        raise PathError(f"{folder}: holds no line: {'; '.join(looked_for)}; record one in AgOpenGPS")
    chosen = lines[choose(folder, [line.name for line in lines], track)]
    line = chosen.read(None if extension else _edge(files), extension)
    points = on_frame(*plane_to_wgs84(line.x, line.y, frame), frame, [f"{folder}: line {line.name!r}"] * len(line.x))
    return replace(line, x=points[:, 0].copy(), y=points[:, 1].copy(), frame=frame)


def agopengps_names(folder: Path) -> list[str]:
    """Return the names of a field folder's lines; errors as read_agopengps."""
    return [line.name for line in _lines(_files(folder))[0]]


def field_lines(folder: Path) -> tuple[LocalFrame, list[RecordedLine], Boundary | None, list[str]]:
    """Return a field folder's origin, its lines and its edge, on AgOpenGPS's plane, m; errors as read_agopengps.

    A-B lines go from boundary to boundary, or without one 100 m on. Lines that cannot be driven, such as a pivot or one
    with a nudge, are left out; why stands in the list.
    """
    files = _files(folder)
    edge = _edge(files)
    lines, left_out = [], []
    for found in _lines(files)[0]:
        try:
            lines.append(found.read(edge, 0.0))
        except PathError as error:
            left_out.append(str(error))
    return _frame(files[_ORIGIN.lower()]), lines, edge, left_out


def field_edge(folder: Path) -> list[Floats]:
    """Return a field folder's edge and its holes, (n, 2) latitude and longitude, degrees; errors as read_agopengps."""
    files = _files(folder)
    edge, frame = _edge(files), _frame(files[_ORIGIN.lower()])
    rings = [edge.ring, *edge.holes] if edge else []
    return [np.column_stack(plane_to_wgs84(ring[:, 0], ring[:, 1], frame)) for ring in rings]


def _files(folder: Path) -> dict[str, Path]:
    """Return a field folder's files by their names in small letters."""
    files = {file.name.lower(): file for file in sorted(folder.iterdir(), reverse=True) if file.is_file()}
    if _ORIGIN.lower() not in files:
        raise PathError(
            f"{folder}: has no {_ORIGIN}; give the folder of one AgOpenGPS field, which holds {_ORIGIN} and "
            f"{', '.join(FORMATS)}"
        )
    return files


def _edge(files: dict[str, Path]) -> Boundary | None:
    edge = files.get(_BOUNDARY.lower())
    return read_boundary(edge) if edge else None


def wgs84_to_plane(latitude: Floats, longitude: Floats, origin: LocalFrame) -> tuple[Floats, Floats]:
    """Return east and north (m, (n,)) on AgOpenGPS's plane of points in degrees; the inverse of plane_to_wgs84."""
    by_latitude, _ = _degree_lengths(np.full_like(latitude, origin.latitude))
    _, by_longitude = _degree_lengths(latitude)
    return _turned(longitude - origin.longitude) * by_longitude, (latitude - origin.latitude) * by_latitude


def plane_to_wgs84(east: Floats, north: Floats, origin: LocalFrame) -> tuple[Floats, Floats]:
    """Return latitude and longitude (degrees, (n,)) of points on AgOpenGPS's plane, m.

    The inverse of AgOpenGPS.Core/Models/Base/LocalPlane.cs: a degree of latitude is measured at the origin, a degree of
    longitude at the point.
    """
    latitude = origin.latitude + north / _degree_lengths(np.full_like(north, origin.latitude))[0]
    return latitude, _turned(origin.longitude + east / _degree_lengths(latitude)[1])


def _turned(longitude: Floats) -> Floats:
    """Return longitudes within ±180 degrees: a field may lie on the date line."""
    return longitude - 360.0 * np.round(longitude / 360.0)


def _degree_lengths(latitude: Floats) -> tuple[Floats, Floats]:
    """Return how long a degree of latitude and one of longitude are at latitudes (degrees), m."""
    phi = np.radians(latitude)
    north = 111132.92 - 559.82 * np.cos(2.0 * phi) + 1.175 * np.cos(4.0 * phi) - 0.0023 * np.cos(6.0 * phi)
    east = 111412.84 * np.cos(phi) - 93.5 * np.cos(3.0 * phi) + 0.118 * np.cos(5.0 * phi)
    return north, east


def _lines(files: dict[str, Path]) -> tuple[list[FoundLine], list[str]]:
    """Return the lines of all files, and what was looked for and found; newer files hold what older ones did, too."""
    lines: list[FoundLine] = []
    looked_for = []
    for name, find in FORMATS.items():
        file = files.get(name.lower())
        if file is None:
            looked_for.append(f"{name} is not there")
            continue
        found = find(file) if file.stat().st_size else []
        known = {line.name for line in lines}
        lines += [line for line in found if line.name not in known]
        looked_for.append(f"{file.name} has {len(found) or 'none'}")
    return lines, looked_for


def _frame(file: Path) -> LocalFrame:
    """Return the frame at the field's origin (latitude, longitude in degrees), where its metres count from."""
    text = read_text(file)
    rows = lines_of(text)
    if "StartFix" not in rows[:-1]:
        raise PathError(
            f"{file}: has no row 'StartFix' with the field's origin 'latitude,longitude' below; "
            f"give a field folder as AgOpenGPS writes it"
        )
    index = rows.index("StartFix") + 1
    latitude, longitude = numbers(rows[index], 2, f"{file}:{index + 1}")
    if index + 1 == len(rows) and text[-1] not in "\r\n":
        raise PathError(f"{file}:{index + 1}: the file ends within the origin; export the field from AgOpenGPS again")
    if not (abs(latitude) < 90.0 and abs(longitude) <= 180.0):
        raise PathError(f"{file}:{index + 1}: origin {rows[index]!r}; degrees within ±90 and ±180 are allowed")
    return LocalFrame(latitude=latitude, longitude=longitude)

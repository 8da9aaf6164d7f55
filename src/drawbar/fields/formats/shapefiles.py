"""Shapefiles: poly-lines and polygons with their .prj, read and written by pyshp; other projections by pyproj."""

import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pyproj
import shapefile

from drawbar.errors import PathError
from drawbar.fields.field import Degrees, Field, FieldLine, make_field
from drawbar.fields.formats.beside import beside
from drawbar.geometry import Floats

_NAMES = ("name", "line", "track", "designator", "label")
_BYTES = "latin-1"
"""a character for each byte"""
_EXACT = 1.0
"""m; as exactly as ETRS89, in which corrections are given, is WGS84"""
_WGS84 = (
    'GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],'
    'PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]]'
)


def read(path: Path) -> tuple[Field, ...]:
    """Return the lines of a .shp, or its first polygon as boundary; .dbf and .prj lie beside it.

    Raises:
        PathError: it cannot be read, or has no .dbf, or no .prj, without which the meaning of its numbers is unknown.
    """
    projection = _Projection(path)
    found = {suffix: beside(path, f"{path.stem}.{suffix}") for suffix in ("shp", "shx", "dbf")}
    if found["dbf"] is None:
        raise PathError(f"{path}: has no {path.stem}.dbf beside it, with the names of its lines; export it too")
    lines: list[tuple[str, Degrees]] = []
    boundary: Degrees | None = None
    left_out = []
    try:
        files = {suffix: io.BytesIO(file.read_bytes()) for suffix, file in found.items() if file is not None}
        with shapefile.Reader(**files, encoding=_BYTES) as reader:
            for item in reader.iterShapeRecords():
                name, shape = _name(item.record.as_dict()), item.shape
                kind = shape.shapeTypeName.removesuffix("Z").removesuffix("M")
                parts = [[*shape.parts, len(shape.points)][i : i + 2] for i in range(len(shape.parts))]
                pieces = [[point[:2] for point in shape.points[first:last]] for first, last in parts]
                if kind == "POLYLINE":
                    lines += [(name, projection.degrees(piece)) for piece in pieces]
                elif kind == "POLYGON" and boundary is None:
                    edge, besides = _edge(pieces)
                    boundary = projection.degrees(edge)
                    left_out += besides
                else:
                    left_out.append(f"{kind} {name}".strip())
    except Exception as error:  # of whatever kind: a damaged file fails anywhere in pyshp
        raise PathError(f"{path}: cannot be read as a shapefile: {error}; export it again") from None
    return (make_field(str(path), path.stem, lines, boundary, left_out + projection.left_out()),)


class _Projection:
    """What makes latitude and longitude of a file's own coordinates."""

    def __init__(self, path: Path) -> None:
        """Read the .prj beside a .shp; raises PathError where there is none, or it is none of the ground."""
        file = beside(path, f"{path.stem}.prj")
        if file is None:
            raise PathError(
                f"{path}: has no {path.stem}.prj beside it, so that nobody knows its projection; export it too"
            )
        try:
            self._system = pyproj.CRS.from_wkt(file.read_text("utf-8", "replace"))
            self._transformer = pyproj.Transformer.from_crs(self._system, "EPSG:4326", always_xy=True)
        except pyproj.exceptions.ProjError as error:
            raise PathError(f"{file}: is no projection that is known: {error}; export in WGS84") from None
        if not (self._system.is_geographic or self._system.is_projected):
            raise PathError(f"{file}: is no projection of the ground but {self._system.type_name}; export in WGS84")

    def degrees(self, points: Any) -> Degrees:
        """Return places of the file as latitude and longitude."""
        longitude, latitude = self._transformer.transform([x for x, _ in points], [y for _, y in points])
        return list(zip(latitude, longitude, strict=True))

    def left_out(self) -> list[str]:
        """Return what the places lack of exactness after they were converted, where that is more than a metre."""
        try:
            used = self._transformer.get_last_used_operation()
        except pyproj.exceptions.ProjError:  # there is one way only, or nothing was converted
            used = self._transformer
        if not used.accuracy > _EXACT:
            return []
        return [f"places to better than {used.accuracy:g} m, by the conversion from {self._system.name}"]


def _edge(rings: list[list[Any]]) -> tuple[list[Any], list[str]]:
    """Return the first outer ring of a polygon, and what else it holds.

    Rings may be in any order: outer ones go clockwise. Where none does, as some programs write it, the largest is one.
    """
    areas = [_area(ring) for ring in rings]
    outer = [index for index, area in enumerate(areas) if area < 0.0]
    edge = outer[0] if outer else max(range(len(rings)), key=areas.__getitem__)
    besides = ["Polygon"] * (len(outer) - 1)
    return rings[edge], besides + ["hole"] * (len(rings) - 1 - len(besides))


def _area(ring: list[Any]) -> float:
    """Return the area of a ring, positive where it goes counter-clockwise."""
    x, y = (np.array(ring) - ring[0]).T
    return float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2.0


def _name(record: dict[str, Any]) -> str:
    named = {key.lower(): value for key, value in record.items() if isinstance(value, str)}
    raw = next((named[key] for key in _NAMES if named.get(key)), "").encode(_BYTES)
    try:
        return raw.decode()
    except UnicodeDecodeError:  # of programs from before UTF-8
        return raw.decode("cp1252", "replace")


def write(field: Field) -> bytes:
    """Return a zip with NAME-lines.shp and, where there is a boundary, NAME-boundary.shp, and what lies beside them."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        if field.lines:
            _add(archive, f"{field.name}-lines", shapefile.POLYLINE, field.lines)
        if field.boundary is not None:
            ring = FieldLine(name=field.name, points=field.boundary)
            _add(archive, f"{field.name}-boundary", shapefile.POLYGON, (ring,))
    return content.getvalue()


def _add(archive: zipfile.ZipFile, name: str, kind: int, lines: tuple[FieldLine, ...]) -> None:
    files = {suffix: io.BytesIO() for suffix in ("shp", "shx", "dbf")}
    with shapefile.Writer(**files, shapeType=kind, encoding="utf-8") as writer:
        writer.field("name", "C", size=100)
        for line in lines:
            points = _longitude_first(line.points)
            if kind == shapefile.POLYGON:
                ring = points if _area(points) < 0.0 else points[::-1]  # an edge goes clockwise, a hole the other way
                writer.poly([[*ring, ring[0]]])
            else:
                writer.line([points])
            writer.record(line.name)
    for suffix, file in files.items():
        archive.writestr(f"{name}.{suffix}", file.getvalue())
    archive.writestr(f"{name}.prj", _WGS84)
    archive.writestr(f"{name}.cpg", "UTF-8")


def _longitude_first(points: Floats) -> list[list[float]]:
    turned: list[list[float]] = points[:, ::-1].tolist()
    return turned

"""GeoJSON (RFC 7946): lines as LineStrings with their "name", the boundary as a Polygon, alone or in a MultiPolygon."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from drawbar.errors import PathError
from drawbar.fields.field import Degrees, Field, make_field
from drawbar.geometry import Floats
from drawbar.guidance.importers.geojson import features_of, name_of, position, require_wgs84

_AREAS = ("Polygon", "MultiPolygon")


def read(path: Path) -> tuple[Field, ...]:
    """Return the field of a file; further polygons, holes and points are left out. Raises PathError with the place."""
    lines: list[tuple[str, Degrees]] = []
    boundary: Degrees | None = None
    left_out = []
    name, features = features_of(path)
    for called, geometry, place in _geometries(path, features):
        kind = geometry.get("type")
        if kind == "LineString":
            lines.append((called, _degrees(geometry.get("coordinates"), place)))
        elif kind == "MultiLineString":
            lines += [(called, _degrees(part, place)) for part in _list(geometry, place)]
        elif kind in _AREAS and boundary is None:
            boundary, besides = _edge(geometry, place)
            left_out += besides
        else:
            left_out.append(f"{kind} {called}".strip())
    return (make_field(str(path), name or path.stem, lines, boundary, left_out),)


def read_edge(path: Path) -> list[Floats]:
    """Return the boundary and its holes, (n, 2) latitude and longitude, degrees; none: empty. Errors as read."""
    for _, geometry, place in _geometries(path, features_of(path)[1]):
        if geometry.get("type") in _AREAS:
            rings = [_degrees(ring, place) for ring in _rings(geometry, place)[0]]
            fields = [make_field(str(path), "", (), ring) for ring in rings]
            return [field.boundary for field in fields if field.boundary is not None]
    return []


def _geometries(path: Path, features: list[Any]) -> Iterator[tuple[str, dict[str, Any], str]]:
    """Yield name, geometry and place of each feature that has a geometry; PathError: one is not in WGS84."""
    for index, feature in enumerate(features):
        geometry: Any = feature.get("geometry") if isinstance(feature, dict) and "geometry" in feature else feature
        place = f"{path}, feature {index}"
        if isinstance(geometry, dict):  # else a feature without a place, or none at all
            for member in (feature, geometry):
                require_wgs84(member, place)
            yield name_of(feature, ""), geometry, place


def _edge(geometry: dict[str, Any], place: str) -> tuple[Degrees, list[str]]:
    """Return the edge of a polygon, or of the first of several, and what else is there."""
    rings, others = _rings(geometry, place)
    edge = _degrees(rings[0] if rings else None, place)
    return edge, ["hole"] * (len(rings) - 1) + ["Polygon"] * others


def _rings(geometry: dict[str, Any], place: str) -> tuple[list[Any], int]:
    """Return the rings of a polygon, or of the first of several, and how many others there are."""
    polygons = _list(geometry, place) if geometry["type"] == "MultiPolygon" else [_list(geometry, place)]
    return polygons[0] if polygons and isinstance(polygons[0], list) else [], len(polygons) - 1


def _list(geometry: Any, place: str) -> list[Any]:
    found = geometry.get("coordinates")
    if not isinstance(found, list):
        raise PathError(f"{place}: 'coordinates' is no list")
    return found


def _degrees(positions: Any, place: str) -> Degrees:
    if not isinstance(positions, list):
        raise PathError(f"{place}: 'coordinates' is no list of positions")
    found = [position(each, f"{place}, position {index}") for index, each in enumerate(positions)]
    return [(latitude, longitude) for longitude, latitude in found]


def write(field: Field) -> bytes:
    """Return the field as a FeatureCollection."""
    features = [
        _feature({"type": "LineString", "coordinates": _positions(line.points)}, line.name) for line in field.lines
    ]
    if field.boundary is not None:
        ring = _positions(field.boundary)
        features.append(_feature({"type": "Polygon", "coordinates": [[*ring, ring[0]]]}, field.name))
    document = {"type": "FeatureCollection", "name": field.name, "features": features}
    return json.dumps(document, ensure_ascii=False, indent=1).encode()


def _feature(geometry: dict[str, Any], name: str) -> dict[str, Any]:
    return {"type": "Feature", "properties": {"name": name}, "geometry": geometry}


def _positions(points: Floats) -> list[list[float]]:
    return [[round(longitude, 9), round(latitude, 9)] for latitude, longitude in points.tolist()]

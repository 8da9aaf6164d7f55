"""GeoJSON (RFC 7946): LineStrings in WGS84 degrees, longitude first; a MultiLineString is several of them."""

import json
import re
import reprlib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drawbar.errors import PathError
from drawbar.geometry import LocalFrame
from drawbar.guidance.importers.line import RecordedLine, choose, on_frame
from drawbar.guidance.importers.text import read_text

_WGS84 = re.compile(r".*\bCRS84|.*\bEPSG\b.*\b4326", re.IGNORECASE)
"""the names that GeoJSON of before RFC 7946 gives to WGS84"""


def read_geojson(path: Path, track: str | None) -> RecordedLine:
    """Return a LineString of a geometry, Feature or FeatureCollection; None takes the only one.

    Lines are called by their "name" property, else by the file's name and their index; those of a MultiLineString
    also by their place in it, from the second on. Only the chosen one is checked. Raises PathError with the file and
    the place in it.
    """
    lines = _found(path)
    return _line(lines[choose(path, [line.name for line in lines], track)])


def geojson_names(path: Path) -> list[str]:
    """Return the names of all lines; errors as read_geojson."""
    return [line.name for line in _found(path)]


def _found(path: Path) -> "list[_Found]":
    """Return all lines, not yet looked at; at least one."""
    _, features = features_of(path)
    lines = [line for index, feature in enumerate(features) for line in _lines(path, index, feature)]
    if not lines:
        found = sorted({reprlib.repr(_type(_geometry(feature)) or "nothing") for feature in features})
        raise PathError(
            f"{path}: holds no LineString but {', '.join(found) or 'no feature'}; give each line as a LineString: "
            f"alone, as a Feature or in a FeatureCollection"
        )
    return lines


class _Found(NamedTuple):
    """A LineString, not yet looked at."""

    name: str
    geometry: dict[str, Any]
    place: str
    around: tuple[Any, ...]
    """the keys by which it may declare another system than WGS84"""


def _lines(path: Path, index: int, feature: Any) -> Iterator[_Found]:
    """Yield the lines of a feature: one, those of a MultiLineString, or none."""
    geometry = _geometry(feature)
    around, place = (feature, geometry), f"{path}, feature {index}"
    name = name_of(feature, f"{path.stem} {index}" if index else path.stem)
    if _type(geometry) == "LineString":
        yield _Found(name, geometry, place, around)
    elif _type(geometry) == "MultiLineString" and isinstance(parts := geometry.get("coordinates"), list):
        for number, part in enumerate(parts, 1):
            named = name if number == 1 else f"{name} ({number})"
            yield _Found(named, {"coordinates": part}, f"{place}, line {number}", around)


def features_of(path: Path) -> tuple[str, list[Any]]:
    """Return the name of a collection, empty where it has none, and its features; of other documents their one.

    Raises PathError for what is not JSON or not in WGS84.
    """
    try:
        document = json.loads(read_text(path), parse_int=float)
    except (json.JSONDecodeError, RecursionError) as error:
        raise PathError(f"{path}: is not valid JSON: {error}") from None
    if _type(document) != "FeatureCollection":
        return "", [document]
    require_wgs84(document, str(path))
    name = document.get("name")
    return name if isinstance(name, str) else "", _list(document, "features", str(path))


def _geometry(feature: Any) -> Any:
    return feature.get("geometry") if _type(feature) == "Feature" else feature


def name_of(feature: Any, otherwise: str) -> str:
    """Return the name of a feature, by its properties."""
    properties = feature.get("properties") if isinstance(feature, dict) else None
    name = properties.get("name") if isinstance(properties, dict) else None
    return name if isinstance(name, str) and name else otherwise


def _line(found: _Found) -> RecordedLine:
    """Return a line in metres, its first point being the origin."""
    name, geometry, place, around = found
    for member in around:
        require_wgs84(member, place)
    positions = _list(geometry, "coordinates", place)
    places = [f"{place}, position {index}" for index in range(len(positions))]
    degrees = np.array([position(*pair) for pair in zip(positions, places, strict=True)]).reshape(-1, 2)
    longitude = np.unwrap(degrees[:, 0], period=360.0)  # the line may cross the date line
    latitude = degrees[:, 1]
    if not positions:
        return RecordedLine.checked(name, degrees, [place])
    frame = LocalFrame(latitude=float(latitude[0]), longitude=float(longitude[0]))
    line = RecordedLine.checked(name, on_frame(latitude, longitude, frame, places), places)
    return replace(line, frame=frame)


def position(given: Any, place: str) -> list[float]:
    """Return longitude and latitude of one position, in degrees; raises PathError with the place."""
    numbers = isinstance(given, list) and len(given) >= 2
    if not numbers or not all(type(value) is float for value in given):
        raise PathError(f"{place}: is {reprlib.repr(given)}; [longitude, latitude] in degrees is needed")
    longitude, latitude = given[:2]
    if not (abs(longitude) <= 180.0 and abs(latitude) < 90.0):
        raise PathError(
            f"{place}: longitude {longitude:z.10g}, latitude {latitude:z.10g}; they must lie within ±180° and ±90°: "
            f"GeoJSON is WGS84 in degrees, longitude first"
        )
    return [longitude, latitude]


def require_wgs84(member: dict[str, Any], place: str) -> None:
    """Raise PathError for coordinates of another reference system than GeoJSON's own."""
    if "crs" not in member:
        return
    crs = member["crs"]
    properties = crs.get("properties") if isinstance(crs, dict) else None
    name = properties.get("name") if isinstance(properties, dict) else None
    if not (isinstance(name, str) and _WGS84.fullmatch(name)):
        raise PathError(
            f"{place}: its crs is {reprlib.repr(crs if name is None else name)}; only WGS84 is read (CRS84 or "
            f"EPSG:4326, longitude first): convert the file to EPSG:4326"
        )


def _type(value: Any) -> Any:
    return value.get("type") if isinstance(value, dict) else None


def _list(value: dict[str, Any], key: str, place: str) -> list[Any]:
    member = value.get(key)
    if not isinstance(member, list):
        raise PathError(f"{place}: {key!r} is {reprlib.repr(member)}; a list is needed")
    return member

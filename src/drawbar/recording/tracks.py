"""Tracks: path and driven tracks of a log as GeoJSON (RFC 7946), WGS84 degrees."""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from drawbar.errors import DrawbarError
from drawbar.geometry import Floats, LocalFrame
from drawbar.recording.log import RunLog


def write_geojson(log: RunLog, file: Path) -> None:
    """Write a LineString of the path, and of each body's estimated and, where it is known, true track.

    Raises:
        DrawbarError: it is not known where on Earth the path lies.
        OSError: the file cannot be written.
    """
    origin = log.header.origin
    if origin is None:
        raise DrawbarError(
            "it is not known where on Earth the path of this log lies: figure-eights and CSV files do not say. "
            "Export --csv instead, "
            "or drive a line that was recorded with its place"
        )
    frame = LocalFrame(latitude=origin[0], longitude=origin[1], height=origin[2])
    features = [_feature(name, x, y, frame) for name, x, y in _lines(log)]
    file.write_text(json.dumps({"type": "FeatureCollection", "features": features}, separators=(",", ":")), "utf-8")


def _lines(log: RunLog) -> Iterator[tuple[str, Floats, Floats]]:
    yield "path", log.header.path.x, log.header.path.y
    for source in ("estimate", "truth"):
        for body in ("tractor", "trailer"):
            x, y = log.column(f"{source}.{body}.x"), log.column(f"{source}.{body}.y")
            known = np.isfinite(x) & np.isfinite(y)
            if known.sum() > 1:
                yield f"{body} {source}", x[known], y[known]


def _feature(name: str, x: Floats, y: Floats, frame: LocalFrame) -> dict[str, object]:
    latitude, longitude = frame.level(x, y)
    points = [
        [round(east, 9), round(north, 9)] for east, north in zip(longitude.tolist(), latitude.tolist(), strict=True)
    ]
    geometry = {"type": "LineString", "coordinates": points}
    return {"type": "Feature", "properties": {"name": name}, "geometry": geometry}

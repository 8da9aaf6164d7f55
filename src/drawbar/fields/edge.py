"""The edge of the field in which a line lies, from the file that holds the line."""

from pathlib import Path

import numpy as np

from drawbar.fields.formats import geojson
from drawbar.geometry import Floats, LocalFrame
from drawbar.guidance.importers.agopengps import field_edge
from drawbar.guidance.importers.line import on_frame
from drawbar.guidance.importers.load import field_folder


def load_edge(path: Path, frame: LocalFrame) -> Floats | None:
    """Return the ring (n, 2) of an AgOpenGPS field folder or a GeoJSON file on a frame, m; None: it holds none.

    The last point joins the first. Holes in it are not looked at.

    Raises:
        PathError: the boundary is not as the format has it, or not on Earth, or too far from the frame's origin.
    """
    folder = field_folder(path)
    edge = field_edge(folder) if folder else geojson.read_edge(path) if path.suffix.lower() != ".csv" else None
    if edge is None:
        return None
    latitude, longitude = np.asarray(edge)
    return on_frame(latitude, longitude, frame, [f"{path}: the boundary"] * len(latitude))

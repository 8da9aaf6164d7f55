"""The edge of the field in which a line lies, from the file that holds the line."""

from dataclasses import dataclass
from pathlib import Path

from drawbar.fields.formats import geojson
from drawbar.geometry import Floats, LocalFrame
from drawbar.guidance.importers.agopengps import field_edge
from drawbar.guidance.importers.line import on_frame
from drawbar.guidance.importers.load import field_folder


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldEdge:
    """Where a field ends, on a plane."""

    ring: Floats
    """(n, 2), m; the last point joins the first"""
    holes: tuple[Floats, ...] = ()
    """rings within it that are not driven into"""


def load_edge(path: Path, frame: LocalFrame) -> FieldEdge | None:
    """Return the edge in an AgOpenGPS field folder or a GeoJSON file, on a frame; None: it holds none.

    Raises:
        PathError: the boundary is not as the format has it, or not on Earth, or too far from the frame's origin.
    """
    folder = field_folder(path)
    if folder is None and path.suffix.lower() == ".csv":
        return None
    rings = field_edge(folder) if folder else geojson.read_edge(path)
    place = f"{path}: the boundary"
    found = [on_frame(each[:, 0], each[:, 1], frame, [place] * len(each)) for each in rings]
    return FieldEdge(ring=found[0], holes=tuple(found[1:])) if found else None

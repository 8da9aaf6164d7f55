"""Loading a line, of any format: a file or folder and, where it holds several lines, the name of one."""

from pathlib import Path

from drawbar.errors import PathError
from drawbar.guidance.importers.agopengps import read_agopengps
from drawbar.guidance.importers.agopengps_lines import FORMATS
from drawbar.guidance.importers.csv import read_csv
from drawbar.guidance.importers.geojson import read_geojson
from drawbar.guidance.importers.line import RecordedLine

LINE_FILES = {name.lower() for name in FORMATS}
_READERS = {".csv": read_csv, ".geojson": read_geojson, ".json": read_geojson}


def load_line(path: Path, track: str | None, extension: float = 0.0) -> RecordedLine:
    """Return the line `track` of a field folder, CSV or GeoJSON file; None takes the only one.

    `extension` is how far A-B lines continue, m; 0: to the field's boundary. The points of a file's other lines are not
    looked at. Raises PathError when nothing readable is there, or when the name is missing, unknown or not unique.
    """
    if path.is_dir():
        return read_agopengps(path, track, extension)
    if path.name.lower() in LINE_FILES:
        return read_agopengps(path.parent, track, extension)
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        types = ", ".join(_READERS)
        if not path.exists():
            raise PathError(f"{path}: does not exist; give an AgOpenGPS field folder or a file of type {types}")
        raise PathError(f"{path}: is neither an AgOpenGPS field folder nor a file of type {types}; give one of these")
    return reader(path, track)

"""Loading a line, of any format: a file or folder and, where it holds several lines, the name of one."""

from collections.abc import Callable
from pathlib import Path

from drawbar.errors import PathError
from drawbar.guidance.importers.agopengps import agopengps_names, read_agopengps
from drawbar.guidance.importers.agopengps_lines import FORMATS
from drawbar.guidance.importers.csv import read_csv
from drawbar.guidance.importers.geojson import geojson_names, read_geojson
from drawbar.guidance.importers.line import RecordedLine

LINE_FILES = {name.lower() for name in FORMATS}
_READERS = {".csv": read_csv, ".geojson": read_geojson, ".json": read_geojson}


def load_line(path: Path, track: str | None, extension: float = 0.0) -> RecordedLine:
    """Return the line `track` of a field folder, CSV or GeoJSON file; None takes the only one.

    `extension` is how far A-B lines continue, m; 0: to the field's boundary. The points of a file's other lines are not
    looked at. Raises PathError when nothing readable is there, or when the name is missing, unknown or not unique.
    """
    folder = field_folder(path)
    if folder is not None:
        return read_agopengps(folder, track, extension)
    return _reader(path)(path, track)


def line_names(path: Path) -> list[str]:
    """Return the names of all lines of a field folder, CSV or GeoJSON file; errors as load_line."""
    folder = field_folder(path)
    if folder is not None:
        return agopengps_names(folder)
    return geojson_names(path) if _reader(path) is read_geojson else [path.stem]


def field_folder(path: Path) -> Path | None:
    """Return the field folder that a path names, or one of whose files; None: it names another file."""
    if path.is_dir():
        return path
    return path.parent if path.name.lower() in LINE_FILES else None


def _reader(path: Path) -> Callable[[Path, str | None], RecordedLine]:
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        types = ", ".join(_READERS)
        if not path.exists():
            raise PathError(f"{path}: does not exist; give an AgOpenGPS field folder or a file of type {types}")
        raise PathError(
            f"{path}: is neither an AgOpenGPS field folder nor a file of type {types}; give one of these (the "
            "console's fields page imports other types, and keeps them as GeoJSON)"
        )
    return reader

"""Exchange of fields, in any format: files of other programs in, files for other programs out."""

import io
import tempfile
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path, PurePosixPath

from drawbar.errors import PathError
from drawbar.fields.field import Field, make_field
from drawbar.fields.formats import agopengps, csv, geojson, gpx, isoxml, kml, shapefiles
from drawbar.geometry import LocalFrame

_LARGEST, _MOST = 1 << 26, 1000
"""bytes and files of an archive, unpacked"""
_TASK_DATA = "taskdata.xml"
_ORIGIN = "field.txt"
_READERS: Mapping[str, Callable[[Path], tuple[Field, ...]]] = {
    ".geojson": geojson.read,
    ".json": geojson.read,
    ".kml": kml.read,
    ".gpx": gpx.read,
    ".shp": shapefiles.read,
    ".xml": isoxml.read,
}
WRITERS: Mapping[str, tuple[str, Callable[[Field], bytes]]] = {
    "GeoJSON": (".geojson", geojson.write),
    "KML": (".kml", kml.write),
    "GPX": (".gpx", gpx.write),
    "CSV": (".csv", csv.write),
    "Shapefile": (".zip", shapefiles.write),
    "ISOXML 4": (".xml", partial(isoxml.write, version=4)),
    "ISOXML 3": (".xml", partial(isoxml.write, version=3)),
    "AgOpenGPS": (".zip", agopengps.write),
}
"""by name: how the file ends, and what writes it. GPX and CSV hold lines only"""
KINDS = ("AgOpenGPS", "ISOXML", "Shapefile", "KML", "GPX", "GeoJSON", "CSV")
"""what is read; a folder of several files as .zip"""


def read_fields(path: Path, frame: LocalFrame) -> tuple[Field, ...]:
    """Return the fields of a file, or of an AgOpenGPS folder.

    Args:
        path: of a type that is known.
        frame: from whose origin the metres of a CSV file count.

    Raises:
        PathError: nothing readable is there; names what, where and what to do.
    """
    if path.is_dir():
        return agopengps.read(path)
    if path.suffix.lower() == ".csv":
        return csv.read(path, frame)
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise PathError(
            f"{path.name}: is of none of the types {', '.join(_READERS)}, .csv, .kmz and .zip; give one of these"
        )
    return reader(path)


def take_in(name: str, data: bytes, frame: LocalFrame) -> tuple[Field, ...]:
    """Return the fields of a file that was handed over; all shapefiles of one archive are one field.

    Args:
        name: of the file.
        data: its content.
        frame: from whose origin the metres of a CSV file count.

    Raises:
        PathError: nothing readable is there; names what, where and what to do.
    """
    with tempfile.TemporaryDirectory(prefix="drawbar-import-") as folder:
        try:
            paths = unpack(name, data, Path(folder))
            read = [field for path in paths for field in read_fields(path, frame)]
        except PathError as error:  # the error does not name the folder
            raise PathError(str(error).replace(f"{folder}/", "")) from None
    found = [replace(each, left_out=tuple(what.replace(f"{folder}/", "") for what in each.left_out)) for each in read]
    fields = [field for field in found if not field.is_empty]
    if not fields:
        besides = ", ".join(each for field in found for each in field.left_out)
        if besides:
            raise PathError(f"{name}: holds neither a line nor a boundary but {besides}")
        raise PathError(f"{name}: holds neither a line nor a boundary")
    if all(path.suffix.lower() == ".shp" for path in paths):
        return (_joined(name, fields),)
    unnamed = Path(folder).name  # of an AgOpenGPS field whose files lie in an archive without their folder
    return tuple(replace(field, name=Path(name).stem) if field.name == unnamed else field for field in fields)


def _joined(name: str, fields: Sequence[Field]) -> Field:
    """Return one field of the first boundary and all lines of several; the name is that of their archive."""
    boundary = next((field.boundary for field in fields if field.boundary is not None), None)
    lines = [(line.name, [(p[0], p[1]) for p in line.points.tolist()]) for field in fields for line in field.lines]
    ring = [(p[0], p[1]) for p in boundary.tolist()] if boundary is not None else None
    # a message about several files, such as their common projection, stands once
    left_out = list(dict.fromkeys(each for field in fields for each in field.left_out))
    return make_field(name, Path(name).stem, lines, ring, left_out)


def unpack(name: str, data: bytes, folder: Path) -> list[Path]:
    """Put a file that was handed over into an empty folder; return what there is to read.

    Names of an archive that lead out of it are cut; hidden files in it, such as those of macOS, are not looked at.

    Raises:
        PathError: the archive is broken, too large, or holds nothing that can be read.
    """
    plain = PurePosixPath(name.replace("\\", "/")).name
    if Path(plain).suffix.lower() not in (".zip", ".kmz"):
        try:
            (folder / plain).write_bytes(data)
        except (OSError, ValueError) as error:
            raise PathError(f"{plain!r} cannot be the name of a file ({error}); rename it") from None
        return [folder / plain]
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            entries = archive.infolist()
            if len(entries) > _MOST or sum(each.file_size for each in entries) > _LARGEST:
                raise PathError(f"{plain}: holds more than {_MOST} files or {_LARGEST >> 20} MiB; pack the field alone")
            for entry in entries:
                entry.filename = entry.filename.replace("\\", "/")
                archive.extract(entry, folder)
    except PathError:
        raise
    except Exception as error:  # of whatever kind: a damaged archive fails anywhere in zipfile and its decompressors
        raise PathError(f"{plain}: cannot be unpacked: {error}; pack it again") from None
    return _readable(folder, plain)


def _readable(folder: Path, name: str) -> list[Path]:
    """Return folders of AgOpenGPS and other files; of .xml only task data, unless there is nothing but other .xml.

    Programs put .xml files of their own beside a shapefile, and AgOpenGPS its fields in other formats below a field.
    """
    files = sorted(each for each in folder.rglob("*") if each.is_file() and not each.name.startswith("."))
    fields = sorted({each.parent for each in files if each.name.lower() == _ORIGIN})
    known = [each for each in files if each.suffix.lower() in (*_READERS, ".csv") and not {*fields} & {*each.parents}]
    tasks = [each for each in known if each.name.lower() == _TASK_DATA]
    others = [each for each in known if each.suffix.lower() != ".xml"]
    found = [*fields, *(tasks or others)] or known
    if not found:
        raise PathError(
            f"{name}: holds no field; a folder of AgOpenGPS, TASKDATA.XML, or .shp, .kml, .gpx, .geojson, .csv"
        )
    return found

"""GPX 1.0 and 1.1: tracks and routes, as hand-held receivers write them. GPX has no boundaries."""

from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

from drawbar.fields.field import Degrees, Field, make_field
from drawbar.fields.formats.xml import attribute, parse, require_root, text_of
from drawbar.fields.formats.xml import write as write_xml


def read(path: Path) -> tuple[Field, ...]:
    """Return each segment of each track, and each route, as a line; waypoints are left out. Raises PathError."""
    root = parse(path)
    require_root(root, "gpx", path, "GPX")
    lines: list[tuple[str, Degrees]] = []
    for track in root.iter("trk"):
        lines += [(text_of(track, "name"), _degrees(each, "trkpt", path)) for each in track.iter("trkseg")]
    lines += [(text_of(route, "name"), _degrees(route, "rtept", path)) for route in root.iter("rte")]
    name = text_of(root, "metadata/name") or text_of(root, "name")
    left_out = [f"waypoint {text_of(each, 'name')}".strip() for each in root.iter("wpt")]
    return (make_field(str(path), name or path.stem, lines, left_out=left_out),)


def _degrees(parent: Element, tag: str, path: Path) -> Degrees:
    return [(attribute(each, "lat", str(path)), attribute(each, "lon", str(path))) for each in parent.iter(tag)]


def write(field: Field) -> bytes:
    """Return the field's lines as tracks; its boundary is not written."""
    root = Element("gpx", xmlns="http://www.topografix.com/GPX/1/1", version="1.1", creator="drawbar")
    SubElement(SubElement(root, "metadata"), "name").text = field.name
    for line in field.lines:
        track = SubElement(root, "trk")
        SubElement(track, "name").text = line.name
        segment = SubElement(track, "trkseg")
        for latitude, longitude in line.points.tolist():
            SubElement(segment, "trkpt", lat=f"{latitude:.9f}", lon=f"{longitude:.9f}")
    return write_xml(root)

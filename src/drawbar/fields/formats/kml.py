"""KML 2.2 and KMZ: Placemarks with a LineString, a Polygon or a gx:Track; longitude, latitude, height.

Twenty lines each way on the standard library's XML. The libraries that there are (fastkml, simplekml) model styles,
overlays and time, of which a field has none.
"""

from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

from drawbar.errors import PathError
from drawbar.fields.field import Degrees, Field, make_field
from drawbar.fields.formats.xml import parse, require_root, text_of
from drawbar.fields.formats.xml import write as write_xml
from drawbar.geometry import Floats


def read(path: Path) -> tuple[Field, ...]:
    """Return the field of a file; the first polygon is its boundary. Raises PathError with the Placemark's name."""
    root = parse(path)
    require_root(root, "kml", path, "KML")
    lines: list[tuple[str, Degrees]] = []
    boundary: Degrees | None = None
    left_out = [f"NetworkLink {text_of(each, 'name')}".strip() for each in root.iter("NetworkLink")]
    for placemark in root.iter("Placemark"):
        name = text_of(placemark, "name")
        place = f"{path}: Placemark {name!r}"
        found = [each for each in placemark.iter() if each.tag in ("LineString", "Polygon", "Track", "Point")]
        for shape in found:
            if shape.tag == "LineString":
                lines.append((name, _degrees(text_of(shape, "coordinates"), place)))
            elif shape.tag == "Track":
                lines.append((name, _degrees(_track(shape), place)))
            elif shape.tag == "Polygon" and boundary is None:
                ring = shape.find("outerBoundaryIs/LinearRing")
                boundary = _degrees(text_of(ring, "coordinates") if ring is not None else "", place)
                left_out += ["hole"] * len(shape.findall("innerBoundaryIs/LinearRing"))
            else:
                left_out.append(f"{shape.tag} {name}".strip())
    document = root.find("Document")
    name = text_of(document, "name") if document is not None else ""
    return (make_field(str(path), name or path.stem, lines, boundary, left_out),)


def _track(track: Element) -> str:
    """Return the places of a gx:Track as other shapes have them, with commas."""
    return " ".join(",".join((each.text or "").split()) for each in track.findall("coord"))


def _degrees(text: str, place: str) -> Degrees:
    points = []
    for tuple_ in text.split():
        cells = tuple_.split(",")
        try:
            points.append((float(cells[1]), float(cells[0])))
        except (ValueError, IndexError):
            raise PathError(f"{place}: {tuple_!r} is no longitude,latitude in degrees") from None
    return points


def write(field: Field) -> bytes:
    """Return the field as a document."""
    root = Element("kml", xmlns="http://www.opengis.net/kml/2.2")
    document = SubElement(root, "Document")
    SubElement(document, "name").text = field.name
    for line in field.lines:
        shape = SubElement(_placemark(document, line.name), "LineString")
        SubElement(shape, "tessellate").text = "1"
        SubElement(shape, "coordinates").text = _tuples(line.points)
    if field.boundary is not None:
        shape = SubElement(_placemark(document, field.name), "Polygon")
        ring = SubElement(SubElement(shape, "outerBoundaryIs"), "LinearRing")
        closed = [*field.boundary, field.boundary[0]]
        SubElement(ring, "coordinates").text = " ".join(_tuples(point.reshape(1, 2)) for point in closed)
    return write_xml(root)


def _placemark(document: Element, name: str) -> Element:
    placemark = SubElement(document, "Placemark")
    SubElement(placemark, "name").text = name
    return placemark


def _tuples(points: Floats) -> str:
    return " ".join(f"{longitude:.9f},{latitude:.9f},0" for latitude, longitude in points.tolist())

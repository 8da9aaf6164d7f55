"""ISOXML (ISO 11783-10), versions 3 and 4: partfields with boundary and guidance lines, in TASKDATA.XML.

Version 4 has guidance groups (GGP) of patterns (GPN: B name, C type), each with its line (LSG, A = 5); in version 3 the
line (LSG, A = 5, B name) belongs to the partfield (PFD) itself. A point (PNT) has C = latitude and D = longitude. The
libraries that there are have one author and model the whole task file, of which a field is a small part.
"""

import math
import re
from pathlib import Path
from typing import Literal
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from drawbar.errors import PathError
from drawbar.fields.field import Degrees, Field, make_field
from drawbar.fields.formats.beside import beside
from drawbar.fields.formats.xml import attribute, parse, require_root
from drawbar.fields.formats.xml import write as write_xml
from drawbar.fields.lines import AHEAD, on_earth, on_plane
from drawbar.geometry import LocalFrame

_ROOT = "ISO11783_TaskData"
_AB, _A_AND_HEADING, _CURVE = "1", "2", "3"
_KINDS = {_AB: "A-B", _A_AND_HEADING: "A+", _CURVE: "curve", "4": "pivot", "5": "spiral"}
_OF_PARTFIELDS = re.compile(r"PFD\d{5}")
_GUIDANCE = "5"
"""type of a line string: guidance pattern"""
_BOUNDARY, _EXTERIOR, _INTERIOR = "1", "1", "2"
"""types of a polygon and of its line strings"""
_A, _B, _OTHER, _POINT = "6", "7", "2", "9"
"""types of points; version 3 has neither A nor B"""


def read(path: Path) -> tuple[Field, ...]:
    """Return all partfields of a TASKDATA.XML, and of the files that it refers to; pivots and spirals are left out.

    Patterns of one name but another type are distinguished by the type in brackets. Raises PathError with the
    partfield.
    """
    root = parse(path)
    require_root(root, _ROOT, path, "ISOXML")
    return tuple(_field(partfield, path) for each in (root, *_further(root, path)) for partfield in each.findall("PFD"))


def _further(root: Element, path: Path) -> list[Element]:
    """Return the roots of the files of partfields that a task file refers to; raises PathError where one is missing."""
    roots = []
    for name in filter(_OF_PARTFIELDS.fullmatch, (each.get("A", "") for each in root.findall("XFR"))):
        file = beside(path, f"{name}.XML")
        if file is None:
            raise PathError(f"{path}: refers to {name}.XML, which is not beside it; give the folder TASKDATA as .zip")
        roots.append(parse(file))
        require_root(roots[-1], "XFC", file, "a further file of ISOXML")
    return roots


def _field(partfield: Element, path: Path) -> Field:
    name = partfield.get("C") or partfield.get("A") or ""
    place = f"{path}: partfield {name!r}"
    patterns = list(partfield.iter("GPN"))
    kinds: dict[str, set[str]] = {}
    for pattern in patterns:
        kinds.setdefault(pattern.get("B", ""), set()).add(pattern.get("C", ""))
    lines: list[tuple[str, Degrees]] = []
    left_out = []
    for pattern in patterns:
        called, kind = pattern.get("B", ""), pattern.get("C", "")
        word = _KINDS.get(kind, f"type {kind}")
        if kind not in (_AB, _A_AND_HEADING, _CURVE):
            left_out.append(f"{word} {called}".strip())
            continue
        unique = f"{called} ({word})" if len(kinds[called]) > 1 else called
        lines.append((unique, _pattern(pattern, kind, place)))
    lines += [(each.get("B", ""), _degrees(each, place)) for each in partfield.findall(f"LSG[@A='{_GUIDANCE}']")]
    edges = [each.find(f"LSG[@A='{_EXTERIOR}']") for each in partfield.findall(f"PLN[@A='{_BOUNDARY}']")]
    rings = [each for each in edges if each is not None]
    left_out += ["polygon"] * (len(rings) - 1)
    left_out += ["hole"] * len(partfield.findall(f"PLN[@A='{_BOUNDARY}']/LSG[@A='{_INTERIOR}']"))
    return make_field(str(path), name, lines, _degrees(rings[0], place) if rings else None, left_out)


def _pattern(pattern: Element, kind: str, place: str) -> Degrees:
    """Return the points of a pattern: of an A-B line both ends, of a curve all."""
    string = pattern.find("LSG")
    points = _degrees(string, place) if string is not None else []
    if kind == _A_AND_HEADING and points:
        compass = math.radians(attribute(pattern, "G", place))
        frame = LocalFrame(latitude=points[0][0], longitude=points[0][1])
        ahead = np.array([[AHEAD * math.sin(compass), AHEAD * math.cos(compass)]])
        latitude, longitude = on_earth(ahead, frame)[0].tolist()
        return [points[0], (latitude, longitude)]
    return [points[0], points[-1]] if kind == _AB and len(points) > 2 else points


def _degrees(string: Element, place: str) -> Degrees:
    return [(attribute(each, "C", place), attribute(each, "D", place)) for each in string.findall("PNT")]


def write(field: Field, version: Literal[3, 4]) -> bytes:
    """Return a TASKDATA.XML of one partfield in version 3 or 4."""
    root = Element(
        _ROOT,
        VersionMajor=str(version),
        VersionMinor="0",
        ManagementSoftwareManufacturer="drawbar",
        ManagementSoftwareVersion="1",
        DataTransferOrigin="1",
    )
    area = _area(field)
    partfield = SubElement(root, "PFD", A="PFD1", C=field.name[:32], D=str(area))
    if field.boundary is not None:
        polygon = SubElement(partfield, "PLN", A=_BOUNDARY, C=str(area))
        _points(SubElement(polygon, "LSG", A=_EXTERIOR), [*field.boundary.tolist(), field.boundary[0].tolist()], {})
    for number, line in enumerate(field.lines, 1):
        name, points = line.name[:32], line.points.tolist()
        if version == 3:
            _points(SubElement(partfield, "LSG", A=_GUIDANCE, B=name), points, {})
            continue
        group = SubElement(partfield, "GGP", A=f"GGP{number}", B=name)
        kind, extension = (_AB, "1") if line.is_straight else (_CURVE, "4")
        pattern = SubElement(group, "GPN", A=f"GPN{number}", B=name, C=kind, E="2", F=extension, I="16")
        _points(SubElement(pattern, "LSG", A=_GUIDANCE), points, {0: _A, len(points) - 1: _B})
    return write_xml(root)


def _points(string: Element, points: list[list[float]], special: dict[int, str]) -> None:
    for index, (latitude, longitude) in enumerate(points):
        kind = special.get(index, _POINT if special else _OTHER)
        SubElement(string, "PNT", A=kind, C=f"{latitude:.9f}", D=f"{longitude:.9f}")


def _area(field: Field) -> int:
    """Return the area within the boundary, m²; 0 where there is none."""
    if field.boundary is None:
        return 0
    x, y = on_plane(field.boundary, field.frame()).T
    return round(abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))) / 2.0)

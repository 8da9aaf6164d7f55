"""ISOXML beside another program's library (isoxml of Josephinum Research): it reads what is written, and is read."""

from decimal import Decimal
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

pytest.importorskip("shapely", reason="the extra `console` is not installed")
pytest.importorskip("isoxml", reason="isoxml, which reads and writes ISOXML for comparison, is not installed")

import isoxml.models.base.v3 as iso3
import isoxml.models.base.v4 as iso4
from isoxml.util.isoxml_io import isoxml_from_text, isoxml_to_text

from drawbar.fields.exchange import WRITERS, read_fields
from drawbar.fields.field import Field, FieldLine
from drawbar.fields.lines import on_earth
from drawbar.geometry import Floats, LocalFrame

FRAME = LocalFrame(latitude=50.8642, longitude=4.6781)
ANGLE = np.linspace(0.0, 1.5, 20)
FIELD = Field(
    name="Große Wiese",
    lines=(
        FieldLine(name="AB 80°", points=on_earth(np.array([[0.0, 0.0], [100.0, 17.0]]), FRAME)),
        FieldLine(name="Süd", points=on_earth(40.0 * np.column_stack([np.sin(ANGLE), 1.0 - np.cos(ANGLE)]), FRAME)),
    ),
    boundary=on_earth(np.array([[-10.0, -10.0], [120.0, -10.0], [120.0, 90.0]]), FRAME),
)
CLOSE = 1e-8
"""degrees; 1 mm"""
VERSIONS = {3: iso3, 4: iso4}
GUIDANCE = {3: iso3.LineStringType.GuidancePath, 4: iso4.LineStringType.GuidancePattern}


def degrees(line) -> Floats:
    return np.array([[float(point.north), float(point.east)] for point in line.points])


@pytest.mark.parametrize("version", VERSIONS)
def test_the_library_reads_what_is_written(version: int) -> None:
    data = isoxml_from_text(WRITERS[f"ISOXML {version}"][1](FIELD).decode())
    assert int(data.version_major.value) == version
    (found,) = data.partfields
    assert found.designator == FIELD.name
    np.testing.assert_allclose(degrees(found.polygons[0].line_strings[0])[:3], FIELD.boundary, atol=CLOSE)
    if version == 4:
        patterns = [pattern for group in found.guidance_groups for pattern in group.guidance_patterns]
        kinds = iso4.GuidancePatternType
        assert [pattern.type for pattern in patterns] == [kinds.AB, kinds.Curve]
        lines = [(pattern.designator, pattern.line_strings[0]) for pattern in patterns]
    else:
        assert {line.type for line in found.line_strings} == {GUIDANCE[3]}
        lines = [(line.designator, line) for line in found.line_strings]
    assert [name for name, _ in lines] == [line.name for line in FIELD.lines]
    for (_, line), given in zip(lines, FIELD.lines, strict=True):
        np.testing.assert_allclose(degrees(line), given.points, atol=CLOSE)


@pytest.mark.parametrize("version", VERSIONS)
def test_what_the_library_writes_is_read(version: int, tmp_path: Path) -> None:
    (tmp_path / "TASKDATA.XML").write_text(isoxml_to_text(task_data(VERSIONS[version], version)), "utf-8")
    (found,) = read_fields(tmp_path / "TASKDATA.XML", FRAME)
    assert found.name == FIELD.name
    np.testing.assert_allclose(found.boundary, FIELD.boundary, atol=CLOSE)
    assert [line.name for line in found.lines] == [line.name for line in FIELD.lines]
    for line, given in zip(found.lines, FIELD.lines, strict=True):
        np.testing.assert_allclose(line.points, given.points, atol=CLOSE)


def task_data(iso: ModuleType, version: int):
    """Return the field in the library's own classes."""
    ring = string(iso, iso.LineStringType.PolygonExterior, FIELD.boundary)
    boundary = iso.Polygon(type=iso.PolygonType.PartfieldBoundary, line_strings=[ring])
    guides = [string(iso, GUIDANCE[version], line.points) for line in FIELD.lines]
    more = {}
    if version == 4:
        types = (iso.GuidancePatternType.AB, iso.GuidancePatternType.Curve)
        patterns = [
            iso.GuidancePattern(id=f"GPN{n}", designator=line.name, type=types[n], line_strings=[guides[n]])
            for n, line in enumerate(FIELD.lines)
        ]
        more["guidance_groups"] = [iso.GuidanceGroup(id="GGP1", designator="lines", guidance_patterns=patterns)]
    else:
        for guide, line in zip(guides, FIELD.lines, strict=True):
            guide.designator = line.name
        more["line_strings"] = guides
    return iso.Iso11783TaskData(
        management_software_manufacturer="x",
        management_software_version="1",
        data_transfer_origin=iso.Iso11783TaskDataDataTransferOrigin.FMIS,
        partfields=[iso.Partfield(id="PFD1", designator=FIELD.name, area=1, polygons=[boundary], **more)],
    )


def string(iso: ModuleType, kind, points: Floats):
    places = [
        iso.Point(type=iso.PointType.Other, north=round(Decimal(north), 9), east=round(Decimal(east), 9))
        for north, east in points.tolist()
    ]
    return iso.LineString(type=kind, points=places)

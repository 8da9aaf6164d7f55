"""Formats of fields: each written, read again, and read or written by another program's library (GDAL) too."""

import io
import math
import struct
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

pytest.importorskip("shapely", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")
pytest.importorskip("pyproj", reason="the extra `console` is not installed")

from drawbar.errors import PathError
from drawbar.fields.exchange import WRITERS, read_fields, take_in, unpack
from drawbar.fields.field import Field, FieldLine
from drawbar.fields.lines import on_earth, on_plane
from drawbar.geometry import LocalFrame

FRAME = LocalFrame(latitude=50.8642, longitude=4.6781)
TURN = np.linspace(0.0, math.pi / 2.0, 30)
CURVE = np.column_stack([40.0 * np.sin(TURN), 40.0 - 40.0 * np.cos(TURN)])
RING = np.array([[-10.0, -10.0], [120.0, -10.0], [120.0, 90.0], [-10.0, 90.0]])
ENDS = np.array([[0.0, 0.0], [100.0, 17.0]])
FIELD = Field(
    name="Große Wiese",
    lines=(
        FieldLine(name="AB 80°", points=on_earth(ENDS, FRAME)),
        FieldLine(name="Cu, Süd", points=on_earth(CURVE, FRAME)),
    ),
    boundary=on_earth(RING, FRAME),
)
WITHOUT_BOUNDARY = ("GPX", "CSV")
GDAL = {"GeoJSON": "GeoJSON", "KML": "KML", "GPX": "GPX", "CSV": "CSV", "Shapefile": "ESRI Shapefile"}
CLOSE = 1e-8
"""degrees; 1 mm"""


def taken_in(kind: str, data: bytes, folder: Path) -> list[Field]:
    found = unpack(f"field{WRITERS[kind][0]}", data, folder)
    return [field for path in found for field in read_fields(path, FRAME)]


@pytest.mark.parametrize("kind", WRITERS)
def test_what_is_written_is_read_again(kind: str, tmp_path: Path) -> None:
    fields = taken_in(kind, WRITERS[kind][1](FIELD), tmp_path)
    lines = [line for field in fields for line in field.lines]
    assert [line.name for line in lines] == [line.name for line in FIELD.lines]
    by_agopengps = kind == "AgOpenGPS"
    curves = lines[1:] if by_agopengps else lines
    for line, given in zip(curves, FIELD.lines[by_agopengps:], strict=True):
        np.testing.assert_allclose(line.points, given.points, atol=CLOSE)
    if by_agopengps:  # an A-B line goes from edge to edge there
        across = on_plane(lines[0].points, FRAME)
        np.testing.assert_allclose(across[:, 0], [-10.0, 120.0], atol=2e-3)
        np.testing.assert_allclose(across[:, 1], [-1.7, 20.4], atol=2e-3)
    rings = [field.boundary for field in fields if field.boundary is not None]
    if kind in WITHOUT_BOUNDARY:
        assert rings == []
    else:
        (ring,) = rings
        assert {tuple(np.round(point, 7)) for point in ring} == {tuple(np.round(point, 7)) for point in FIELD.boundary}


def coordinates(shape: bytes) -> list[tuple[float, float]]:
    """Return the points of the first part of well-known binary, any of its heights left out."""
    kind = struct.unpack_from("<I", shape, 1)[0]
    flat, width = (kind & 0xFF) % 1000, 3 if kind & 0x80000000 or kind > 1000 else 2
    start = {2: 5, 3: 9, 5: 9}[flat]
    if flat == 5:
        return coordinates(shape[start:])
    count = struct.unpack_from("<I", shape, start)[0]
    numbers = struct.unpack_from(f"<{count * width}d", shape, start + 4)
    return [(numbers[i], numbers[i + 1]) for i in range(0, len(numbers), width)]


@pytest.mark.filterwarnings("ignore:The 'generic' unit:DeprecationWarning")  # pyogrio beside numpy 2.5
@pytest.mark.skipif(sys.getfilesystemencoding() != "utf-8", reason="GDAL takes names of files for UTF-8")
@pytest.mark.parametrize("kind", [kind for kind in GDAL if kind != "CSV"])
def test_gdal_reads_what_is_written(kind: str, tmp_path: Path) -> None:
    raw = pytest.importorskip("pyogrio.raw", reason="pyogrio, which reads the formats for comparison, is not installed")
    found = unpack(f"field{WRITERS[kind][0]}", WRITERS[kind][1](FIELD), tmp_path)
    shapes = []
    for path in found:
        layer = "tracks" if kind == "GPX" else None
        meta, _, geometry, values = raw.read(path, layer=layer)
        (names,) = [column for name, column in zip(meta["fields"], values, strict=True) if name.lower() == "name"]
        shapes += list(zip(names, map(coordinates, geometry), strict=True))
    read = dict(shapes)
    for line in FIELD.lines:
        np.testing.assert_allclose(np.array(read[line.name])[:, ::-1], line.points, atol=CLOSE)
    if kind not in WITHOUT_BOUNDARY:
        ring = np.array(read.get("Große Wiese", shapes[0][1]))[:, ::-1]
        assert len(ring) == len(FIELD.boundary) + 1


@pytest.mark.parametrize("kind", [kind for kind in GDAL if kind != "CSV"])
def test_what_gdal_writes_is_read(kind: str, tmp_path: Path) -> None:
    raw = pytest.importorskip(
        "pyogrio.raw", reason="pyogrio, which writes the formats for comparison, is not installed"
    )
    shapes = np.array(
        [
            struct.pack("<BII", 1, 2, len(line.points)) + line.points[:, ::-1].astype("<f8").tobytes()
            for line in FIELD.lines
        ],
        dtype=object,
    )
    path = tmp_path / ("lines" + {"KML": ".kml", "GPX": ".gpx", "GeoJSON": ".geojson", "Shapefile": ".shp"}[kind])
    names = np.array([line.name for line in FIELD.lines], dtype=object)
    more = {"layer": "routes"} if kind == "GPX" else {}
    raw.write(path, shapes, [names], ["name"], geometry_type="LineString", crs="EPSG:4326", driver=GDAL[kind], **more)
    (field,) = read_fields(path, FRAME)
    assert [line.name for line in field.lines] == [line.name for line in FIELD.lines]
    for line, given in zip(field.lines, FIELD.lines, strict=True):
        np.testing.assert_allclose(line.points, given.points, atol=CLOSE)


def test_csv_is_read_by_numpy() -> None:
    rows = np.genfromtxt(
        io.BytesIO(WRITERS["CSV"][1](FIELD).replace(b'"Cu, S\xc3\xbcd"', b"curve")), delimiter=",", skip_header=1
    )
    np.testing.assert_allclose(rows[:, 1:], np.vstack([line.points for line in FIELD.lines]), atol=CLOSE)


def test_a_shapefile_in_utm_is_brought_to_degrees_and_one_without_projection_is_refused(tmp_path: Path) -> None:
    import pyproj
    import shapefile

    utm = pyproj.CRS("EPSG:32631")
    points = pyproj.Transformer.from_crs("EPSG:4326", utm).transform(*FIELD.lines[1].points.T)
    with shapefile.Writer(str(tmp_path / "utm"), shapeType=shapefile.POLYLINE) as writer:
        writer.field("Label", "C")
        writer.line([np.column_stack(points).tolist()])
        writer.record("south")
    with pytest.raises(PathError, match=r"no utm\.prj beside it"):
        read_fields(tmp_path / "utm.shp", FRAME)
    (tmp_path / "utm.prj").write_text(utm.to_wkt("WKT1_ESRI"))
    (field,) = read_fields(tmp_path / "utm.shp", FRAME)
    assert field.lines[0].name == "south"
    np.testing.assert_allclose(field.lines[0].points, FIELD.lines[1].points, atol=CLOSE)


@pytest.mark.parametrize(
    ("system", "place", "left_out"),
    [
        (31468, [4468000.0, 5333000.0], ["places to better than 3 m, by the conversion from DHDN / "]),
        (25832, [690000.0, 5330000.0], []),
        (4326, [11.0, 48.0], []),
    ],
)
def test_a_shapefile_whose_conversion_costs_metres_says_so(
    tmp_path: Path, system: int, place: list[float], left_out: list[str]
) -> None:
    import pyproj
    import shapefile

    with shapefile.Writer(str(tmp_path / "a"), shapeType=shapefile.POLYLINE) as writer:
        writer.field("name", "C")
        writer.line([[place, [each + 0.001 for each in place]]])
        writer.record("x")
    (tmp_path / "a.prj").write_text(pyproj.CRS.from_epsg(system).to_wkt("WKT1_ESRI"))
    (field,) = read_fields(tmp_path / "a.shp", FRAME)
    assert len(field.left_out) == len(left_out)
    assert all(told.startswith(wanted) for told, wanted in zip(field.left_out, left_out, strict=True))


def test_what_a_conversion_costs_is_said_once_of_lines_and_boundary_in_one_archive(tmp_path: Path) -> None:
    import pyproj
    import shapefile

    places = [[4468000.0, 5333000.0], [4468000.0, 5333100.0], [4468100.0, 5333100.0], [4468000.0, 5333000.0]]
    for name, kind in (("lines", shapefile.POLYLINE), ("boundary", shapefile.POLYGON)):
        with shapefile.Writer(str(tmp_path / name), shapeType=kind) as writer:
            writer.field("name", "C")
            (writer.poly if kind == shapefile.POLYGON else writer.line)([places])
            writer.record("x")
        (tmp_path / f"{name}.prj").write_text(pyproj.CRS.from_epsg(31468).to_wkt("WKT1_ESRI"))
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        for file in tmp_path.iterdir():
            archive.write(file, file.name)
    (field,) = take_in("field.zip", content.getvalue(), FRAME)
    assert field.boundary is not None
    assert len(field.lines) == 1
    assert len(field.left_out) == 1


@pytest.mark.parametrize("version", [3, 4])
def test_isoxml_is_as_the_standard_says(version: int) -> None:
    root = ElementTree.fromstring(WRITERS[f"ISOXML {version}"][1](FIELD))
    assert root.get("VersionMajor") == str(version)
    assert root.find("PFD/PLN[@A='1']/LSG[@A='1']") is not None
    assert root.find("PFD").get("D") == "13000"  # m²
    strings = root.findall("PFD/GGP/GPN/LSG[@A='5']" if version == 4 else "PFD/LSG[@A='5']")
    for string, line in zip(strings, FIELD.lines, strict=True):
        points = [(float(point.get("C")), float(point.get("D"))) for point in string.findall("PNT")]
        np.testing.assert_allclose(points, line.points, atol=CLOSE)
    if version == 4:
        assert [each.get("C") for each in root.iter("GPN")] == ["1", "3"]
        assert [point.get("A") for point in strings[0]] == ["6", "7"]


def test_isoxml_patterns_of_one_name_are_told_apart_by_their_type(tmp_path: Path) -> None:
    points = '<PNT A="6" C="50.0" D="4.0"/><PNT A="9" C="50.0005" D="4.0002"/><PNT A="7" C="50.001" D="4.0"/>'
    patterns = "".join(
        f'<GGP A="GGP{n}" B="{name}"><GPN A="GPN{n}" B="{name}" C="{kind}" G="90"><LSG A="5">{points}</LSG></GPN></GGP>'
        for n, (name, kind) in enumerate([("Cu 275.4°", 1), ("Cu 275.4°", 3), ("east", 2), ("round", 4)])
    )
    file = tmp_path / "TaskData.xml"
    content = f'<ISO11783_TaskData VersionMajor="4"><PFD A="PFD1" C="hill">{patterns}</PFD></ISO11783_TaskData>'
    file.write_text(content, "utf-8")
    (field,) = read_fields(file, FRAME)
    assert [line.name for line in field.lines] == ["Cu 275.4° (A-B)", "Cu 275.4° (curve)", "east"]
    assert [len(line.points) for line in field.lines] == [2, 3, 2]
    assert field.left_out == ("pivot round",)
    ahead = on_plane(field.line("east").points, LocalFrame(latitude=50.0, longitude=4.0))
    np.testing.assert_allclose(ahead, [[0.0, 0.0], [100.0, 0.0]], atol=1e-3)


def packed(**files: str) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return content.getvalue()


@pytest.mark.parametrize(
    ("name", "data", "reason"),
    [
        ("a.kml", b"<!DOCTYPE x [<!ENTITY a 'b'>]><kml>&a;</kml>", "DOCTYPE"),
        ("a.kml", b"<gpx/>", "its root is <gpx>; KML has <kml>"),
        (
            "a.kml",
            b"<kml><Placemark><LineString><coordinates>1;2 3,4</coordinates></LineString></Placemark></kml>",
            "'1;2'",
        ),
        ("a.gpx", b"<gpx><trk><trkseg><trkpt lat='x' lon='4'/></trkseg></trk></gpx>", "lat of <trkpt> is 'x'"),
        (
            "a.gpx",
            b"<gpx><trk><trkseg><trkpt lat='50' lon='4'/></trkseg></trk></gpx>",
            "neither a line nor a boundary but line 'line 1' of fewer than 2 different points",
        ),
        (
            "a.gpx",
            b"<gpx><rte><rtept lat='nan' lon='4'/><rtept lat='50' lon='4'/></rte></gpx>",
            "point 1: latitude nan",
        ),
        ("a.geojson", b'{"type": "LineString", "coordinates": [[4, 95], [4, 50]]}', "within ±180° and ±90°"),
        ("a.geojson", b'{"type": "LineString"}', "no list"),
        ("a.csv", b"line,latitude,longitude\na,50\n", r"csv:2: is .a,50.; line,latitude,longitude is needed"),
        ("a.shp", b"x", r"no a\.prj"),
        ("a.doc", b"x", "of none of the types"),
        ("..", b"x", "cannot be the name of a file"),
        ("a\0.kml", b"x", "cannot be the name of a file"),
        ("x" * 300 + ".kml", b"x", "cannot be the name of a file"),
        ("a.zip", b"x", "cannot be unpacked"),
        ("a.zip", packed(readme="x"), "holds no field"),
        ("TASKDATA.XML", b"<x", "is not XML"),
    ],
)
def test_what_cannot_be_read_is_refused_with_a_reason(name: str, data: bytes, reason: str) -> None:
    with pytest.raises(PathError, match=reason):
        take_in(name, data, FRAME)


def test_an_archive_writes_nothing_outside_its_folder(tmp_path: Path) -> None:
    inner = tmp_path / "inner"
    inner.mkdir()
    kml = WRITERS["KML"][1](FIELD).decode()
    for path in unpack(
        "../x.kmz", packed(**{"../../../evil/doc.kml": kml, "/etc/other.kml": kml, "../up.kml": kml}), inner
    ):
        assert path.resolve().is_relative_to(inner.resolve())
    assert [each.name for each in tmp_path.iterdir()] == ["inner"]


def test_a_field_that_was_packed_without_its_folder_is_named_as_the_archive() -> None:
    with zipfile.ZipFile(io.BytesIO(WRITERS["AgOpenGPS"][1](FIELD))) as archive:
        files = {Path(name).name: archive.read(name).decode() for name in archive.namelist()}
    (field,) = take_in("hill.zip", packed(**files), FRAME)
    assert field.name == "hill"

"""Odd and damaged files of fields: each gives the right lines, or one error that says why not."""

import io
import json
import random
import zipfile
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("shapely", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")
pytest.importorskip("pyproj", reason="the extra `console` is not installed")

from drawbar.errors import DrawbarError, PathError
from drawbar.fields.exchange import WRITERS, take_in
from drawbar.fields.field import Field, FieldLine
from drawbar.fields.lines import on_earth, on_plane, with_ends
from drawbar.geometry import LocalFrame

FRAME = LocalFrame(latitude=50.8642, longitude=4.6781)
PLACES = [[50.8642, 4.6781], [50.8651, 4.6790], [50.8660, 4.6788]]
TUPLES = " ".join(f"{longitude},{latitude},0" for latitude, longitude in PLACES)
TWO = FieldLine(name="AB", points=np.array(PLACES[:2]))


def kml(content: str, head: str = "") -> str:
    return f'{head}<kml xmlns:gx="http://www.google.com/kml/ext/2.2"><Document>{content}</Document></kml>'


def line(name: str = "Süd", places: str = TUPLES) -> str:
    return f"<Placemark><name>{name}</name><LineString><coordinates>{places}</coordinates></LineString></Placemark>"


def packed(files: dict[str, bytes | str]) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        for name, data in files.items():
            archive.writestr(zipfile.ZipInfo(name), data)  # of 1980, whenever the tests are collected
    return content.getvalue()


def files_of(archive: bytes, folder: str) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(archive)) as opened:
        return {folder + Path(name).name: opened.read(name) for name in opened.namelist()}


def declared(encoding: str) -> bytes:
    return kml(line(), f'<?xml version="1.0" encoding="{encoding}"?>').encode(encoding)


TRACK = "".join(f"<gx:coord>{longitude} {latitude} 3</gx:coord>" for latitude, longitude in PLACES)
POINTS = "".join(f'<PNT A="2" C="{latitude}" D="{longitude}"/>' for latitude, longitude in PLACES)
PARTFIELD = f'<PFD A="PFD1" C="hill"><LSG A="5" B="Süd">{POINTS}</LSG></PFD>'
ROWS = "line;latitude;longitude\n" + "".join(
    f"Süd;{latitude};{longitude}\n".replace(".", ",") for latitude, longitude in PLACES
)
TASK = '<ISO11783_TaskData VersionMajor="4"><XFR A="PFD00001" B="1"/></ISO11783_TaskData>'


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("a.kml", declared("utf-16")),
        ("a.kml", declared("iso-8859-1")),
        ("a.kml", declared("windows-1252")),
        ("a.kml", kml("<description><![CDATA[<!DOCTYPE html>]]></description>" + line(), "\n<!-- <a> -->").encode()),
        ("a.kml", kml(f"<Placemark><name>Süd</name><gx:Track>{TRACK}</gx:Track></Placemark>").encode()),
        ("a.kml", kml(line() + line("short", "4.6781,50.8642") + line("none", "")).encode()),
        ("a.csv", ROWS.encode("utf-16")),
        ("a.csv", ROWS.replace("\n", "\r").encode("utf-8-sig")),
        ("a.csv", f"# surveyed, 2026\r\n \r\n#\r\n{ROWS}".encode()),
        ("mac.zip", packed({"x/a.kml": kml(line()), "__MACOSX/x/._a.kml": b"\0\5", "x/a.shp.xml": "<metadata/>"})),
        ("task.zip", packed({"TASKDATA/taskdata.xml": TASK, "TASKDATA/pfd00001.xml": f"<XFC>{PARTFIELD}</XFC>"})),
    ],
)
def test_an_odd_file_gives_its_line(name: str, data: bytes) -> None:
    (field,) = take_in(name, data, FRAME)
    assert [each.name for each in field.lines] == ["Süd"]
    np.testing.assert_allclose(field.lines[0].points, PLACES, atol=1e-12)


def test_what_is_left_out_is_said() -> None:
    ring = [[longitude, latitude] for latitude, longitude in PLACES]
    data = json.dumps({"type": "MultiPolygon", "coordinates": [[ring, ring], [ring]]}).encode()
    (field,) = take_in("a.geojson", data, FRAME)
    np.testing.assert_array_equal(field.boundary, PLACES)
    assert field.left_out == ("hole", "Polygon")
    (field,) = take_in("a.kml", kml(line() + line("short", "4.6781,50.8642 4.6781,50.8642")).encode(), FRAME)
    assert field.left_out == ("line 'short' of fewer than 2 different points",)
    with pytest.raises(PathError, match="neither a line nor a boundary but NetworkLink far"):
        take_in("a.kml", kml("<NetworkLink><name>far</name></NetworkLink>").encode(), FRAME)


TRACKS = WRITERS["AgOpenGPS"][1](Field(name="x", lines=(TWO, FieldLine(name="Cu", points=np.array(PLACES)))))
PIVOT = "Pivot\n0\n10,10\n0,0\n0\n64\nTrue\n0\n"


def test_lines_of_agopengps_that_cannot_be_driven_are_left_out_and_the_others_are_read() -> None:
    files = files_of(TRACKS, "home/")
    tracks = files["home/TrackLines.txt"].decode().splitlines()
    tracks[5] = "0.3"  # the nudge of the first
    (field,) = take_in("x.zip", packed(files | {"home/TrackLines.txt": "\n".join([*tracks, PIVOT])}), FRAME)
    assert [each.name for each in field.lines] == ["Cu"]
    nudged, pivot = field.left_out
    assert nudged.startswith("home/TrackLines.txt:6: line 'AB' has a nudge of 0.3 m")
    assert "line 'Pivot' has fewer than two different points" in pivot
    with pytest.raises(PathError, match=r"but home/TrackLines\.txt:9: line 'Pivot' has fewer than two "):
        take_in("x.zip", packed(files | {"home/TrackLines.txt": f"$TrackLines\n{PIVOT}"}), FRAME)


def shapefile_of(*rings: list[list[float]]) -> bytes:
    import shapefile

    parts = {suffix: io.BytesIO() for suffix in ("shp", "shx", "dbf")}
    with shapefile.Writer(**parts, shapeType=shapefile.POLYGON) as writer:
        writer.field("name", "C")
        writer.poly(rings)
        writer.record("x")
    projection = files_of(WRITERS["Shapefile"][1](Field(name="x", lines=(TWO,))), "")["x-lines.prj"]
    return packed({f"x.{suffix}": data.getvalue() for suffix, data in parts.items()} | {"x.prj": projection})


CLOCKWISE = [[4.0, 50.0], [4.0, 50.01], [4.01, 50.01], [4.01, 50.0], [4.0, 50.0]]
HOLE = [[4.004, 50.004], [4.006, 50.004], [4.006, 50.006], [4.004, 50.004]]


@pytest.mark.parametrize(
    ("rings", "left_out"),
    [
        ([CLOCKWISE, HOLE], ("hole",)),
        ([HOLE, CLOCKWISE], ("hole",)),
        ([HOLE, CLOCKWISE[::-1]], ("hole",)),
        ([HOLE, CLOCKWISE, HOLE[::-1]], ("Polygon", "hole")),
    ],
)
def test_the_edge_of_a_shapefile_is_its_outer_ring_wherever_it_stands(
    rings: list[list[list[float]]], left_out: tuple[str, ...]
) -> None:
    (field,) = take_in("x.zip", shapefile_of(*rings), FRAME)
    np.testing.assert_allclose([field.boundary.min(axis=0), field.boundary.max(axis=0)], [[50.0, 4.0], [50.01, 4.01]])
    assert field.left_out == left_out


@pytest.mark.parametrize("order", [1, -1])
def test_the_edge_in_a_shapefile_goes_clockwise(order: int) -> None:
    import shapefile

    field = Field(name="x", boundary=np.array(CLOCKWISE[:-1])[::order, ::-1])
    files = files_of(WRITERS["Shapefile"][1](field), "")
    with shapefile.Reader(**{suffix: io.BytesIO(files[f"x-boundary.{suffix}"]) for suffix in ("shp", "dbf")}) as reader:
        ring = reader.shape(0).points
    assert ring[0] == ring[-1]
    assert shapefile.signed_area(ring) < 0.0


def test_two_fields_of_one_name_in_an_archive_stay_two() -> None:
    here = WRITERS["AgOpenGPS"][1](Field(name="x", lines=(TWO,)))
    there = WRITERS["AgOpenGPS"][1](Field(name="x", boundary=np.array(PLACES)))
    found = take_in("all.zip", packed(files_of(here, "a/x/") | files_of(there, "b/x/")), FRAME)
    assert [(len(field.lines), field.boundary is not None) for field in found] == [(1, False), (0, True)]


@pytest.mark.parametrize(
    ("name", "data", "reason"),
    [
        ("a.kml", kml("&x;", '<!-- <a> --><!DOCTYPE a [<!ENTITY x "y">]>').encode(), "DOCTYPE"),
        ("a.csv", b"line,latitude,longitude\n" + b"x" * 200_000, "is no table"),
        ("a.csv", b"# x\n\nline,latitude,longitude\nx,50,4\nx,50\n", r"a\.csv:5: is 'x,50'; "),
        ("a.csv", "line,latitude,longitude\nSüd,50,4\n".encode("latin-1"), "byte 25 is not UTF-8 text"),
        ("TASKDATA.XML", TASK.encode(), r"refers to PFD00001\.XML, which is not beside it"),
        (
            "a.geojson",
            b'{"type": "LineString", "coordinates": [[1.0, 2.0], [1.0, 3.0]], "crs": {"properties": {"name": "x"}}}',
            "its crs is 'x'",
        ),
    ],
)
def test_what_would_be_misread_is_refused(name: str, data: bytes, reason: str) -> None:
    with pytest.raises(PathError, match=reason):
        take_in(name, data, FRAME)


@pytest.mark.parametrize("suffix", ["shp", "shx", "dbf", "zip"])
@pytest.mark.filterwarnings("ignore::UserWarning")  # of pyshp, of what it makes good
def test_a_damaged_shapefile_is_read_or_refused(suffix: str) -> None:
    whole = WRITERS["Shapefile"][1](Field(name="x", lines=(TWO,)))
    files, random_numbers, refused = files_of(whole, ""), random.Random(5), 0
    for index in range(60):
        damaged = bytearray(whole if suffix == "zip" else files[f"x-lines.{suffix}"])
        if index % 2:
            del damaged[random_numbers.randrange(len(damaged)) :]
        for _ in range(3 if damaged else 0):
            damaged[random_numbers.randrange(len(damaged))] = random_numbers.randrange(256)
        try:
            take_in(
                "x.zip",
                bytes(damaged) if suffix == "zip" else packed(files | {f"x-lines.{suffix}": bytes(damaged)}),
                FRAME,
            )
        except DrawbarError:
            refused += 1
    assert refused > 30


def test_names_of_old_shapefiles_keep_their_letters() -> None:
    files = files_of(WRITERS["Shapefile"][1](Field(name="x", lines=(FieldLine(name="S?d", points=TWO.points),))), "")
    files["x-lines.dbf"] = files["x-lines.dbf"].replace(b"S?d", "Süd".encode("cp1252"))
    (field,) = take_in("x.zip", packed(files), FRAME)
    assert field.lines[0].name == "Süd"


@pytest.mark.parametrize("kind", WRITERS)
def test_a_field_on_the_date_line_is_written_and_read_again(kind: str) -> None:
    frame = LocalFrame(latitude=-16.8, longitude=179.9999)
    curve = np.array([[0.0, 0.0], [20.0, 5.0], [45.0, 30.0]])
    field = Field(name="x", lines=(FieldLine(name="curve", points=on_earth(curve, frame)),))
    (read,) = take_in("TASKDATA.XML" if "ISOXML" in kind else f"x{WRITERS[kind][0]}", WRITERS[kind][1](field), frame)
    np.testing.assert_allclose(on_plane(read.lines[0].points, frame), curve, atol=1e-3)


def test_a_line_without_a_direction_is_refused() -> None:
    with pytest.raises(PathError, match=r"line 'AB': A and B are 0\.00 m apart"):
        with_ends(np.zeros((2, 2)), None, "AB")

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drawbar.errors import PathError
from drawbar.fields.formats.geojson import read as read_field
from drawbar.geometry import LocalFrame
from drawbar.guidance.importers.load import load_line


def written(folder: Path, name: str, content: str | bytes) -> Path:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


@pytest.mark.parametrize(
    "content",
    [
        "x,y\n0,0\n1.5,-2\n3,0\n",
        "0,0\n1.5,-2\n3,0",
        "\ufeff X , Y \r\n0,0\r\n\r\n1.5,-2e0\r\n3,0\r\n",
        "x;y\n0;0\n1,5;-2\n3;0\n",
        "0\t0\n1.5\t-2\n3\t0\n",
        '"x","y"\n"0","0"\n"1.5", "-2"\n"3","0"\n',
        '"0";"0"\n"1,5";"-2"\n"3";"0"\n',
        "# made by hand\n\nx,y\n0,0\n# the middle; with, marks\n1.5,-2\n3,0\n",
    ],
)
def test_every_dialect_of_csv_is_the_same_line(tmp_path: Path, content: str) -> None:
    line = load_line(written(tmp_path, "headland.csv", content), None)
    assert line.name == "headland"
    np.testing.assert_array_equal(line.x, [0.0, 1.5, 3.0])
    np.testing.assert_array_equal(line.y, [0.0, -2.0, 0.0])


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("", "is empty"),
        (" \n\n", "is empty"),
        (b"\x89PNG\r\n\x1a\n\x00\x00", "not UTF-8"),
        (b"1,2\x00\n", "binary"),
        ("x,y\n", "fewer than two different points"),
        ("0,0\n", "fewer than two different points"),
        ("0,0\n0,0\n", "fewer than two different points"),
        ("0,0\n1,2,3\n", r"csv:2: .*3 columns"),
        ("# nothing\n#\n", "fewer than two different points"),
        ("0 0\n1 1\n", r"csv:1: '0 0' has 1 column; two"),
        ('"1,5"\n"2,5"\n', r"csv:1: header"),
        ("0,zero\n1,1\n", r"csv:1: y is 'zero'; a number"),
        ("4.7,50.8\n4.7001,50.8\n4.7002,50.8001\n", r"csv:1: .*is 0\.0002414 m long; .*metres.*degrees"),
        ("0,0\n0.0999,0\n", r"csv:1: .*is 0\.0999 m long; 0\.1 m to 2000 km"),
        ("-1100000,-0\n1100000,-0\n", r"csv:1: .*is 2200000 m long; 0\.1 m to 2000 km"),
        ("0,0\n1,0\n2,0\n900,-0\n901,0\n", r"jumps 898 m to \(900, 0\) m"),
        ("0,0\n1,nan\n", r"csv:2: .*finite"),
        ("0,0\n1,1e300\n", r"csv:2: .*finite"),
        ("0,0\n1,0\n2,0\n900,0\n901,0\n", r"csv:4: .*jumps 898 m"),
    ],
)
def test_malformed_csv_is_refused(tmp_path: Path, content: str | bytes, reason: str) -> None:
    with pytest.raises(PathError, match=reason):
        load_line(written(tmp_path, "line.csv", content), None)


@pytest.mark.parametrize("header", ["easting,northing", "x [m],y [m]", "lon,lat", "y;x", '"x","y","z"', "x\tkind"])
def test_a_header_that_names_something_else_is_refused(tmp_path: Path, header: str) -> None:
    with pytest.raises(PathError) as refused:
        load_line(written(tmp_path, "line.csv", f"# comment\n{header}\n0,0\n1,1\n"), None)
    assert f"line.csv:2: header {header!r}; two columns are read, x (east) and y (north) in m" in str(refused.value)
    assert "name them x,y in this order or remove the header; degrees belong in GeoJSON" in str(refused.value)
    assert str(refused.value).endswith("or, for the console's import, under the header line,latitude,longitude")


@settings(max_examples=200, deadline=None, derandomize=True)
@given(content=st.one_of(st.binary(max_size=80), st.text("0123456789.,;-exy\n \tinfa", max_size=80)))
def test_any_csv_is_read_as_a_finite_line_or_refused(
    tmp_path_factory: pytest.TempPathFactory, content: bytes | str
) -> None:
    try:
        line = load_line(written(tmp_path_factory.getbasetemp(), "any.csv", content), None)
    except PathError:
        return
    assert len(line.x) >= 2
    assert np.isfinite(line.x + line.y).all()
    assert (np.hypot(np.diff(line.x), np.diff(line.y)) > 0.0).all()


def string(*positions: Any) -> dict[str, Any]:
    return {"type": "LineString", "coordinates": list(positions)}


def feature(geometry: Any, **properties: str) -> dict[str, Any]:
    return {"type": "Feature", "geometry": geometry, "properties": properties}


GOOD = string([4.7, 50.8], [4.701, 50.8], [4.701, 50.801, 33.0])


@pytest.mark.parametrize(
    "document",
    [
        GOOD,
        feature(GOOD),
        {"type": "FeatureCollection", "features": [feature({"type": "Point"}), feature(GOOD)]},
    ],
)
def test_geojson_is_put_on_the_tangent_plane(tmp_path: Path, document: dict[str, Any]) -> None:
    line = load_line(written(tmp_path, "line.geojson", json.dumps(document)), None)
    # WGS84 at 50.8°: 0.001° are 70.5 m of longitude, 111.2 m of latitude
    np.testing.assert_allclose(line.x, [0.0, 70.50, 70.50], atol=0.05)
    np.testing.assert_allclose(line.y, [0.0, 0.0, 111.25], atol=0.05)
    assert line.frame == LocalFrame(latitude=50.8, longitude=4.7)
    fixes = line.frame.east_north(np.array([50.8, 50.8, 50.801]), np.array([4.7, 4.701, 4.701]))
    np.testing.assert_allclose([line.x, line.y], fixes, atol=1e-9)


def test_a_feature_is_chosen_by_name(tmp_path: Path) -> None:
    features = [feature(GOOD, name="north"), feature(string([4.7, 50.8], [4.71, 50.8]), name="south")]
    path = written(tmp_path, "two.json", json.dumps({"type": "FeatureCollection", "features": features}))
    assert len(load_line(path, "south").x) == 2
    with pytest.raises(PathError, match="'north', 'south'; choose"):
        load_line(path, None)


def lines(*parts: Any) -> dict[str, Any]:
    return {"type": "MultiLineString", "coordinates": list(parts)}


def test_a_multilinestring_of_one_line_is_that_line(tmp_path: Path) -> None:
    one, same = (
        load_line(written(tmp_path, "a.json", json.dumps(feature(each, name="north"))), None)
        for each in (GOOD, lines(GOOD["coordinates"]))
    )
    assert (one.name, one.frame) == (same.name, same.frame) == ("north", same.frame)
    np.testing.assert_array_equal([one.x, one.y], [same.x, same.y])


def test_the_lines_of_a_multilinestring_are_chosen_by_name_as_in_the_console(tmp_path: Path) -> None:
    both = lines([[4.7, 50.8], [4.701, 50.8]], [[4.7, 50.81], [4.7, 50.812]])
    path = written(tmp_path, "a.json", json.dumps(feature(both, name="north")))
    (field,) = read_field(path)
    assert [line.name for line in field.lines] == ["north", "north (2)"]
    np.testing.assert_allclose(load_line(path, "north (2)").y, [0.0, 222.5], atol=0.1)
    with pytest.raises(PathError, match=r"'north', 'north \(2\)'; choose"):
        load_line(path, None)
    with pytest.raises(PathError, match=r"feature 0, line 2: 'coordinates' is None; a list"):
        load_line(written(tmp_path, "b.json", json.dumps(lines([], None))), "b (2)")


@pytest.mark.parametrize(
    ("document", "reason"),
    [
        ("{", "not valid JSON"),
        ("[" * 100_000, "not valid JSON"),
        ("[1, 2]", "no LineString but 'nothing'"),
        (json.dumps({"type": "FeatureCollection", "features": []}), "no LineString but no feature"),
        (json.dumps({"type": "Polygon", "coordinates": []}), "no LineString but 'Polygon'"),
        (
            json.dumps(
                {
                    "type": "FeatureCollection",
                    "features": [
                        feature({"type": kind}) for kind in ("MultiLineString", "GeometryCollection", "Point")
                    ],
                }
            ),
            "no LineString but 'GeometryCollection', 'MultiLineString', 'Point'; give each line as a LineString",
        ),
        (json.dumps({"type": "FeatureCollection"}), "'features' is None"),
        (json.dumps({"type": "LineString"}), "'coordinates' is None"),
        (json.dumps(string()), "fewer than two different points"),
        (json.dumps(string([4.7, 50.8])), "fewer than two different points"),
        (json.dumps(string([4.7, 50.8], [4.7])), r"position 1: is \[4\.7\]"),
        (json.dumps(string([4.7, 50.8], ["a", 50.8])), "position 1"),
        (json.dumps(string([4.7, 50.8], [True, 50.8])), "position 1"),
        ('{"type": "LineString", "coordinates": [[4.7, 50.8], [NaN, 50.8]]}', "position 1: longitude nan"),
        (json.dumps(string([4.7, 50.8], [500000.0, 5600000.0])), "position 1: longitude 500000"),
        (json.dumps(string([4.7, 50.8], [4.7, 90.00001])), "position 1: longitude 4.7, latitude 90.00001; .* ±90°"),
        (json.dumps(string([4.7, 50.8], [-180.00001, -0.0])), "position 1: longitude -180.00001, latitude 0; .* ±180°"),
        (f'{{"type": "LineString", "coordinates": [[4.7, {"9" * 5000}]]}}', "position 0: longitude 4.7, latitude inf"),
        (
            json.dumps(string([4.7, 50.8], [-130.0, 50.8])),
            "position 1: latitude 50.8°, longitude -130° is more than 100 km from latitude 50.8°, longitude 4.7°",
        ),
        (json.dumps(string([4.7, 50.8], [4.7, -50.8])), "position 1: .* more than 100 km .*: remove the point"),
        (json.dumps(string([4.7, 50.8], [-175.3, -50.8])), "position 1: .* more than 100 km"),  # below the first point
    ],
)
def test_malformed_geojson_is_refused(tmp_path: Path, document: str, reason: str) -> None:
    with pytest.raises(PathError, match=reason):
        load_line(written(tmp_path, "line.geojson", document), None)


def test_a_line_crosses_the_date_line(tmp_path: Path) -> None:
    there = string([179.9995, -17.0], [-179.9995, -17.0], [179.9995, -17.0])
    here = string([4.6995, -17.0], [4.7005, -17.0], [4.6995, -17.0])
    crossing, elsewhere = (
        load_line(written(tmp_path, f"{name}.json", json.dumps(document)), None)
        for name, document in (("there", there), ("here", here))
    )
    # WGS84 at 17°: 0.001° are 106.5 m of longitude
    np.testing.assert_allclose(crossing.x, [0.0, 106.5, 0.0], atol=0.05)
    np.testing.assert_allclose(crossing.x, elsewhere.x, atol=1e-6)


def crs(name: str) -> dict[str, Any]:
    return {"crs": {"type": "name", "properties": {"name": name}}}


@pytest.mark.parametrize(
    "name",
    [
        "EPSG:4326",
        "urn:ogc:def:crs:EPSG::4326",
        "urn:ogc:def:crs:OGC:1.3:CRS84",
        "urn:ogc:def:crs:OGC::CRS84",
        "http://www.opengis.net/def/crs/OGC/1.3/CRS84",
        "http://www.opengis.net/def/crs/EPSG/0/4326",
    ],
)
def test_wgs84_may_be_named(tmp_path: Path, name: str) -> None:
    document = {"type": "FeatureCollection", "features": [feature(GOOD)]} | crs(name)
    assert len(load_line(written(tmp_path, "line.geojson", json.dumps(document)), None).x) == 3


@pytest.mark.parametrize(
    ("member", "named"),
    [
        (crs("EPSG:25832"), "'EPSG:25832'"),
        (crs("urn:ogc:def:crs:EPSG::32632"), "EPSG::32632'"),
        (crs("EPSG:14326"), "'EPSG:14326'"),
        (crs("EPSG:43260"), "'EPSG:43260'"),
        ({"crs": None}, "None"),
        ({"crs": {"type": "link", "properties": {"href": "here.prj"}}}, "'link'"),
    ],
)
@pytest.mark.parametrize("level", ["collection", "feature", "geometry"])
def test_any_other_reference_system_is_refused(tmp_path: Path, member: dict[str, Any], named: str, level: str) -> None:
    metres = string([0.0, 0.0], [30.0, 40.0])
    inner = feature(metres | member if level == "geometry" else metres) | (member if level == "feature" else {})
    document = {"type": "FeatureCollection", "features": [inner]} | (member if level == "collection" else {})
    with pytest.raises(PathError, match=rf"its crs is .*{named}.*; only WGS84 is read"):
        load_line(written(tmp_path, "line.geojson", json.dumps(document)), None)


def test_unknown_names_types_and_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(PathError, match=r"its lines are: 'line'"):
        load_line(written(tmp_path, "line.csv", "0,0\n1,1\n"), "other")
    with pytest.raises(PathError, match=r"neither an AgOpenGPS field folder nor .*\.csv, \.geojson"):
        load_line(written(tmp_path, "line.shp", "x"), None)
    with pytest.raises(PathError, match="home: does not exist; give an AgOpenGPS field folder or a file of type"):
        load_line(tmp_path / "fields" / "home", None)
    with pytest.raises(PathError, match="cannot be read: No such file"):
        load_line(tmp_path / "missing.csv", None)

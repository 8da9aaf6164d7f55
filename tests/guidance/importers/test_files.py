import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drawbar.errors import PathError
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
    ],
)
def test_dialects_of_csv(tmp_path: Path, content: str) -> None:
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
        ("x,y\n", r"0 point\(s\)"),
        ("0,0\n", r"1 point\(s\)"),
        ("0,0\n0,0\n", r"1 point\(s\)"),
        ("0,0\n1,2,3\n", r"csv:2: .*3 columns"),
        ("easting,northing\n0,0\n1,1\n", r"csv:1: x is 'easting'"),
        ("0,0\n1,nan\n", r"csv:2: .*finite"),
        ("0,0\n1,1e300\n", r"csv:2: .*finite"),
        ("0,0\n1,0\n2,0\n900,0\n901,0\n", r"csv:4: .*jumps 898 m"),
    ],
)
def test_malformed_csv_is_refused(tmp_path: Path, content: str | bytes, reason: str) -> None:
    with pytest.raises(PathError, match=reason):
        load_line(written(tmp_path, "line.csv", content), None)


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


def test_a_feature_is_chosen_by_name(tmp_path: Path) -> None:
    features = [feature(GOOD, name="north"), feature(string([4.7, 50.8], [4.71, 50.8]), name="south")]
    path = written(tmp_path, "two.json", json.dumps({"type": "FeatureCollection", "features": features}))
    assert len(load_line(path, "south").x) == 2
    with pytest.raises(PathError, match="'north', 'south'; choose"):
        load_line(path, None)


@pytest.mark.parametrize(
    ("document", "reason"),
    [
        ("{", "not valid JSON"),
        ("[1, 2]", "no LineString"),
        (json.dumps({"type": "Polygon", "coordinates": []}), "no LineString"),
        (json.dumps({"type": "FeatureCollection"}), "'features' is None"),
        (json.dumps({"type": "LineString"}), "'coordinates' is None"),
        (json.dumps(string()), r"0 point\(s\)"),
        (json.dumps(string([4.7, 50.8])), r"1 point\(s\)"),
        (json.dumps(string([4.7, 50.8], [4.7])), r"position 1: is \[4\.7\]"),
        (json.dumps(string([4.7, 50.8], ["a", 50.8])), "position 1"),
        (json.dumps(string([4.7, 50.8], [True, 50.8])), "position 1"),
        ('{"type": "LineString", "coordinates": [[4.7, 50.8], [NaN, 50.8]]}', "position 1: longitude nan"),
        (json.dumps(string([4.7, 50.8], [500000.0, 5600000.0])), "position 1: longitude 500000"),
    ],
)
def test_malformed_geojson_is_refused(tmp_path: Path, document: str, reason: str) -> None:
    with pytest.raises(PathError, match=reason):
        load_line(written(tmp_path, "line.geojson", document), None)


def test_unknown_names_types_and_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(PathError, match=r"its lines: 'line'"):
        load_line(written(tmp_path, "line.csv", "0,0\n1,1\n"), "other")
    with pytest.raises(PathError, match=r"neither an AgOpenGPS field folder nor .*\.csv, \.geojson"):
        load_line(written(tmp_path, "line.shp", "x"), None)
    with pytest.raises(PathError, match="cannot be read: No such file"):
        load_line(tmp_path / "missing.csv", None)

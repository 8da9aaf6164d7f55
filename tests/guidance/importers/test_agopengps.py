import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drawbar.errors import PathError
from drawbar.guidance.importers.load import load_line

ENDS = {
    "Cu 14.1°": (351, (-54.454, 59.847)),
    "Cu 85.2°": (146, (74.194, 38.265)),
    "Cu 275.4°": (660, (-250.825, 67.647)),
    "Cu 49.9°": (501, (134.705, 119.743)),
    "Cu 183.7°": (445, (-137.806, -253.521)),
}
"""number of points and the last one of recorded curves"""
CURVE = ["Curve", "1.57", "0,0", "2,0", "0", "4", "True", "3", "0,0,1.57", "1,0.5,1.57", "2,0,1.57"]
FIELD_FILE = "2024-March-02 08:41:36 PM\n$FieldDir\nHill\n$Offsets\n0,0\nConvergence\n0\nStartFix\n50.8,4.7\n"
AB = ["AB 90°", "1.57", "1,2", "11,2", "0", "2", "True", "0"]


def field(folder: Path, *rows: str, end: str = "\n", mark: str = "") -> Path:
    text = mark + end.join(["$TrackLines", *rows]) + end
    (folder / "TrackLines.txt").write_bytes(text.encode())
    (folder / "Field.txt").write_text(FIELD_FILE)
    return folder


def test_a_recorded_line_is_read_whole_and_ends_where_it_was_recorded(recorded_line: tuple[Path, str]) -> None:
    folder, track = recorded_line
    line = load_line(folder, track)
    count, last = ENDS[track]
    assert (line.name, len(line.x)) == (track, count)
    assert (line.x[-1], line.y[-1]) == pytest.approx(last, abs=0.01)  # AgOpenGPS's plane is that far off at 300 m
    same = load_line(folder / "TrackLines.txt", track)
    np.testing.assert_array_equal(line.x, same.x)


def wgs84(degrees: str, east: float, north: float) -> tuple[float, float]:
    """Return latitude and longitude of a point on AgOpenGPS's plane, found by its own way from degrees to metres."""
    latitude_0, longitude_0 = map(float, degrees.split(","))

    def plane(latitude: float, longitude: float) -> tuple[float, float]:
        phi_0, phi = math.radians(latitude_0), math.radians(latitude)
        down = 111132.92 - 559.82 * math.cos(2 * phi_0) + 1.175 * math.cos(4 * phi_0) - 0.0023 * math.cos(6 * phi_0)
        across = 111412.84 * math.cos(phi) - 93.5 * math.cos(3 * phi) + 0.118 * math.cos(5 * phi)
        return (longitude - longitude_0) * across, (latitude - latitude_0) * down

    latitude, longitude = latitude_0, longitude_0
    for _ in range(20):
        x, y = plane(latitude, longitude)
        latitude += (north - y) / 111e3
        longitude += (east - x) / 111e3 / math.cos(math.radians(latitude))
    assert plane(latitude, longitude) == pytest.approx((east, north), abs=1e-6)
    return latitude, longitude


@pytest.mark.parametrize("origin", ["50.8,4.7", "67.1,-25.3", "-33.9,-179.99"])
def test_a_line_is_where_the_fixes_of_its_points_are(tmp_path: Path, origin: str) -> None:
    pyproj = pytest.importorskip("pyproj")
    there = [(90.0 * i, 50.0 * i) for i in range(50)]  # 5 km
    rows = ["Curve", "1.57", "0,0", "2,0", "0", "4", "True", "50", *(f"{x},{y},1.0" for x, y in there)]
    folder = field(tmp_path, *rows)
    (folder / "Field.txt").write_text(FIELD_FILE.replace("50.8,4.7", origin))
    line = load_line(folder, None)
    latitude, longitude = origin.split(",")
    topocentric = pyproj.Transformer.from_pipeline(
        "+proj=pipeline +step +proj=cart +ellps=WGS84 +step +proj=topocentric +ellps=WGS84 "
        f"+lat_0={latitude} +lon_0={longitude} +h_0=0"
    )
    degrees = [wgs84(origin, *point) for point in there]
    theirs = np.array([topocentric.transform(longitude, latitude, 0.0) for latitude, longitude in degrees])
    np.testing.assert_allclose(np.column_stack([line.x, line.y]), theirs[:, :2], rtol=0.0, atol=1e-3)
    assert np.hypot(line.x - [x for x, _ in there], line.y - [y for _, y in there]).max() > 0.1  # the planes differ


@pytest.mark.parametrize("track", [None, "Cu 1°"])
def test_missing_and_unknown_names_list_the_lines(recorded_field: Any, track: str | None) -> None:
    with pytest.raises(PathError, match=", ".join(map(re.escape, map(repr, recorded_field.curves)))):
        load_line(recorded_field.folder, track)


def test_windows_line_ends_and_byte_order_mark(tmp_path: Path) -> None:
    line = load_line(field(tmp_path, *CURVE, "", *AB, end="\r\n", mark="\ufeff"), "Curve")
    np.testing.assert_allclose(line.y, [0.0, 0.5, 0.0], atol=1e-4)


def test_an_ab_line_is_continued_beyond_b(tmp_path: Path) -> None:
    line = load_line(field(tmp_path, *AB), None)
    np.testing.assert_allclose(line.x, [1.0, 111.0], atol=1e-3)
    np.testing.assert_allclose(line.y, [2.0, 2.0], atol=2e-3)


def test_repeated_points_are_dropped_and_counted(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    rows = [*CURVE[:7], "4", *CURVE[8:], CURVE[-1]]
    line = load_line(field(tmp_path, *rows), None)
    assert len(line.x) == 3
    assert "repeated points dropped: 1" in caplog.text


def changed(index: int, text: str) -> list[str]:
    return [*CURVE[:index], text, *CURVE[index + 1 :]]


@pytest.mark.parametrize(
    ("rows", "place", "reason"),
    [
        (changed(9, "1;0.5;1.57"), 11, "3 numbers"),
        (changed(9, "1,5,0,1,57"), 11, "3 numbers .* all with decimal commas"),
        (changed(9, "1,north,1.57"), 11, "'north'"),
        (changed(9, "nan,0.5,1.57"), 11, "finite"),
        (changed(9, "1,inf,1.57"), 11, "finite"),
        ([*CURVE[:7], "5", *CURVE[8:], "3,0,0", "3,900,0"], 14, "jumps 900 m"),
        (changed(7, "4"), 9, "announces points: 4, but holds 3"),
        (changed(7, "-1"), 9, "announces points: -1"),
        (changed(7, "nan"), 9, "announces points: nan"),
        (changed(7, "many"), 9, "'many'"),
        (changed(4, "0.5"), 6, "a nudge of 0.5 m"),
        (CURVE[:5], 6, "export the field from AgOpenGPS again"),
        ([*CURVE[:7], "1", CURVE[8]], 10, "fewer than two different points"),
        ([*CURVE[:7], "2", CURVE[8], CURVE[8]], 10, "fewer than two different points"),
        ([*CURVE[:7], "0"], 9, "fewer than two different points"),
    ],
)
def test_malformed_lines_are_refused_with_their_place(tmp_path: Path, rows: list[str], place: int, reason: str) -> None:
    with pytest.raises(PathError, match=rf"TrackLines\.txt:{place}: .*{reason}"):
        load_line(field(tmp_path, *rows), None)


def test_a_file_without_header_or_lines_is_refused(tmp_path: Path) -> None:
    with pytest.raises(
        PathError,
        match=r"holds no line: TrackLines.txt has none; ABLines.txt is not there; CurveLines.txt is not there",
    ):
        load_line(field(tmp_path), None)
    (tmp_path / "TrackLines.txt").write_text("$CurveLines\n")
    with pytest.raises(PathError, match=r"starts with \$TrackLines"):
        load_line(tmp_path, None)


@pytest.mark.parametrize("missing", ["Field.txt", "TrackLines.txt"])
def test_a_folder_that_is_no_field_is_refused(tmp_path: Path, missing: str) -> None:
    (field(tmp_path, *CURVE) / missing).unlink()
    reason = "has no Field.txt; give" if missing == "Field.txt" else "holds no line: TrackLines.txt is not there"
    with pytest.raises(PathError, match=reason):
        load_line(tmp_path, None)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", r"Field\.txt: is empty"),
        (b"\x89PNG\r\n", r"Field\.txt: byte 0 is not UTF-8"),
        (b"$Offsets\n0,0\n", r"Field\.txt: has no row 'StartFix'"),
        (b"$Offsets\nStartFix", r"Field\.txt: has no row 'StartFix'"),
        (b"StartFix\n132.5,-87.1\n", r"Field\.txt:2: origin '132\.5,-87\.1'"),
        (b"StartFix\nnan,-87.1\n", r"Field\.txt:2: origin 'nan,-87\.1'"),
        (b"StartFix\n32,5,-87\n", r"Field\.txt:2: .*2 numbers .*with decimal points"),
        (b"StartFix\n50.8642,4.67", r"Field\.txt:2: the file ends within the origin"),
    ],
)
def test_a_field_without_a_readable_origin_is_refused(tmp_path: Path, content: bytes, reason: str) -> None:
    (field(tmp_path, *CURVE) / "Field.txt").write_bytes(content)
    with pytest.raises(PathError, match=reason):
        load_line(tmp_path, None)


def test_lines_of_one_name_are_told_apart_by_new_names_only(tmp_path: Path) -> None:
    folder = field(tmp_path, *CURVE, *AB, *CURVE)
    for track in (None, "Curve"):
        with pytest.raises(PathError, match="has 2 lines named 'Curve'; give them different names"):
            load_line(folder, track)
    assert load_line(folder, "AB 90°").name == "AB 90°"


def test_the_points_of_other_lines_are_not_looked_at(tmp_path: Path) -> None:
    folder = field(tmp_path, *changed(9, "nan,0.5,1.57"), *AB)
    assert load_line(folder, "AB 90°").name == "AB 90°"
    with pytest.raises(PathError, match=r"point \(nan, 0\.5\) m .*finite"):
        load_line(folder, "Curve")

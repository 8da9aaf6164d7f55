"""`drawbar drive --track nearest`: the line at which the vehicle stands, by distance and heading."""

import datetime
import json
import math
import sys
from pathlib import Path

import pytest
from receiver_frames import nmea

from drawbar.config import load_configuration
from drawbar.driving.preparation import nearest_line
from drawbar.driving.preparation.nearest_line import Standing, nearest_track, standing
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.driving.stand_in.memory_transports import MemoryTransport
from drawbar.errors import ConfigurationError, PathError
from drawbar.geometry import LocalFrame
from drawbar.guidance.importers.load import line_names
from drawbar.machine.stand_in.receiver import Report

ORIGIN = LocalFrame(latitude=50.87, longitude=4.7)
EAST, NORTH, WEST = 0.0, 0.5 * math.pi, math.pi
LINES = {
    "east": [(0.0, 0.0), (40.0, 0.0), (80.0, 0.0)],
    "beside": [(0.0, 3.0), (80.0, 3.0)],
    "across": [(40.0, -40.0), (40.0, 40.0)],
}
"""a field's lines, m"""
BEGIN = datetime.datetime(2026, 11, 22, 12, tzinfo=datetime.UTC)


def degrees(east, north):
    latitude, longitude = ORIGIN.level(east, north)
    return float(longitude), float(latitude)


@pytest.fixture
def field(tmp_path):
    features = [
        {
            "type": "Feature",
            "properties": {"name": name},
            "geometry": {"type": "LineString", "coordinates": [degrees(*each) for each in points]},
        }
        for name, points in LINES.items()
    ]
    file = tmp_path / "field.geojson"
    file.write_text(json.dumps({"type": "FeatureCollection", "features": features}), "utf-8")
    return file


def nearest(field, east, north, yaw=math.nan, *changes):
    longitude, latitude = degrees(east, north)
    configuration = load_configuration("articulated", [f"path.file={json.dumps(str(field))}", *changes])
    return nearest_track(configuration, Standing(latitude=latitude, longitude=longitude, yaw=yaw))


@pytest.mark.parametrize(
    ("east", "north", "yaw", "expected"),
    [
        (10.0, 1.0, EAST, "east"),
        (10.0, 2.0, EAST, "beside"),
        (10.0, 2.0, math.nan, "beside"),
        (39.0, 0.9, EAST, "east"),  # before "across", which is as near
        (39.5, 1.2, EAST, "east"),  # "across" is nearer
        (39.5, 1.2, NORTH, "across"),
        (41.0, 1.4, math.nan, "across"),
        (10.0, 1.0, WEST, "east"),
        (10.0, 1.0, NORTH, "east"),  # nothing leads there: the nearest
    ],
)
def test_the_nearest_line_along_the_vehicle_goes_before_a_nearer_one_across(field, east, north, yaw, expected):
    assert nearest(field, east, north, yaw) == expected


def test_a_line_against_the_vehicle_is_as_good(field):
    assert nearest(field, 39.5, 1.2, WEST) == "east"  # "across" is nearer


def test_where_no_line_is_within_reach_the_nearest_is_named(field):
    with pytest.raises(PathError, match=r"nearest line 'beside' is 9 m away, 5 m are allowed .* drive nearer"):
        nearest(field, 10.0, 12.0, EAST)
    assert nearest(field, 10.0, 12.0, EAST, "sanity.lost=21", "guidance.maximum_start_distance=20") == "beside"


def test_a_line_that_cannot_be_read_is_passed_over(field):
    content = json.loads(field.read_text("utf-8"))
    content["features"][0]["geometry"]["coordinates"] = [degrees(0.0, 0.0)]
    field.write_text(json.dumps(content), "utf-8")
    assert nearest(field, 10.0, 1.0, EAST) == "beside"
    content["features"] = content["features"][:1]
    field.write_text(json.dumps(content), "utf-8")
    with pytest.raises(PathError, match="none of its lines can be read"):
        nearest(field, 10.0, 1.0, EAST)


def test_without_a_file_there_is_no_nearest_line():
    with pytest.raises(ConfigurationError, match="no file with lines"):
        nearest_track(load_configuration("articulated"), Standing(latitude=50.0, longitude=4.0))


def test_every_format_tells_its_lines(field, tmp_path):
    assert line_names(field) == list(LINES)
    table = tmp_path / "brook.csv"
    table.write_text("x,y\n0,0\n10,0\n", "utf-8")
    assert line_names(table) == ["brook"]
    folder = Path(__file__).parents[3] / "examples" / "field"
    assert line_names(folder) == line_names(folder / "TrackLines.txt") == ["Cu 14.1°", "Cu 85.2°", "AB 92.4°"]
    with pytest.raises(PathError, match="does not exist"):
        line_names(tmp_path / "nothing")


@pytest.fixture
def receivers(monkeypatch):
    """Return a function that lets both receivers tell where their antennas are, m; None: it is silent."""

    def tell(*places):
        lines = []
        for place in places:
            line = MemoryTransport()
            for step in range(5 if place else 0):
                longitude, latitude = degrees(*place)
                time = BEGIN + datetime.timedelta(seconds=0.2 * step)
                report = Report(time=time, latitude=latitude, longitude=longitude, height=0.0)
                line.arrive(10.0 + 0.2 * step, nmea.gga(report))
            lines.append(line)
        monkeypatch.setattr(nearest_line, "open_transport", lambda _: lines.pop(0))
        monkeypatch.setattr(nearest_line, "poll_times", lambda *_: iter([10.0, 11.0, 12.0]))
        return standing(with_stand_ins(load_configuration("articulated")).devices)

    return tell


def test_where_it_stands_and_faces_is_told_by_both_receivers(receivers):
    found = receivers((10.0, 5.0), (10.0, 2.0))
    assert ORIGIN.east_north(found.latitude, found.longitude) == pytest.approx((10.0, 5.0), abs=0.02)
    assert found.yaw == pytest.approx(NORTH, abs=0.02)
    assert math.isnan(receivers((10.0, 5.0), (10.1, 5.0)).yaw)  # one above the other


def test_a_receiver_without_a_position_is_named(receivers):
    with pytest.raises(ConfigurationError, match=r"devices\.trailer_receiver: has told no position for 10 s"):
        receivers((10.0, 5.0), None)


@pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")
def test_stand_ins_stand_nowhere(drawbar):
    code, told = drawbar("drive", "--track", "nearest")
    assert code == 2
    assert "there is no vehicle that stands anywhere" in " ".join(told.split())

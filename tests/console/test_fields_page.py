"""The fields page, by simulated users: lines are made while driving, imported, planned on the map and taken."""

import json
import re
import threading

import numpy as np
import pytest

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")

from console_stage import FRAME, staged, until
from nicegui import ui

from drawbar.config import load_configuration
from drawbar.console.access_control import LARGEST_UPLOAD
from drawbar.console.drawing import boundary
from drawbar.console.field_map import FieldMap
from drawbar.console.visitors import Rank
from drawbar.fields.exchange import WRITERS
from drawbar.fields.field import Field, FieldLine
from drawbar.fields.lines import on_earth
from drawbar.guidance.importers.load import load_line
from drawbar.messages import Action

CORNER = np.array([[0.0, 0.0], [30.0, 0.0], [33.0, 3.0], [60.0, 3.0]])
FIELD = Field(
    name="Hill",
    lines=(
        FieldLine(name="AB", points=on_earth(np.array([[0.0, 0.0], [0.0, 50.0]]), FRAME)),
        FieldLine(name="bent", points=on_earth(CORNER, FRAME)),
    ),
    boundary=on_earth(np.array([[-50.0, -20.0], [80.0, -20.0], [80.0, 100.0], [-50.0, 100.0]]), FRAME),
)


@pytest.fixture(autouse=True)
def plans(monkeypatch):
    """Let maps remember what plan they are to draw."""
    monkeypatch.setattr(FieldMap, "show_plan", lambda shown, plan: setattr(shown, "shown_plan", plan))


def drive(stage, one, places):
    for x, y in places:
        stage.run(0.1)
        stage.receive_fixes(float(x), float(y), course=0.0)
        one.refresh()


async def planned(one):
    """Wait until what is chosen now is planned and drawn."""
    await until(lambda: not one.page._plans)


async def opened(stage, browser):
    stage.next_drive.fields.add(FIELD)
    one = await browser().open("/fields")
    stage.run(0.1)
    await planned(one)
    return one


def scene(one):
    (found,) = (each for each in one.user.client.elements.values() if isinstance(each, FieldMap))
    return json.loads(found._props["field"]) | found.shown_plan


def control(one, label):
    kinds = (ui.select, ui.number, ui.input)
    (found,) = (
        each for each in one.user.client.elements.values() if isinstance(each, kinds) and each.props["label"] == label
    )
    return found


async def chosen(one, label, value):
    control(one, label).value = value
    await planned(one)


@staged
async def test_a_line_is_chosen_on_the_map_and_its_pass_is_planned_and_drawn(stage, browser):
    one = await opened(stage, browser)
    assert [line["name"] for line in scene(one)["lines"]] == ["AB", "bent"]
    one.user.find(FieldMap).trigger("choose", "bent")
    await planned(one)
    assert control(one, "Line").value == "bent"
    assert "Smoothed by at most" in one.text()
    assert "more than 2 cm where it is red" in one.text()
    assert scene(one)["deviating"]
    one.user.find(FieldMap).trigger("choose", "AB")
    await planned(one)
    assert scene(one)["deviating"] == []
    await chosen(one, "Pass", 2)
    await chosen(one, "Offset to the left", -50)
    driven = np.array(scene(one)["driven"])[:, 0] - scene(one)["lines"][0]["points"][0][0]
    np.testing.assert_allclose(driven, -5.5, atol=2e-3)  # drawn to the millimetre
    await chosen(one, "Working width", None)
    assert "a number is missing" in one.text()
    assert not one.enabled("Take for the next drive")
    await chosen(one, "Working width", 400)
    assert "0.1 to 60 m are allowed" in one.text()


@staged
async def test_a_line_too_tight_for_the_vehicle_is_refused_before_it_is_taken(stage, browser):
    square = on_earth(np.array([[0.0, 0.0], [20.0, 0.0], [20.0, 0.5], [0.0, 0.5]]), FRAME)
    stage.next_drive.fields.add(Field(name="tight", lines=(FieldLine(name="u", points=square),)))
    one = await browser().open("/fields")
    await planned(one)
    assert "line 'u'" in one.text()
    assert not one.enabled("Take for the next drive")


@staged
async def test_the_taken_pass_is_a_version_of_the_configuration_that_drives_it(stage, browser):
    one = await opened(stage, browser)
    await chosen(one, "Pass", 1)
    one.press("Take for the next drive")
    await until(lambda: stage.next_drive.versions.all() or "wrong" in one.text())
    (version,) = stage.next_drive.versions.all()
    saved = load_configuration(str(version.file))
    line = load_line(version.file.parent / saved.path.file, saved.path.track)
    assert line.name == "AB +1"
    np.testing.assert_allclose([line.y[0], line.y[-1]], [0.0, 120.0], atol=2e-3)  # from edge to edge
    assert saved.path.working_width == 3.0
    np.testing.assert_allclose(boundary(saved, line.frame)[2], [83.0, 120.0], atol=0.01)  # the pass begins at -3, -20
    assert saved.model_copy(update={"path": stage.configuration.path}) == stage.configuration
    assert f"drawbar drive {version.file}" in one.notifications()


@staged
async def test_nothing_is_taken_while_the_vehicle_is_steered(stage, browser):
    one = await browser().open()
    stage.run(4.0, one)
    for action in (Action.ARM, Action.ENGAGE):
        stage.link.ask(one.page._visitor, action)
        stage.run(0.2, one)
    assert stage.link.is_engaged
    fields = await opened(stage, browser)
    fields.refresh()
    assert not fields.enabled("Take for the next drive")
    with fields.user.client:
        await fields.page._take_line()  # a forged event
    assert "the vehicle is steered now; stop first" in fields.text()
    assert stage.next_drive.versions.all() == []
    assert not list(stage.next_drive.versions.folder.glob("*"))


@staged
async def test_an_a_b_line_and_a_curve_are_made_while_driving_and_kept(stage, browser):
    one = await browser().open("/fields")
    one.press("Set A here")
    assert "RTK-fixed" in one.notifications()
    drive(stage, one, [(0.0, 0.0)])
    one.press("Set A here")
    drive(stage, one, [(3.0, 4.0)])
    one.press("Set B here")
    one.press("● Record a curve")
    turn = np.linspace(0.0, 1.5, 60)
    drive(stage, one, 20.0 * np.column_stack([np.sin(turn), 1.0 - np.cos(turn)]))
    assert "Recording, points: " in one.text()
    one.press("■ End and save")
    assert stage.next_drive.fields.names() == ["New field"]
    straight, curve = stage.next_drive.fields.load("New field").lines
    assert straight.name == "AB 36.9°"
    assert "Curve is kept in New field" in one.notifications()
    np.testing.assert_allclose(straight.points, on_earth(np.array([[0.0, 0.0], [3.0, 4.0]]), FRAME), atol=1e-8)
    assert len(curve.points) > 40
    await planned(one)
    assert "m. Smoothed by at most" in one.text()


@staged
async def test_a_recorded_curve_that_takes_no_more_points_says_so(stage, browser):
    one = await browser().open("/fields")
    drive(stage, one, [(0.0, 0.0)])
    one.press("● Record a curve")
    drive(stage, one, [(x, 0.0) for x in range(5)])
    assert "full: end and save" not in one.text()
    recorded = stage.link.surveyor.track.points
    recorded += [recorded[-1]] * (20_000 - len(recorded))
    drive(stage, one, [(5.0, 0.0)])
    assert "Recording, points: 20000 · full: end and save" in one.text()


@staged
async def test_a_line_that_is_far_away_is_said_to_be(stage, browser):
    far = np.add(FIELD.lines[0].points, (4.5, 0.0))
    stage.next_drive.fields.add(Field(name="far", lines=(FieldLine(name="far", points=far),)))
    stage.receive_fixes(0.0, 0.0)
    one = await browser().open("/fields")
    await planned(one)
    found = re.search(r"The tractor is (\d+) km away from it", one.text())
    assert float(found[1]) == pytest.approx(500.0, rel=0.02)


@staged
async def test_a_large_field_is_read_while_others_are_served(stage, browser):
    stage.next_drive.fields.add(FIELD)
    served, load = threading.Event(), stage.next_drive.fields.load

    def slow(name):
        assert served.wait(120.0)
        return load(name)

    stage.next_drive.fields.load = slow
    one = await browser().open("/fields")
    served.set()
    await planned(one)
    assert control(one, "Line").value == "AB"
    assert scene(one)["driven"]


@staged
async def test_four_hundred_lines_are_drawn_by_few_points(stage, browser):
    along = np.linspace(0.0, 450.0, 300)
    wave = np.column_stack([5.0 * np.sin(along), along])
    lines = [FieldLine(name=f"{n}", points=on_earth(wave + np.array([3.0 * n, 0.0]), FRAME)) for n in range(400)]
    stage.next_drive.fields.add(Field(name="many", lines=tuple(lines)))
    one = await browser().open("/fields")
    await planned(one)
    drawn = [line["points"] for line in scene(one)["lines"]]
    assert len(drawn) == 400
    assert 40_000 < sum(map(len, drawn)) <= 60_000


@staged
async def test_a_browser_that_does_not_draw_is_sent_no_queue_of_places(stage, browser):
    one = await browser().open("/fields")
    sent = []
    one.page._map.run_method = lambda name, *given: sent.append(name)
    for x in range(30):
        drive(stage, one, [(0.5 * x, 0.0)])
    assert 0 < sent.count("move") <= 3
    one.user.find(FieldMap).trigger("moved")
    drive(stage, one, [(0.0, 0.0)])
    assert sent.count("move") <= 4


@staged
async def test_positions_that_are_not_fixed_make_no_line(stage, browser):
    one = await browser().open("/fields")
    drive(stage, one, [(0.0, 0.0)])
    one.press("● Record a curve")
    for x in range(20):
        stage.run(0.1)
        stage.receive_fixes(float(x), 0.0, quality=4)
    one.press("■ End and save")
    assert "0.0 m long" in one.notifications()
    assert stage.link.surveyor.track is not None


async def hand_over(one, name, data):
    """Send a file as a browser does; return the answer's status."""
    (upload,) = one.user.find(ui.upload).elements
    return (await one.user.http_client.post(upload.props["url"], files={"file": (name, data)})).status_code


@staged
async def test_a_file_is_imported_and_the_field_exported(stage, browser):
    one = await browser().open("/fields")
    assert await hand_over(one, "hill.zip", WRITERS["Shapefile"][1](FIELD)) == 200
    await until(lambda: "Imported hill, lines: 2" in one.notifications())
    kept = stage.next_drive.fields.load("hill")
    assert [line.name for line in kept.lines] == ["AB", "bent"]
    assert kept.boundary is not None
    assert await hand_over(one, "x.kml", b"<kml/>") == 200
    await until(lambda: "neither a line nor a boundary" in one.notifications())
    await chosen(one, "Format", "GPX")
    one.press("Export")
    answer = await one.user.download.next()
    assert b"<name>bent</name>" in answer.content


@staged
async def test_files_are_taken_from_the_pages_owner_only_and_up_to_a_size(stage, browser):
    one, other = await browser().open("/fields"), browser()
    await other.user.http_client.get("/")
    (upload,) = one.user.find(ui.upload).elements
    address, files = upload.props["url"], {"file": ("a.kml", b"<kml/>")}
    assert (await other.user.http_client.post(address, files=files)).status_code == 403
    assert (await one.user.http_client.post(address, files=files)).status_code == 200
    large = {"content-length": str(LARGEST_UPLOAD + 1)}
    assert (await one.user.http_client.post(address, headers=large)).status_code == 413


@staged
async def test_a_viewer_makes_and_takes_no_lines_but_stops(stage, browser):
    stage.next_drive.fields.add(FIELD)
    one = browser()
    visitors = one.pages._visitors
    admit = visitors.admit
    visitors.admit = lambda name, rank, time: admit(name, Rank.VIEWER, time)
    await one.open("/fields")
    await planned(one)
    assert scene(one)["driven"]
    assert not one.enabled("Take for the next drive")
    assert not any(isinstance(each, ui.upload) for each in one.user.client.elements.values())
    before = len(stage.sent)
    one.press("STOP")
    assert [each.action for each in stage.sent[before:]] == [Action.STOP]

"""The set-up page, by simulated users: numbers in people's units, checked as a configuration, kept as versions."""

import math
import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")

from console_stage import staged, until
from nicegui import ui

from drawbar.config import load_configuration
from drawbar.console.device_rates import DeviceRates
from drawbar.console.set_up_values import GROUPS
from drawbar.console.signal_history import ShownStep
from drawbar.console.vehicle_drawing import number_id, vehicle_drawing
from drawbar.console.versions import Versions, changes_between
from drawbar.console.visitors import Rank
from drawbar.errors import StorageError
from drawbar.messages import Action

VALUES = [value for _, values in GROUPS for value in values]


def number(one, key):
    """Return the input of a key of the configuration."""
    name = number_id(next(value for value in VALUES if value.key == key))
    (found,) = (
        each
        for each in one.user.client.elements.values()
        if isinstance(each, ui.number) and each.props.get("for") == name
    )
    return found


@staged
async def test_numbers_are_shown_in_peoples_units_and_saved_in_si(stage, browser):
    one = await browser().open("/setup")
    assert number(one, "vehicle.wheelbase").value == 140.0
    assert number(one, "speed").value == 3.6
    assert number(one, "vehicle.tractor_steering_limit").value == 30.0
    assert not one.enabled("Save as a new version")
    for key, value in {
        "vehicle.wheelbase": 215.5,
        "vehicle.masts.tractor.up": 250.0,
        "vehicle.tractor_steering_limit": 25.0,
        "vehicle.curvature_limit": 6.0,
        "speed": 2.7,
    }.items():
        number(one, key).set_value(value)
    assert "A  Wheelbase: 140 cm → 215.5 cm" in one.text()
    assert "Front wheels, at most: 30 ° → 25 °" in one.text()
    one.press("Save as a new version")
    (version,) = stage.next_drive.versions.all()
    saved = load_configuration(str(version.file))
    assert saved.vehicle.wheelbase == 2.155
    assert saved.vehicle.masts.tractor.up == 2.5
    assert saved.vehicle.tractor_steering_limit == pytest.approx(math.radians(25.0), abs=1e-12)
    assert saved.vehicle.curvature_limit == pytest.approx(1.0 / 6.0, abs=1e-12)
    assert saved.speed == pytest.approx(0.75)
    assert saved.vehicle.hitch_length == stage.configuration.vehicle.hitch_length
    assert "Nothing is changed" in one.text()
    assert version.file.name in one.text()


@pytest.mark.parametrize(
    ("key", "value", "reason"),
    [
        ("vehicle.wheelbase", 0.0, "Wheelbase: must be more than 0 cm"),
        ("vehicle.wheelbase", 215500.0, "Wheelbase: must be at most 3000 cm"),
        ("vehicle.trailer_antenna", 500.0, "ahead of the actuated joint"),
        ("vehicle.tractor_steering_limit", 89.0, "Front wheels, at most: must be less than 80 °"),
        ("speed", None, "Driving speed: must be a number"),
        ("vehicle.curvature_limit", 0.0, "Smallest radius of lines: must be more than 0 m"),
    ],
)
def test_what_is_no_configuration_cannot_be_saved(key, value, reason):
    @staged
    async def test(stage, browser):
        one = await browser().open("/setup")
        before = one.user.find(ui.html).elements
        content = {each.content for each in before}
        number(one, key).set_value(value)
        assert reason in one.text()
        assert not one.enabled("Save as a new version")
        assert {each.content for each in before} == content
        one.press("Undo")
        assert reason not in one.text()
        assert not one.enabled("Undo"), "nothing is changed"
        assert stage.next_drive.versions.all() == []

    test()


@staged
async def test_nothing_is_changed_while_the_vehicle_is_steered(stage, browser):
    drives = await browser().open()
    stage.run(4.0, drives)
    one = await browser().open("/setup")
    number(one, "vehicle.wheelbase").set_value(150.0)
    assert one.enabled("Save as a new version")
    for action in (Action.ARM, Action.ENGAGE):
        stage.link.ask(drives.page._visitor, action)
        stage.run(0.2, drives)
    with one.user.client:
        one.page._keep()  # a forged event
    assert "the vehicle is steered now" in one.notifications()
    one.refresh()
    assert not one.enabled("Save as a new version")
    assert stage.next_drive.versions.all() == []
    assert stage.next_drive.configuration == stage.configuration


@staged
async def test_an_operator_may_look_and_change_nothing(stage, browser):
    one = browser()
    visitors = one.pages._visitors
    admit = visitors.admit
    visitors.admit = lambda name, rank, time: admit(name, Rank.OPERATOR, time)
    await one.open("/setup")
    assert not number(one, "vehicle.wheelbase").enabled
    assert "Only a maintainer" in one.text()
    number(one, "vehicle.wheelbase").set_value(150.0)
    with one.user.client:
        one.page._keep()
    assert stage.next_drive.versions.all() == []


@staged
async def test_versions_build_on_each_other_and_one_can_go_back(stage, browser):
    one = await browser().open("/setup")
    for value in (150.0, 160.0):
        number(one, "vehicle.wheelbase").set_value(value)
        one.press("Save as a new version")
    newest, first = stage.next_drive.versions.all()
    assert (first.number, newest.number) == (1, 2)
    buttons = [each for each in one.user.client.elements.values() if isinstance(each, ui.button)]
    assert "Go on from this" in [each.text for each in buttons]
    assert not [each.text for each in buttons if "color" in each.props], "Quasar's colours hide the words on them"
    one.page._go_back(first)
    assert number(one, "vehicle.wheelbase").value == 150.0
    number(one, "vehicle.hitch_length").set_value(120.0)
    one.press("Save as a new version")
    third = load_configuration(str(stage.next_drive.versions.all()[0].file))
    assert (third.vehicle.wheelbase, third.vehicle.hitch_length) == (1.5, 1.2)
    assert load_configuration(str(newest.file)).vehicle.wheelbase == 1.6


def test_a_version_is_never_overwritten(tmp_path):
    versions, configuration = Versions(tmp_path / "setup"), load_configuration("articulated")
    file = versions.save(configuration)
    with pytest.raises(StorageError, match="nothing was changed"):
        versions.write(file, b"")
    assert load_configuration(str(file)) == configuration
    assert changes_between(configuration, load_configuration("articulated", ["speed=0.5"])) == [("speed", "1", "0.5")]


@pytest.mark.parametrize("value", VALUES, ids=lambda value: value.key)
def test_what_is_shown_is_what_is_configured(value):
    configuration = load_configuration("articulated")
    shown = value.shown(configuration)
    again = load_configuration("articulated", [value.change(shown)])
    assert value.shown(again) == shown
    more = load_configuration("articulated", [value.change(shown + 1.0)]) if value.unit.name == "cm" else again
    assert value.shown(more) in (shown, shown + 1.0)


def test_the_drawing_is_to_scale_and_has_a_letter_for_every_length():
    changes = ["vehicle.masts.tractor={forward=0.4, left=0.3, up=2.4}", "vehicle.masts.trailer={left=-0.2, up=1.0}"]
    vehicle = load_configuration("articulated", [*changes, "vehicle.masts.trailer.forward=0.1"]).vehicle
    root = ElementTree.fromstring(vehicle_drawing(vehicle))
    letters = {each.text for each in root.findall("g[@class='letter']/text")}
    assert letters == {value.letter for value in VALUES if value.letter}
    lengths = sorted(
        abs(float(each.get("x2")) - float(each.get("x1")))
        for each in root.findall("line[@class='dimension']")
        if each.get("y1") == each.get("y2")
    )
    assert lengths == pytest.approx(sorted([1.4, 1.1, 0.2, 1.3, 0.25, 0.4, 0.1]), abs=1e-3)
    left, top, width, height = map(float, root.get("viewBox").split())
    places = [(float(x), float(y)) for x, y in re.findall(r"(-?[\d.]+),(-?[\d.]+)", vehicle_drawing(vehicle))]
    assert all(left <= x <= left + width and top <= y <= top + height for x, y in places)


def test_antennas_beyond_the_axles_and_the_sides_are_drawn_whole():
    changes = [
        "vehicle.masts.tractor={forward=3.0, left=-2.0, up=3.0}",
        "vehicle.masts.trailer={forward=-3.0, left=2.0}",
    ]
    root = ElementTree.fromstring(vehicle_drawing(load_configuration("articulated", changes).vehicle))
    left, _, width, _ = map(float, root.get("viewBox").split())
    antennas = [(float(each.get("cx")), float(each.get("cy"))) for each in root.findall("circle[@class='antenna']")]
    assert len(antennas) == 3
    assert all(left < x - 0.09 and x + 0.09 < left + width for x, _ in antennas)
    (ground,) = (float(each.get("y1")) for each in root.findall("line[@class='ground']"))
    rows = [float(each.get("y1")) for each in root.findall("line[@class='end']")]
    assert ground < -2.09 < 2.09 < min(rows)


def test_an_antenna_without_a_mast_has_its_letters_too():
    root = ElementTree.fromstring(vehicle_drawing(load_configuration("articulated").vehicle))
    letters = [each.text for each in root.findall("g[@class='letter']/text")]
    assert sorted(letters) == sorted(value.letter for value in VALUES if value.letter)
    places = [(each.get("x"), each.get("y")) for each in root.findall("g[@class='letter']/text")]
    assert len(set(places)) == len(places)


@staged
async def test_devices_are_shown_with_rate_and_age(stage, browser):
    one = await browser().open("/setup")
    for step in range(40):
        stage.run(0.1)
        if step < 35:
            stage.receive_fixes(0.0, 0.0)
        stage.receive_controller()
        one.refresh()
    states = {state.name: state for state in stage.link.devices.states(stage.now)}
    assert states["tractor_receiver"].rate == pytest.approx(10.0, rel=0.05)
    assert states["tractor_receiver"].age == pytest.approx(0.5, abs=0.11)
    assert states["gate"].rate == pytest.approx(50.0, rel=0.05)
    assert math.isnan(states["hitch_sensor"].age)
    assert "10 Hz" in one.text()
    assert states["corrections"].age == 1.0


@staged
async def test_devices_that_the_machine_does_not_have_are_not_listed(stage, browser):
    devices = stage.next_drive.driven.devices
    sensors = devices.sensors.model_copy(update={"pulses_per_metre": None})
    alone = devices.model_copy(update={"trailer_receiver": None, "sensors": sensors})
    everything = (await browser().open("/setup")).text()
    stage.next_drive.driven = stage.next_drive.driven.model_copy(update={"devices": alone})
    page = await browser().open("/setup")
    stage.run(1.0)
    page.refresh()
    for name, listed in (("Tractor's receiver", True), ("Trailer's receiver", False), ("Wheel speed", False)):
        assert name in everything
        assert (name in page.text()) is listed


def test_a_device_that_was_never_heard_has_no_rate():
    states = DeviceRates().states(10**12)
    assert {state.rate for state in states[:-1]} == {0.0}
    assert all(math.isnan(state.age) for state in states)


def straight_steps(record):
    """Return the steps of 60 m driven straight at 1 m/s, with a wheel sensor that shows 4 % too much."""
    for number in range(300):
        place = replace(record.estimate.tractor, x=0.2 * number, y=0.0, yaw=0.0)
        measured = replace(record.measurement, time=0.2 * number, speed=1.04, hitch_angle=0.01, tractor_steering=0.0)
        yield replace(record, estimate=replace(record.estimate, tractor=place), measurement=measured)


@staged
async def test_a_drive_by_hand_calibrates_and_is_refused_while_the_vehicle_is_steered(stage, browser):
    from drawbar.simulation import simulate

    short = load_configuration("articulated", ["path.radii=[4.0]", "path.straight_length=1.0"])
    record = simulate(short, 1).records[60]
    stage.next_drive.configuration = stage.next_drive.driven  # a machine with devices
    one = await browser().open("/setup")
    stage.run(4.0)
    one.refresh()
    assert not one.enabled("■ End and evaluate")
    one.press("● Begin")
    for step in straight_steps(record):
        stage.link.hand_log.receive_step(step, engaged=False)
        stage.link.steps.append(ShownStep(step, None))
        stage.link.version += 1
    stage.run(1.0)
    one.refresh()
    assert "✓ 60 / 30 m" in one.text()
    assert "\n0 / 3\n" in one.text()
    assert "\n0 / 20 s\n" in one.text()
    plots = [each for each in one.user.client.elements.values() if isinstance(each, ui.echart) and each.visible]
    assert len(plots) == 2
    one.press("■ End and evaluate")
    await until(lambda: "Found:" in one.text())
    assert "✓ wheel speed: 1.04" in one.text()
    assert "✖ front wheels: scale" in one.text()
    pulses = stage.next_drive.driven.devices.sensors.pulses_per_metre
    one.refresh()
    one.press("Save the result")
    assert stage.next_drive.configuration.devices.sensors.pulses_per_metre == pytest.approx(1.04 * pulses, rel=1e-3)
    log = stage.link.hand_log
    log.begin()
    for _ in range(20):
        log.receive_step(step, engaged=True)  # drawbar steers: that is no drive by hand
    assert log.drive() is None
    log.receive_gate(stage.link.gate)
    assert log.steered == []
    log.receive_gate(replace(stage.link.gate, steers=1))
    assert len(log.steered) == 1


@staged
async def test_what_was_steered_shows_the_steerings_for_the_next_drive(stage, browser):
    from drawbar.simulation import Simulation

    changes = ["path.radii=[8.0]", "machine.actuators.dead_time=0.3", "machine.actuators.lag_factor=1.5"]
    with Simulation(load_configuration("articulated", changes)) as simulation:
        records = list(simulation.steps())
    one = await browser().open("/setup")
    stage.run(4.0)
    one.refresh()

    async def evaluated():
        one.press("● Begin")
        for record in records:
            stage.link.hand_log.receive_step(record, engaged=True)
        stage.link.hand_log.receive_gate(replace(stage.link.gate, steers=3))
        one.refresh()
        one.press("■ End and evaluate")
        await until(lambda: "Found:" in one.text())
        one.refresh()
        one.press("Save the result")

    await evaluated()
    assert "✓ front wheels: dead time: 0." in one.text()
    assert "a stand-in: what it shows is not saved" in one.notifications()
    assert stage.next_drive.versions.all() == []
    stage.next_drive.configuration = stage.next_drive.driven  # a machine with devices
    await evaluated()
    (version,) = stage.next_drive.versions.all()
    remembered = load_configuration(str(version.file)).actuation.remembered
    for steering in (remembered.tractor, remembered.trailer):
        assert (steering.dead_time, steering.lag) == pytest.approx((0.3, 0.45), rel=0.3)
    shown = "actuation.remembered.tractor.dead_time"
    assert shown not in one.text(), "keys of the configuration are no words for people"


def test_a_line_whose_version_was_never_written_does_not_stop_the_next(tmp_path):
    versions, configuration = Versions(tmp_path), load_configuration("articulated")
    versions.write(versions.next_file("articulated", ".geojson"), b"{}")  # and then the power was gone
    line = versions.next_file("articulated", ".geojson")
    assert line.name == "articulated-0002.geojson"
    versions.write(line, b"{}")
    assert versions.save(configuration).name == "articulated-0002.toml"
    assert versions.save(configuration).name == "articulated-0003.toml"


def test_a_full_disk_leaves_no_half_version(tmp_path):
    full = Path("/dev/full")
    if not full.exists():
        pytest.skip("there is no /dev/full here")
    versions = Versions(tmp_path)
    file = tmp_path / "a-0001.toml"
    opened = Path.open

    class Full(type(tmp_path)):
        """A path whose disk is full."""

        def open(self, mode="r"):
            opened(self, mode).close()
            return opened(full, "wb", 0)

    with pytest.raises(StorageError, match="No space left"):
        versions.write(Full(file), b"name = 1")
    assert not file.exists()

"""Pushing a bare valve: what it finds of a stand-in whose truth is known, and what ends it, always with off."""

import math

import pytest
from pushed_valve import PERIOD, SETTINGS, SPEED, PushedValve
from typer.testing import CliRunner

from drawbar.cli.calibrate import Progress
from drawbar.cli.main import app
from drawbar.config import load_configuration
from drawbar.driving.preparation import push_calibration
from drawbar.driving.preparation.push_calibration import PUSHES, PushCalibration
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.machine.calibration.valve import RUNS
from drawbar.machine.stand_in.bare_valve import DEAD_BAND, FULL_RATE, LAG

SCALE = 0.9
"""true angle by the sensor's"""


@pytest.fixture(scope="module", params=[1.0, -1.0], ids=["left", "right"])
def pushed(request):
    line = PushedValve(motor=request.param, scale=SCALE)
    done = PushCalibration(line.machine(), SETTINGS)
    found = {each.name: each for each in done.run()}
    return request.param, line, done, found


def test_it_finds_the_truth_whichever_way_the_motor_is_connected(pushed):
    direction, _, done, found = pushed
    assert done.reason == ""
    assert (done.bands.done, done.rates.done) == (2 * RUNS, 2 * PUSHES)
    values = {name: each.value for name, each in found.items()}
    assert all(value.accepted for value in values.values()), values
    assert values["direction of the drive"].value == direction
    for side in ("left", "right"):
        assert values[f"{side}: dead band"].value == pytest.approx(DEAD_BAND, abs=0.01)
        assert values[f"{side}: full rate"].value == pytest.approx(FULL_RATE / SCALE, rel=0.05)
        assert values[f"{side}: lag"].value == pytest.approx(LAG, abs=0.02)
        assert values[f"{side}: dead time"].value == pytest.approx(0.0, abs=1.5 * PERIOD)


def test_it_finds_the_sensors_scale_by_the_yaw_rate(pushed):
    *_, found = pushed
    scale = found["front wheels: angle by the yaw rate / by the sensor"]
    assert scale.value.value == pytest.approx(SCALE, abs=3.0 * scale.value.deviation)
    angles = scale.sets["devices.bare_valve.angles"]
    assert angles == pytest.approx([scale.value.value * angle for angle in SETTINGS.angles], abs=1e-6)


def test_it_moves_by_a_few_degrees_and_is_off_afterwards(pushed):
    _, line, done, _ = pushed
    assert math.radians(2.0) < line.farthest < math.radians(9.0)
    assert line.received[-1] == 0
    assert {drive for _, _, drive in done.rows} == {drive / 1000 for drive in line.received}


FAULTS = {
    "the operator": (lambda line, run: run.end("stopped by the operator"), "stopped by the operator"),
    "the switch": (lambda line, run: setattr(line.board, "permitted", False), "stopped by the operator"),
    "a silent board": (lambda line, run: setattr(line, "silent", True), "reports nothing"),
    "a vehicle that stops": (lambda line, run: setattr(line, "speed", 0.0), "standing tyres"),
    "no yaw rate": (lambda line, run: setattr(line, "knows_yaw", False), "yaw rate is unknown"),
    "a motor that turns round": (lambda line, run: setattr(line, "motor", -2.0), "runaway"),
    "a page that hangs": (lambda line, run: setattr(run, "_attended", -math.inf), "no picture was drawn"),
}


@pytest.mark.parametrize("name", FAULTS)
@pytest.mark.parametrize("after", [20.0, 40.0])
def test_what_goes_wrong_ends_it_with_its_reason_and_off(name, after):
    happen, words = FAULTS[name]

    def each(time, line):
        if after <= time < after + PERIOD:
            happen(line, run)

    line = PushedValve(each=each)
    run = PushCalibration(line.machine(), SETTINGS, patience=100.0)
    assert run.run() == []
    assert words in run.reason
    assert line.time < after + (10.0 if name == "a motor that turns round" else 1.2)
    assert line.received[-1] == 0
    assert line.farthest < math.radians(9.0)


def test_a_receiver_that_leaves_the_speed_out_once_does_no_harm():
    def each(time, line):
        line.speed = math.nan if 0.0 <= time % 10.0 < 0.6 else SPEED

    run = PushCalibration(PushedValve(each=each).machine(), SETTINGS)
    assert run.run() != []
    assert run.reason == ""


@pytest.mark.parametrize("name", ["the switch", "a vehicle that stops", "no yaw rate"])
def test_nothing_is_moved_where_it_may_not_begin(name):
    happen, words = FAULTS[name]
    line = PushedValve()
    run = PushCalibration(line.machine(), SETTINGS)
    happen(line, run)
    assert run.run() == []
    assert words in run.reason
    assert set(line.received) == {0}


@pytest.mark.parametrize("answers", ["n\n", "y\nn\n", "y\ny\n"])
@pytest.mark.usefixtures("at_a_terminal")
def test_the_command_asks_twice_and_writes_the_sensors_scale(tmp_path, monkeypatch, answers):
    machine = with_stand_ins(load_configuration("articulated", ["machine.attitude.tractor.present=true"]))
    file, lines = tmp_path / "my.toml", []
    file.write_text(machine.to_toml(), "utf-8")

    def open_bare_valve(settings, wheelbase, motion):
        lines.append(PushedValve(scale=SCALE))
        return lines[-1].machine()

    monkeypatch.setattr(push_calibration, "open_bare_valve", open_bare_valve)
    result = CliRunner().invoke(app, ["calibrate", str(file), "--push"], input=answers)
    agreed = answers.count("y") == 2
    assert (len(lines), result.exit_code) == (agreed, 0 if agreed else 1), result.output
    if agreed:
        assert "left: dead band: 0.14" in result.output
        assert not lines[0].connected
        angles = load_configuration(str(tmp_path / "my.calibrated.toml")).devices.bare_valve.angles
        assert angles == pytest.approx([SCALE * angle for angle in SETTINGS.angles], rel=0.05)


def test_how_far_it_is_is_reported():
    line, told = PushedValve(), []
    done = PushCalibration(line.machine(), SETTINGS)
    watch = done._watch
    done._watch = lambda *sensed: (told.append(Progress(done).__rich__()), watch(*sensed))[1]
    done.run()
    steps = list(dict.fromkeys(told))
    assert steps[0].startswith("waiting for the vehicle")
    runs, pushes = ([f"run {i + 1} of {2 * RUNS}" for i in range(2 * RUNS)], range(1, 2 * PUSHES + 1))
    assert [each.removeprefix("dead band: ") for each in steps[1 : 1 + 2 * RUNS]] == runs
    assert steps[1 + 2 * RUNS :] == [f"rate and lag: push {i} of {2 * PUSHES}" for i in pushes]


@pytest.mark.parametrize("arguments", [[], ["runs/a", "--push"]])
def test_the_command_takes_a_log_or_pushes(tmp_path, arguments):
    file = tmp_path / "my.toml"
    file.write_text(load_configuration("articulated").to_toml(), "utf-8")
    result = CliRunner().invoke(app, ["calibrate", str(file), *arguments])
    assert "a log or --push" in str(result.exception)


@pytest.mark.usefixtures("at_a_terminal")
def test_a_machine_without_a_bare_valve_is_told_what_to_add(tmp_path):
    file = tmp_path / "my.toml"
    file.write_text(load_configuration("articulated").to_toml(), "utf-8")
    result = CliRunner().invoke(app, ["calibrate", str(file), "--push"], input="y\ny\n")
    assert "devices.bare_valve" in str(result.exception)

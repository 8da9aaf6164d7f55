"""`drawbar calibrate` and `drawbar identify`: drives whose truth is known."""

import math
from contextlib import nullcontext
from dataclasses import fields, replace
from datetime import date
from types import SimpleNamespace

import numpy as np
import pytest
from serpentine import serpentine
from typer.testing import CliRunner

from drawbar.cli import calibrate as cli_calibrate
from drawbar.cli.calibrate import WIDE
from drawbar.cli.main import app
from drawbar.config import load_configuration
from drawbar.driving.preparation.calibrated_file import calibrated_file, calibrated_text
from drawbar.driving.preparation.dead_bands import dead_bands, steered_time
from drawbar.driving.preparation.hand_calibration import board_counts, calibrate
from drawbar.driving.preparation.hand_drive import HandDrive
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.errors import ConfigurationError, DrawbarError
from drawbar.machine.hardware.sensor_line import SensorBoardSettings
from drawbar.machine.hardware.steer_board import BoardMemory
from drawbar.messages import GateState
from drawbar.signals import Actuation
from drawbar.simulation import simulate

SEED = 4
STEP = 0.2
UP, LEFT, TRAILER_UP = 3.0, 0.1, 2.0
"""of the antennas, m"""
BIAS, TRAILER_BIAS = math.radians(1.5), math.radians(-0.8)
"""of the roll sensors, rad"""
SLOPE = math.radians(-2.0)
"""of the ground, right side down where the way leads east"""


ANTENNA = {"tractor: antenna forward", "tractor: antenna left"}
"""what circles do not show"""


@pytest.fixture(scope="module")
def machine():
    masts = [f"vehicle.masts={{tractor={{up={UP},left={LEFT}}},trailer={{up={TRAILER_UP}}}}}"]
    return with_stand_ins(load_configuration("articulated", masts))


def reported(memory, true_counts):
    """Return what a board with a memory makes of its sensor's counts, rad, left positive."""
    position = memory.offset - true_counts if memory.invert_sensor else true_counts + memory.offset
    wire = position / memory.counts_per_degree
    return -np.radians(np.where(wire < 0.0, wire * memory.ackermann / 100.0, wire))


def driven(machine, *, right=25.0, left=28.0, zero=40.0, rising=1.0):
    """Drive 40 m straight, circles to both sides, and the same track back; counts per degree to either side."""
    rng, wheelbase = np.random.default_rng(SEED), machine.vehicle.wheelbase
    angles = [0.0] * 250
    for degrees in (8.0, 15.0, 22.0, -8.0, -15.0, -22.0):
        angles += [math.radians(degrees)] * 70
    angles = np.array([*angles, *[0.0] * 250])
    speed = np.full(len(angles), 1.0)
    yaw = np.cumsum(STEP * speed * np.tan(angles) / wheelbase)
    x, y = np.cumsum(STEP * speed * np.cos(yaw)), np.cumsum(STEP * speed * np.sin(yaw))
    back = slice(len(angles) - 250, None)
    yaw[back] = math.pi + 2.0 * math.pi * round((yaw[back][0] - math.pi) / (2.0 * math.pi))
    x[back], y[back] = 50.0 - 0.2 * np.arange(250), 0.0
    noise = rng.normal(0.0, 1.0, (6, len(angles)))
    roll = SLOPE * np.cos(yaw)  # the true one
    lean = LEFT - UP * np.sin(roll)  # of the antenna, to the body's left
    bent = math.radians(2.0) + 0.001 * noise[5]
    behind = -TRAILER_UP * np.sin(roll) - machine.vehicle.drawbar_length * np.sin(
        bent
    )  # of the trailer's, on straights
    wire = np.degrees(-angles)
    counts = rising * (wire * np.where(wire > 0.0, right, left)) + zero
    memory = machine.devices.tractor_board.memory
    return HandDrive(
        times=STEP * np.arange(len(angles)),
        x=x + 0.003 * noise[0],
        y=y + 0.003 * noise[1],
        yaw=yaw + 0.0005 * noise[2],
        antenna_x=x - lean * np.sin(yaw) + 0.01 * noise[3],
        antenna_y=y + lean * np.cos(yaw) + 0.01 * noise[4],
        roll=roll + BIAS,
        trailer_yaw=yaw,
        trailer_antenna_x=x - 2.0 * np.cos(yaw) - behind * np.sin(yaw) + 0.01 * noise[4],
        trailer_antenna_y=y - 2.0 * np.sin(yaw) + behind * np.cos(yaw) + 0.01 * noise[3],
        trailer_roll=roll + TRAILER_BIAS,
        wheel_speed=1.04 * speed,
        front_wheels=reported(memory, counts + 0.5 * noise[5]),
        joint=bent,
        hitch=0.03 + 0.001 * noise[5],
    )


def all_found(machine, drive):
    return {each.name: each for each in calibrate(machine, drive)}


@pytest.mark.parametrize("rising", [1.0, -1.0])
def test_what_it_finds_is_the_truth(machine, rising):
    found = all_found(machine, driven(machine, rising=rising))
    assert {name for name, each in found.items() if not each.value.accepted} == ANTENNA
    scale, zero = found["front wheels: scale"].sets, found["front wheels: zero"].sets
    prefix = "devices.tractor_board.memory."
    assert scale[prefix + "counts_per_degree"] == pytest.approx(25, abs=1)
    assert scale[prefix + "ackermann"] == pytest.approx(89, abs=3)
    assert scale[prefix + "invert_sensor"] is (rising < 0.0)
    assert zero[prefix + "offset"] == pytest.approx(-40.0 * rising, abs=2)
    joint = found["joint: zero"].sets["devices.trailer_board.memory.offset"]
    assert joint == pytest.approx(2.0 * 30.0, abs=2)
    assert found["hitch angle: zero"].sets["devices.sensors.hitch_angles"][2] == pytest.approx(-0.03, abs=0.001)
    assert found["wheel speed"].sets["devices.sensors.pulses_per_metre"] == pytest.approx(104.0, abs=0.5)
    for body, bias in (("tractor", BIAS), ("trailer", TRAILER_BIAS)):
        rolls = found[f"{body}: mounting roll"].sets
        assert rolls[f"vehicle.masts.{body}.roll_offset"] == pytest.approx(bias, abs=0.002)
        assert 0.003 < rolls[f"vehicle.masts.{body}.roll_deviation"] < 0.006


def test_the_mounting_rolls_of_the_simulated_machine_on_a_slope_are_found(tmp_path):
    """There and back on the same line, with a loop between, on an even slope of 5°, by a driver who sees the truth."""
    out, loop, radius, aside = np.arange(0.0, 60.0, 0.5), np.linspace(0.0, 1.0, 240), 10.0, math.pi / 3.0
    course = np.concatenate([-aside * loop, (math.pi + 2.0 * aside) * loop - aside, math.pi + aside * (1.0 - loop)])
    turned = np.abs(np.diff(course, prepend=0.0))
    x, y = 60.0 + np.cumsum(radius * turned * np.cos(course)), np.cumsum(radius * turned * np.sin(course))
    assert (x[-1], y[-1]) == pytest.approx((60.0, 0.0), abs=0.3)
    there, back = np.column_stack([out, 0.0 * out]), np.column_stack([x[-1] - 0.5 - out, 0.0 * out])
    np.savetxt(tmp_path / "line.csv", np.concatenate([there, np.column_stack([x, y]), back]), delimiter=",")
    changes = [
        f"path.file={tmp_path / 'line.csv'}",
        "vehicle.masts={tractor={up=2.5},trailer={up=2.0}}",
        "machine.attitude={tractor={present=true,roll_bias=0.0175},trailer={present=true,roll_bias=-0.014}}",
        "machine.terrain.slope=0.0873",
        "estimator={model='ideal'}",
    ]
    log = simulate(load_configuration("articulated", changes), seed=1)
    found = all_found(with_stand_ins(load_configuration("articulated", changes)), HandDrive.of(log))
    for body, bias in (("tractor", 0.0175), ("trailer", -0.014)):
        offset, known = found[f"{body}: mounting roll"].sets.values()
        assert offset == pytest.approx(bias, abs=0.002)
        assert known < 0.008


def test_the_zero_of_an_inductive_sensor_is_found_too(machine):
    curved = (-1.28, 6e-4, 0.0, 1e-12)
    sensors = SensorBoardSettings(transport="file:hitch", hitch_polynomial=curved, hitch_range=(0.0, 4096.0))
    devices = machine.devices.model_copy(update={"sensors": sensors})
    machine = machine.model_copy(update={"devices": devices})
    sets = all_found(machine, driven(machine))["hitch angle: zero"].sets
    assert list(sets) == ["devices.sensors.hitch_polynomial"]
    assert sets["devices.sensors.hitch_polynomial"] == pytest.approx([-1.31, *curved[1:]], abs=0.001)


def test_a_board_with_the_numbers_that_were_found_reports_the_true_angles(machine):
    drive = driven(machine)
    found = all_found(machine, drive)
    sets = found["front wheels: scale"].sets | found["front wheels: zero"].sets
    new = {key.rpartition(".")[2]: value for key, value in sets.items()}
    board = machine.devices.tractor_board
    memory = BoardMemory.model_validate(board.memory.model_dump() | new)
    angles = reported(memory, board_counts(board, drive.front_wheels))
    true = np.arctan(machine.vehicle.wheelbase * drive.yaw_rates / drive.speeds)
    for part in drive.circles():
        inside = (drive.times > part.times[3]) & (drive.times < part.times[-3])
        assert np.degrees(np.mean(angles[inside] - true[inside])) == pytest.approx(0.0, abs=0.4)


def test_a_scale_that_no_board_can_store_is_refused(machine):
    found = all_found(machine, driven(machine, right=300.0, left=310.0))["front wheels: scale"]
    assert "cannot store counts_per_degree=300" in found.value.refusals[0]
    assert not found.sets


def test_what_was_not_driven_is_refused_with_what_to_drive(machine):
    drive = driven(machine)
    straight = all_found(machine, drive.part(slice(0, 250)))
    assert straight["front wheels: zero"].value.accepted
    assert "circles" in straight["front wheels: scale"].value.refusals[0]
    assert not straight["front wheels: scale"].sets
    assert not straight["tractor: mounting roll"].sets
    assert not straight["trailer: mounting roll"].sets
    turning = all_found(machine, drive.part(slice(250, 670)))
    assert all(not each.sets for each in turning.values())
    none = np.full(len(drive.times), math.nan)
    nothing = replace(drive, front_wheels=none, roll=none, trailer_roll=none)
    rolls = {"tractor: mounting roll", "trailer: mounting roll"}
    assert not ({"front wheels: scale"} | rolls) & set(all_found(machine, nothing))
    for unknown in ("joint", "trailer_antenna_x"):
        assert rolls & set(all_found(machine, replace(drive, **{unknown: none}))) == {"tractor: mounting roll"}


def test_without_the_height_of_a_mast_there_is_no_mounting_roll(machine):
    masts = load_configuration("articulated").vehicle.masts
    vehicle = machine.vehicle.model_copy(update={"masts": masts})
    found = all_found(machine.model_copy(update={"vehicle": vehicle}), driven(machine))
    for body in ("tractor", "trailer"):
        assert "measure it above the ground" in found[f"{body}: mounting roll"].value.refusals[0]
        assert not found[f"{body}: mounting roll"].sets


def test_a_drive_far_from_the_line_is_reported_with_settings_that_estimate_there(machine, monkeypatch, tmp_path):
    # a run ends 6 m from the line, where circles soon are, and nothing is estimated any more
    drive = driven(machine)
    lost = replace(drive, x=np.where(drive.times > drive.times[100], math.nan, drive.x))
    assert drive.far_from_line == 0.0
    assert lost.far_from_line == pytest.approx(1.0 - 101 / len(drive.times))
    changed = load_configuration("articulated", [each.removeprefix("--set ") for each in WIDE])
    assert changed.sanity.lost > changed.guidance.maximum_start_distance > 500.0

    told = []
    content = SimpleNamespace(header=SimpleNamespace(configuration={}), records=(), shortcomings=())
    monkeypatch.setattr("drawbar.recording.log.read_log", lambda log: content)
    monkeypatch.setattr("drawbar.config.recorded_configuration", lambda *_: machine)
    monkeypatch.setattr("drawbar.recording.drive_records.open_drive", lambda log: nullcontext([]))
    monkeypatch.setattr(cli_calibrate.console, "print", lambda text, **_: told.append(text))
    for each in (drive, lost):
        monkeypatch.setattr(HandDrive, "of", lambda content, each=each: each)
        cli_calibrate._in_log(tmp_path)
    (text,) = told
    assert text.startswith(f"in {100.0 * lost.far_from_line:.0f} % of the drive the vehicle was too far from the line")
    assert all(each in text for each in WIDE)


def test_s_curves_show_where_the_antenna_stands(machine):
    times, x, y, speeds, angles = serpentine(0.6, -0.2)
    none = np.full(len(times), math.nan)
    drive = HandDrive(
        times=times,
        x=x,
        y=y,
        yaw=np.zeros(len(times)),
        antenna_x=x,
        antenna_y=y,
        roll=none,
        trailer_yaw=none,
        trailer_antenna_x=none,
        trailer_antenna_y=none,
        trailer_roll=none,
        wheel_speed=speeds,
        front_wheels=angles,
        joint=none,
        hitch=none,
    )
    found = all_found(machine, drive)
    assert found["tractor: antenna forward"].sets["vehicle.masts.tractor.forward"] == pytest.approx(0.6, abs=0.08)
    assert found["tractor: antenna left"].sets["vehicle.masts.tractor.left"] == pytest.approx(-0.2, abs=0.08)
    rolling = all_found(machine, replace(drive, roll=np.zeros(len(times))))
    assert "roll sensor" in rolling["tractor: antenna left"].value.refusals[-1]
    assert rolling["tractor: antenna forward"].sets


def steering(asked, measured):
    """Return states of a gate that steers, twenty a second."""
    for number, (set_point, angle) in enumerate(zip(asked, measured, strict=True), 1):
        time = number * 50_000_000
        names = {each.name: math.nan if each.type in ("Known", "Number") else 0 for each in fields(GateState)}
        names |= {"time": time, "steers": 1, "tractor_angle_time": time, "tractor_angle": angle}
        yield GateState(**names | {"tractor_set_point": set_point})


def test_a_drive_that_was_steered_shows_the_dead_band():
    times = 0.05 * np.arange(2000)
    asked, measured, band = 0.04 * np.sin(times / 4.0), [0.0], 0.015
    for each in asked[1:]:
        measured.append(min(max(measured[-1], each - band), each + band))
    states = list(steering(asked, measured))
    (found,) = dead_bands(states)
    assert found.name == "front wheels: dead band"
    assert found.value.accepted
    assert found.value.value == pytest.approx(band, abs=0.002)
    assert not found.sets
    assert steered_time(states) == pytest.approx(99.95)
    assert list(dead_bands([])) == []


def test_the_file_beside_extends_the_users_and_keeps_what_was_found_before(machine, tmp_path):
    mine = tmp_path / "my.toml"
    mine.write_text('extends = "articulated"  # mine\nname = "mine"\n', "utf-8")
    found = list(calibrate(machine, driven(machine)))
    beside = calibrated_file(mine)
    assert beside.name == "my.calibrated.toml"
    roll = [each for each in found if each.name == "tractor: mounting roll"]
    beside.write_text(calibrated_text(mine, roll, date(2026, 11, 22), "a.mcap"), "utf-8")
    again = load_configuration(str(beside))
    assert again.vehicle.masts.tractor.roll_offset == pytest.approx(BIAS, abs=0.002)
    assert again.name == "mine"
    assert "# 2026-11-22, a.mcap" in beside.read_text("utf-8")
    assert calibrated_file(beside) == beside
    text = calibrated_text(beside, [], date(2026, 11, 23), "b.mcap")
    assert "roll_offset" in text
    assert 'extends = "my.toml"' in text
    beside.write_text("nonsense", "utf-8")
    with pytest.raises(ConfigurationError, match="repair it"):
        calibrated_text(mine, [], date(2026, 11, 23), "b.mcap")


def test_dead_time_lag_and_late_fixes_are_found_in_the_log_of_a_run(tmp_path):
    late = "machine.delays={fix={latency=0.2},reported=false}"
    steps = ["path.radii=[8.0]", "machine.actuators.dead_time=0.3", "machine.attitude.tractor.present=true", late]
    result = CliRunner().invoke(app, ["run", "articulated", "--out", str(tmp_path / "run"), *sets(steps)])
    assert result.exit_code == 0, result.output
    (log,) = tmp_path.rglob("log.mcap")
    told = CliRunner().invoke(app, ["identify", str(log)])
    assert told.exit_code == 0, told.output
    for line in told.output.splitlines()[:2]:
        assert 0.2 < float(line.split("dead time ")[1].split(" ")[0]) < 0.4, line
    (fixes,) = (line for line in told.output.splitlines() if line.startswith("fixes: "))
    assert 0.08 < float(fixes.removeprefix("fixes: at least ").split()[0]) < 0.22
    assert "later than told; add it to latency of" in fixes


def test_scales_that_the_drive_has_found_are_told(monkeypatch):
    told = []
    monkeypatch.setattr(cli_calibrate.console, "print", lambda text, **_: told.append(text))
    cli_calibrate._tell_scales(Actuation())
    assert told == []
    cli_calibrate._tell_scales(Actuation(hitch_scale=0.25, joint_scale=-0.2))
    assert told[0].startswith(
        "hitch angle: 1.25 times what its sensor shows; multiply devices.sensors.hitch_angles by that"
    )
    assert told[1].startswith("joint: 0.80 times what its sensor shows; divide its board's counts_per_degree by that")


def sets(changes):
    return [word for change in changes for word in ("--set", change)]


@pytest.mark.parametrize("steps", [0, 1, 4, 49])
def test_a_log_that_was_cut_short_is_refused_and_what_it_lost_is_said(steps, machine, monkeypatch, tmp_path):
    """Fewer steps than a second has ended in a traceback."""
    told = []
    content = SimpleNamespace(header=SimpleNamespace(configuration={}), records=(), shortcomings=("it just stops",))
    monkeypatch.setattr("drawbar.recording.log.read_log", lambda log: content)
    monkeypatch.setattr("drawbar.config.recorded_configuration", lambda *_: machine)
    monkeypatch.setattr("drawbar.recording.drive_records.open_drive", lambda log: nullcontext([]))
    monkeypatch.setattr(cli_calibrate.console, "print", lambda text, **_: told.append(text))
    monkeypatch.setattr(HandDrive, "of", lambda content: driven(machine).part(slice(steps)))
    with pytest.raises(DrawbarError, match="is less than 10 s of driving; give the log of a longer drive"):
        cli_calibrate._in_log(tmp_path)
    assert told == [f"{tmp_path}: it just stops"]


@pytest.mark.parametrize("steps", [2, 4])
def test_less_than_a_second_shows_neither_a_straight_nor_a_circle(steps, machine):
    short = driven(machine).part(slice(steps))
    assert (short.straights(), short.circles()) == ([], [])

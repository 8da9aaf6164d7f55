"""Steering memory: what a drive shows of both steerings is kept for the next one, where it can be relied on."""

import re
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from drawbar.cli import calibrate as cli_calibrate
from drawbar.cli import drive as cli_drive
from drawbar.cli.main import app
from drawbar.config import load_configuration
from drawbar.driving.preparation.steering_memory import longest_steering, steering_memory
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.errors import StorageError
from drawbar.estimation.actuation_settings import SteeringMemories
from drawbar.signals import Flag
from drawbar.simulation import Simulation
from drawbar.statuses import Status

CHANGES = ["path.radii=[8.0]", "machine.actuators.dead_time=0.3", "machine.actuators.lag_factor=1.5"]
KNOWN = {"dead_time": 0.3, "lag": 0.45}


@pytest.fixture(scope="module")
def configuration():
    return load_configuration("articulated", CHANGES)


@pytest.fixture(scope="module")
def records(configuration):
    with Simulation(configuration) as simulation:
        return list(simulation.steps())


def by_name(configuration, records):
    return {each.name: each for each in steering_memory(configuration, records)}


def test_a_drive_shows_dead_time_and_lag_of_both_steerings(configuration, records):
    found = by_name(configuration, records)
    assert set(found) == {f"{name}: {what}" for name in ("front wheels", "joint") for what in ("dead time", "lag")}
    for name, body in (("front wheels", "tractor"), ("joint", "trailer")):
        for quantity, true in KNOWN.items():
            each = found[f"{name}: {quantity.replace('_', ' ')}"]
            assert each.value.accepted, each.value.refusals
            assert abs(each.value.value - true) < 3.0 * each.value.deviation < 0.3 * true
            assert each.sets == {f"actuation.remembered.{body}.{quantity}": pytest.approx(each.value.value, abs=1e-3)}


def test_what_cannot_be_relied_on_is_refused_with_what_to_do(configuration, records):
    short = by_name(configuration, records[:100])
    assert all("20 s of steering" in each.value.refusals[0] and not each.sets for each in short.values())
    failed = by_name(configuration, [*records, replace(records[-1], status=Status.STEERING)])
    assert all("did not follow" in each.value.refusals[0] and not each.sets for each in failed.values())
    by_hand = [replace(records[-1], flags=Flag.RELEASED), replace(records[-1], status=Status.STEERING)]
    assert all(each.sets for each in by_name(configuration, [*records, *by_hand]).values())
    still = [
        replace(
            each,
            measurement=replace(each.measurement, tractor_steering=0.0),
            command=replace(each.command, tractor_steering=0.0),
        )
        for each in records
    ]
    resting = by_name(configuration, still)
    assert "too roughly" in resting["front wheels: dead time"].value.refusals[0]
    assert resting["joint: dead time"].sets


def test_halves_that_contradict_each_other_are_refused(configuration, records):
    half = len(records) // 2
    with Simulation(load_configuration("articulated", CHANGES[:1])) as quick:
        others = list(quick.steps())[half : len(records)]
    renumbered = [replace(each, step=half + k) for k, each in enumerate(others)]
    found = by_name(configuration, [*records[:half], *renumbered])["front wheels: dead time"]
    assert "in the first half and 0.0" in found.value.refusals[-1]


def test_only_what_drawbar_steered_without_a_gap_counts(configuration, records):
    released = [replace(each, flags=Flag.RELEASED) for each in records]
    assert list(steering_memory(configuration, released)) == []
    ended = [replace(each, flags=Flag(0), status=Status.STEERING) for each in released[-5:]]  # by hand, through a curve
    assert list(steering_memory(configuration, [*released[:-5], *ended])) == []
    assert list(steering_memory(configuration, [])) == []
    parted = [*records[:150], *released[150:160], *records[160:220], *records[240:]]
    assert longest_steering(parted) == records[240:]


def test_a_rate_is_kept_where_commands_exceeded_it():
    changes = ["path.radii=[8.0]", "speed=2.0", "machine.actuators.tractor_rate=0.109"]
    configuration = load_configuration("articulated", changes)
    with Simulation(configuration) as simulation:
        records = list(simulation.steps())
    rate = by_name(configuration, records)["front wheels: rate"].value
    assert rate.value == pytest.approx(0.109, rel=0.15)
    memory = SteeringMemories.model_validate({"tractor": {"rate": 0.11}})
    settings = configuration.actuation.model_copy(update={"remembered": memory})
    again = configuration.model_copy(update={"actuation": settings})
    known = by_name(again, records)["front wheels: rate"].value
    assert known.value == pytest.approx(0.109, rel=0.15)


def test_the_next_drive_begins_with_what_the_last_one_left_in_the_file_beside(tmp_path):
    mine = tmp_path / "my.toml"
    mine.write_text('extends = "articulated"\n', "utf-8")
    run = tmp_path / "run"
    told = CliRunner().invoke(app, ["run", str(mine), "--out", str(run), *[w for c in CHANGES for w in ("--set", c)]])
    assert told.exit_code == 0, told.output
    cli_calibrate.remember(mine, run / "log.mcap")
    beside = tmp_path / "my.calibrated.toml"
    text = beside.read_text("utf-8")
    assert re.search(r"front wheels: dead time: 0\.\d+ ± 0\.\d+ s", text)
    assert ", run:" in text
    kept = load_configuration(str(beside)).actuation.remembered
    assert kept.tractor.dead_time == pytest.approx(0.3, abs=0.02)
    assert kept.trailer.lag == pytest.approx(0.45, abs=0.07)
    with Simulation(load_configuration(str(beside))) as simulation:
        first = next(simulation.steps())
    assert first.actuation.dead_time == pytest.approx(0.3, abs=0.02)
    again = CliRunner().invoke(app, ["run", str(beside), "--out", str(tmp_path / "next")])
    assert again.exit_code == 0, again.output
    same = CliRunner().invoke(app, ["replay", str(tmp_path / "next")])
    assert same.exit_code == 0, same.output


def test_a_drive_that_shows_nothing_leaves_the_file_alone(tmp_path, capsys):
    mine = tmp_path / "my.toml"
    mine.write_text('extends = "articulated"\nname = "mine"\n', "utf-8")
    run = tmp_path / "run"
    CliRunner().invoke(app, ["run", str(mine), "--out", str(run), "--set", "path.radii=[8.0]", "--set", "speed=3.0"])
    beside = Path(tmp_path / "my.calibrated.toml")
    log = run / "log.mcap"
    log.write_bytes(log.read_bytes()[: log.stat().st_size // 4])
    cli_calibrate.remember(mine, log)
    assert not beside.exists()
    assert "nothing of the steerings is kept" in capsys.readouterr().out


@pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")
@pytest.mark.parametrize("given", [["articulated"], ["{mine}", "--shadow"], ["{mine}"]])
def test_there_must_be_a_file_to_remember_beside_and_something_that_is_steered(given, tmp_path, drawbar):
    mine = tmp_path / "my.toml"
    mine.write_text('extends = "articulated"\n', "utf-8")
    code, told = drawbar("drive", *(each.format(mine=mine) for each in given), "--remember")
    assert code == 2
    assert "--remember" in told
    assert "leave out" in told


def test_steerings_are_kept_also_where_the_report_cannot_be_written(tmp_path, monkeypatch):
    kept = []

    def full(log, folder):
        raise StorageError("no room")

    (tmp_path / "log.mcap").touch()
    monkeypatch.setattr(cli_drive, "show_and_write", full)
    monkeypatch.setattr(cli_calibrate, "remember", lambda *given: kept.append(given))
    with pytest.raises(StorageError, match="no room"):
        cli_drive._report(tmp_path, tmp_path / "my.toml")
    assert kept == [(tmp_path / "my.toml", tmp_path / "log.mcap")]


@pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")
def test_what_a_stand_in_shows_is_not_remembered_of_the_machine(tmp_path, monkeypatch, drawbar):
    mine = tmp_path / "my.toml"
    mine.write_text(with_stand_ins(load_configuration("articulated")).to_toml(), "utf-8")
    monkeypatch.setattr("drawbar.driving.devices.pace.shown_pace", lambda devices: 1)
    code, told = drawbar("drive", str(mine), "--remember")
    assert code == 2
    assert "`drawbar stand-in` runs at these devices" in " ".join(told.split())
    assert not (tmp_path / "my.calibrated.toml").exists()

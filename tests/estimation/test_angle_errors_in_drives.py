"""Latency and scale errors of hitch and joint in whole runs: the line is kept, and what is found is told."""

from pathlib import Path

import numpy as np
import pytest
from scaled_sensors import simulation

from drawbar.config import load_configuration
from drawbar.report.path_errors import true_path_errors
from drawbar.simulation import simulate

LATE = "machine.delays={{hitch_angle={{latency={}}},reported={}}}"


@pytest.mark.parametrize(
    ("latency", "told", "speed"),
    [(0.0, False, 3.0), (0.15, False, 3.0), (0.2, False, 3.0), (0.2, False, 2.0), (0.2, True, 3.0)],
)
@pytest.mark.parametrize("attitude", ["", "machine.attitude.tractor.present=true"], ids=["wheels", "yaw rate"])
def test_in_a_drive_it_is_found_in_time_to_keep_the_line(
    attitude: str, latency: float, told: bool, speed: float
) -> None:
    late = LATE.format(latency, str(told).lower())
    changes = ["path.radii=[8.0]", f"speed={speed}", late, *([attitude] if attitude else [])]
    log = simulate(load_configuration("articulated", changes), seed=1)
    reckoned = [record.actuation.hitch_latency for record in log.records]
    assert log.outcome is not None
    assert log.outcome.finished
    assert reckoned[-1] == pytest.approx(0.0 if told else latency, abs=0.1)
    assert max(reckoned) <= (0.02 if told or not latency else latency + 0.02)


def test_fixes_that_are_coarse_show_nothing() -> None:
    floats = "machine.events=[{kind='gps_float',start=0.0,duration=1000.0,correlation=10.0}]"
    log = simulate(
        load_configuration("articulated", ["path.radii=[8.0]", "speed=2.0", LATE.format(0.2, "false"), floats]), seed=1
    )
    assert {record.actuation.hitch_latency for record in log.records} == {0.0}


@pytest.mark.parametrize("speed", [1.0, 2.0])
@pytest.mark.parametrize(("hitch", "joint"), [(0.8, 1.0), (1.2, 1.0), (1.0, 0.8), (1.0, 1.25)])
def test_a_drive_keeps_its_line_with_wrong_scales_and_tells_them(hitch: float, joint: float, speed: float) -> None:
    run = simulation(["path.radii=[8.0, 8.0]", f"speed={speed}"], 1, hitch=hitch, joint=joint)
    log = run.log()
    assert log.outcome is not None
    assert log.outcome.finished
    assert np.abs(true_path_errors(log).tractor.error).max() < 0.2
    known = log.records[-1].actuation
    assert (known.hitch_scale, known.joint_scale) == pytest.approx((1.0 / hitch - 1.0, 1.0 / joint - 1.0), abs=0.15)
    assert max(known.hitch_scale, known.joint_scale, key=abs) == (
        known.joint_scale if hitch == 1.0 else known.hitch_scale
    )


@pytest.mark.parametrize(("speed", "seed"), [(1.0, 3), (2.0, 5)])
def test_masts_that_sway_without_an_attitude_sensor_hardly_look_like_a_scale(speed: float, seed: int) -> None:
    """0.22 and 0.30, and 80 cm from the line at 2 m/s, where their distances count as much as on flat ground."""
    masts = "vehicle.masts={tractor={up=2.5},trailer={up=2.0}}"
    changes = [masts, "machine.terrain.unevenness=0.04", f"speed={speed}", "path.radii=[8.0, 8.0]"]
    log = simulate(load_configuration("articulated", changes), seed=seed)
    found = [(each.actuation.hitch_scale, each.actuation.joint_scale) for each in log.records]
    assert np.abs(found).max() < 0.18
    assert np.abs(true_path_errors(log).tractor.error).max() < 0.35


YAW_RATE = "machine.attitude={tractor={present=true},trailer={present=true}}"


@pytest.mark.parametrize("attitude", ["", YAW_RATE], ids=["wheels", "yaw rate"])
@pytest.mark.parametrize("line", ["straight", "spiral"])
def test_where_the_angles_hardly_change_their_noise_is_no_scale(line: str, attitude: str, tmp_path: Path) -> None:
    """Errors in variables: without what draws the scales to zero these were -0.1 to -0.2 after 1 to 2 km."""
    turned = np.arange(0.0, 2.0 * np.pi * 8.0, 0.02)
    radius = 20.0 + 2.0 * turned / (2.0 * np.pi)
    spiral = np.column_stack([radius * np.cos(turned), radius * np.sin(turned)])
    points = spiral if line == "spiral" else np.column_stack([np.arange(0.0, 1801.0, 2.0), np.zeros(901)])
    np.savetxt(tmp_path / "line.csv", points, delimiter=",")
    changes = [f"path.file={tmp_path / 'line.csv'}", "speed=3.0", *([attitude] if attitude else [])]
    log = simulate(load_configuration("articulated", changes), seed=1)
    assert log.outcome is not None
    assert log.outcome.finished
    found = [(each.actuation.hitch_scale, each.actuation.joint_scale) for each in log.records]
    assert np.abs(found).max() < 0.02

"""Latency and scale errors of hitch and joint in whole runs: the line is kept, and what is found is told."""

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
    run = simulation(["path.radii=[8.0]", f"speed={speed}"], 1, hitch=hitch, joint=joint)
    log = run.log()
    assert log.outcome is not None
    assert log.outcome.finished
    assert np.abs(true_path_errors(log).tractor.error).max() < 0.2
    known = log.records[-1].actuation
    assert (known.hitch_scale, known.joint_scale) == pytest.approx((1.0 / hitch - 1.0, 1.0 / joint - 1.0), abs=0.15)
    assert max(known.hitch_scale, known.joint_scale, key=abs) == (
        known.joint_scale if hitch == 1.0 else known.hitch_scale
    )

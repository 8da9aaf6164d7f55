"""Without fixes: how far off the vehicle is then, slower at once, and an end while the position is still known."""

import math

import pytest

from drawbar.config import load_configuration
from drawbar.driving.loop.estimate_uncertainty import uncertainty_of
from drawbar.simulation import RunAborted

EIGHT = "path.radii=[8.0]"
ON = ("sanity.blind_deviation=10.0", "sanity.coarse_share=1.0", "sanity.blind=60.0")
"""on and on, as if nothing were lost"""


def lost(start, duration=40.0):
    return f"machine.events=[{{kind='gps_loss', start={start}, duration={duration}}}]"


def lateral_deviation(live):
    distance, heading, bend = (float(live.array(name)[0]) for name in ("distance", "heading", "bend"))
    return distance * math.hypot(heading, bend * distance)


@pytest.mark.parametrize(("speed", "start"), [(0.5, 25.0), (1.0, 5.0), (1.0, 25.0), (2.0, 12.0), (3.0, 8.0)])
def test_what_is_reckoned_is_what_the_estimators_covariance_says(build, speed, start):
    run = build("articulated", EIGHT, f"speed={speed}", lost(start), *ON)
    tell = uncertainty_of(run.autopilot, load_configuration("articulated"))
    live = run.autopilot.library.components["run_monitor"].live
    ratios = []
    for record in run.steps():
        distance = live.array("distance")[0]
        if record.measurement.time > start + 20.0 or distance > 10.0:
            break
        if distance > 4.0:
            ratios.append(lateral_deviation(live) / tell(record.estimate).lateral)
    assert len(ratios) > 5
    assert min(ratios) > 0.55
    assert max(ratios) < 1.6


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("speed", [1.0, 2.0, 3.0])
def test_a_run_without_fixes_is_slowed_and_ends_near_the_line(build, speed, seed):
    run = build("articulated", EIGHT, f"speed={speed}", lost(20.0 / speed), seed=seed)
    log = []
    with pytest.raises(RunAborted, match=r"valid fix for .* a standard deviation across the line of 0\.15 m"):
        log.extend(run.steps())
    assert log[-1].command.speed == 0.0
    assert log[-2].command.speed <= 0.65 * speed
    off = [
        math.hypot(
            record.truth.tractor.x - record.estimate.tractor.x, record.truth.tractor.y - record.estimate.tractor.y
        )
        for record in log
    ]
    assert max(off) <= 0.8

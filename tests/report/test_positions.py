"""What the report says of positions that contradict the estimate, whose own error is in no estimated distance."""

import math

import pytest

from drawbar.config import load_configuration
from drawbar.report.metrics import compute_metrics
from drawbar.report.path_errors import estimated_path_errors
from drawbar.report.positions import position_texts
from drawbar.simulation import Simulation

SLOPE = "machine.terrain={slope=0.0873, creep=0.36}"


def metrics_of(*changes):
    with Simulation(load_configuration("articulated", ["path={radii=[8.0]}", *changes])) as simulation:
        log = simulation.log()
    return compute_metrics(log, estimated_path_errors(log))


def texts(metrics):
    return position_texts(metrics.residual_m, metrics.rejected_share, metrics.antennas_aside_m)


@pytest.mark.parametrize("change", [SLOPE, "speed=2.0"])
def test_of_a_sound_machine_nothing_is_told(change):
    metrics = metrics_of(change)
    assert texts(metrics) == []
    assert abs(metrics.antennas_aside_m) < 0.02
    assert max(metrics.residual_m.tractor, metrics.residual_m.trailer) < 0.015


def test_a_mast_that_is_known_to_lean_by_the_other_bodys_sensor_alone_is_no_error_of_the_estimate():
    masts = "vehicle.masts={tractor={up=2.5},trailer={up=2.0}}"
    metrics = metrics_of(SLOPE, masts, "machine.attitude.tractor.present=true")
    assert texts(metrics) == []
    assert metrics.residual_m.tractor < 0.015
    assert math.isnan(metrics.residual_m.trailer)


@pytest.mark.parametrize(("body", "side", "aside"), [("tractor", "left", 0.1), ("trailer", "right", -0.1)])
def test_antennas_aside_of_where_they_are_stated_are_found_on_a_slope_too(body, side, aside):
    """Both stand to the left; the estimated distances show a third of it."""
    metrics = metrics_of(SLOPE, f"machine.masts.{body}.left=0.1")
    assert metrics.antennas_aside_m == pytest.approx(aside, abs=0.02)
    (told,) = texts(metrics)
    assert f"cm further to the {side} of the trailer's" in told


def test_a_straight_line_does_not_tell_antennas_from_a_slope(tmp_path):
    line = tmp_path / "line.csv"
    line.write_text("x,y\n" + "".join(f"{0.5 * k},0.0\n" for k in range(100)), "utf-8")
    metrics = metrics_of(f'path={{file="{line.as_posix()}"}}', "machine.masts.tractor.left=0.1")
    assert math.isnan(metrics.antennas_aside_m)
    assert texts(metrics) == []


def test_a_trailer_twice_as_long_as_stated_is_told_by_its_rejected_positions():
    metrics = metrics_of("machine.lengths.trailer_length=2.0")
    assert metrics.rejected_share.trailer > 0.99
    assert "of the trailer's positions were rejected" in texts(metrics)[0]


def test_fixes_that_are_later_than_they_tell_lie_beside_the_estimate():
    late = ("speed=2.0", "machine.delays={fix={latency=0.3}, reported=false}")
    sound, metrics = metrics_of("speed=2.0"), metrics_of(*late)
    assert metrics.residual_m.tractor > 2.0 * sound.residual_m.tractor
    (told,) = texts(metrics)
    lay = round(100.0 * metrics.residual_m.tractor)
    assert f"positions lay beside the estimate (tractor {lay} cm" in told

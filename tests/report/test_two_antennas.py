"""What the report says of two antennas whose line is stated wrongly."""

import io
import math

import pytest
from rich.console import Console

from drawbar.config import load_configuration
from drawbar.recording.log import LOG_NAME
from drawbar.recording.recorder import Recorder
from drawbar.report.console import summary
from drawbar.report.folder import write_report
from drawbar.report.two_antennas import yaw_text
from drawbar.simulation import Simulation


def reported(folder, *changes):
    """Return the metrics, and what console and page say, of a short run."""
    configuration = load_configuration("articulated", ["path={radii=[8.0], straight_length=5.0}", *changes])
    with Simulation(configuration) as simulation, Recorder(folder / LOG_NAME, simulation.header()) as recorder:
        for record in simulation.steps():
            recorder.write(record)
    metrics, console = write_report(folder), Console(file=io.StringIO(), width=1000)
    console.print(summary(metrics))
    return metrics, console.file.getvalue(), (folder / "report.html").read_text("utf-8")


@pytest.mark.parametrize(("bias", "told"), [(0.05, ""), (0.3, "antennas is +17."), (-1.6, "antennas is -91.")])
def test_antennas_off_their_stated_line_are_told_where_no_yaw_is_believed(bias, told, tmp_path):
    metrics, *texts = reported(tmp_path, f"machine.attitude.yaw={{present=true, bias={bias}}}")
    assert metrics.yaw_difference_rad == pytest.approx(bias, abs=0.01)
    for text in texts:
        assert (told in text) if told else ("antennas is" not in text)


def test_antennas_that_are_exchanged_are_half_a_turn_off(tmp_path):
    metrics, *_ = reported(tmp_path, "machine.attitude.yaw={present=true, bias=3.14}")
    assert math.pi - 0.02 < abs(metrics.yaw_difference_rad) <= math.pi


def test_without_two_antennas_nothing_is_said(tmp_path):
    metrics, *_ = reported(tmp_path)
    assert math.isnan(metrics.yaw_difference_rad)
    assert yaw_text(math.nan) == ""

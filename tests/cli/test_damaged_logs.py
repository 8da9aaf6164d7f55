"""Commands that read a log say what of it is damaged or cut off."""

import csv
import os
import subprocess
import sys
from pathlib import Path

import pytest
from short_run import SHORT, Drawbar

from drawbar.recording.log import RunLog, read_log
from drawbar.recording.recorder import Recorder


@pytest.fixture
def run(drawbar: Drawbar) -> RunLog:
    """Return the log of a short run in ./run."""
    assert drawbar("run", *SHORT, "--set", "path.straight_length=12.0", "--out", "run")[0] == 0
    return read_log(Path("run/log.mcap"))


def without(log: RunLog, *lost: int) -> Path:
    """Write a log that lacks some steps; return its file."""
    file = Path("damaged/log.mcap")
    file.parent.mkdir()
    with Recorder(file, log.header) as recorder:
        for record in log.records:
            if record.step not in lost:
                recorder.write(record)
    return file


def test_a_steering_is_identified_of_steps_that_follow_each_other(drawbar: Drawbar, run: RunLog) -> None:
    file = without(run, 20, 21)
    code, told = drawbar("identify", str(file.parent))
    assert code == 0, told
    assert "steps 20 to 21 are lost" in told
    with Recorder(Path("behind.mcap"), run.header) as recorder:
        for record in run.records[22:]:
            recorder.write(record)
    assert drawbar("identify", "behind.mcap")[1].splitlines()[1:3] == told.splitlines()[1:3]


@pytest.mark.skipif(os.name != "posix", reason="has no /dev/stdout")
def test_a_table_on_standard_output_holds_no_losses_and_no_names(run: RunLog) -> None:
    file = without(run, 20, 21)
    command = [sys.executable, "-m", "drawbar", "log", "export", str(file), "--csv", "/dev/stdout"]
    done = subprocess.run([*command, "--ros2", "ros2.mcap"], capture_output=True, text=True, check=True)
    rows = list(csv.reader(done.stdout.splitlines()))
    assert len(rows) == 1 + len(run.records) - 2
    assert {len(row) for row in rows} == {len(rows[0])}
    assert "steps 20 to 21 are lost" in done.stderr
    assert "ros2.mcap" in done.stderr


def test_steps_with_gaps_are_no_stretch(drawbar: Drawbar, run: RunLog) -> None:
    file = without(run, *range(0, len(run.records), 40))
    code, told = drawbar("identify", str(file.parent))
    assert code == 2
    assert "steers for less than 10 s without a gap" in told


def test_a_log_without_steps_is_not_called_recomputed(drawbar: Drawbar, run: RunLog) -> None:
    code, told = drawbar("replay", str(without(run, *range(len(run.records)))))
    assert code == 2
    assert "holds no step to recompute" in told
    assert "bit for bit" not in told


def test_a_log_that_is_cut_off_in_its_beginning_says_so(drawbar: Drawbar, run: RunLog) -> None:
    file = Path("run/log.mcap")
    file.write_bytes(file.read_bytes()[:500])
    code, told = drawbar("report", "run")
    assert code == 2
    assert "holds no run.json, which a log begins with; it was cut off in its beginning, or is no log of" in told


@pytest.mark.parametrize(
    "command",
    [
        ("replay",),
        ("identify",),
        ("report",),
        ("log", "export", "--csv=steps.csv"),
        ("tube", "articulated", "--from-log"),
    ],
)
def test_a_log_that_is_cut_off_at_its_end_says_so_once(drawbar: Drawbar, run: RunLog, command: tuple[str, ...]) -> None:
    file = Path("run/log.mcap")
    whole = file.read_bytes()
    assert "just stops" not in drawbar(*command, "run")[1]
    file.write_bytes(whole[: len(whole) * 9 // 10])
    code, told = drawbar(*command, "run")
    assert code == 0, told
    assert " ".join(told.split()).count("the log just stops: the program was killed or still runs, or the file is") == 1

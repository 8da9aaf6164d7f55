"""Short runs on one process and on two."""

import re
import subprocess
import sys

import pytest

COMMAND = [sys.executable, "-m", "drawbar.experiment.speed_up"]


@pytest.mark.parametrize("runs", ["0", "-3", "many"])
def test_what_is_no_number_of_runs_is_refused(runs: str) -> None:
    done = subprocess.run([*COMMAND, runs], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert runs in done.stderr


def test_the_times_of_the_same_runs_on_one_process_and_on_two_are_printed() -> None:
    done = subprocess.run([*COMMAND, "2"], capture_output=True, text=True, check=True)
    found = re.fullmatch(
        r"2 runs: (.+) s on one process, (.+) s on two: (.+) times as fast, medians of \d turns\n", done.stdout
    )
    assert found, done.stdout
    one, two, ratio = map(float, found.groups())
    assert min(one, two, ratio) > 0.0

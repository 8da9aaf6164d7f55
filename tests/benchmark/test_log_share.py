"""The cost of a log, of a short run."""

import re
import subprocess
import sys

import pytest

COMMAND = [sys.executable, "-m", "drawbar.benchmark.log_share"]


@pytest.mark.parametrize("stretches", ["0", "-3", "many"])
def test_what_is_no_number_of_stretches_is_refused(stretches: str) -> None:
    done = subprocess.run([*COMMAND, stretches], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert stretches in done.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="a process is bound to one core elsewhere by other means")
def test_the_cost_of_a_log_is_printed_and_an_hour_has_40_mb_at_most() -> None:
    done = subprocess.run([*COMMAND, "5"], capture_output=True, text=True, check=True)
    found = re.fullmatch(
        r"log: (.+) µs of (.+) a step, (.+) % of the run; (.+) bytes a step, (.+) MB an hour at 5 Hz\n", done.stdout
    )
    assert found, done.stdout
    added, step, _, size, hour = map(float, found.groups())
    assert added < step
    assert 1000.0 < size < 2200.0
    assert 18.0 < hour < 40.0

"""The cost of a log, of a short run."""

import re
import subprocess
import sys

import pytest


@pytest.mark.skipif(sys.platform != "linux", reason="a process is bound to one core elsewhere by other means")
def test_the_cost_of_a_log_is_printed_and_an_hour_has_40_mb_at_most() -> None:
    command = [sys.executable, "-m", "drawbar.benchmark.log_share", "5"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    found = re.fullmatch(
        r"log: (.+) µs of (.+) a step, (.+) % of the run; (.+) bytes a step, (.+) MB an hour at 5 Hz\n", done.stdout
    )
    assert found, done.stdout
    added, step, _, size, hour = map(float, found.groups())
    assert added < step
    assert 1000.0 < size < 2200.0
    assert 18.0 < hour < 40.0

"""The cost of a report, of a short run."""

import re
import subprocess
import sys

import pytest


@pytest.mark.skipif(sys.platform != "linux", reason="the memory of a process is told in other units elsewhere")
def test_the_cost_of_a_report_is_that_of_a_process_of_its_own() -> None:
    # in a small process: Linux counts the memory of the one that starts another as the other's
    command = [sys.executable, "-m", "drawbar.benchmark.long_report", "0.1"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    last = done.stdout.splitlines()[-1]
    found = re.fullmatch(
        r"report from a log of (.+) MB: (.+) s, at most (.+) MB of memory, report.html of (.+) MB", last
    )
    assert found, last
    log_mb, seconds, peak_mb, html_mb = map(float, found.groups())
    assert 0.3 < log_mb < 3.0
    assert seconds > 0.1
    assert 60.0 < peak_mb < 300.0
    assert 4.0 < html_mb < 10.0

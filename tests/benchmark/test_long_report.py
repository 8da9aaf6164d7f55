"""The cost of a report, of a short run."""

import sys

import pytest

from drawbar.benchmark.long_report import report_cost


@pytest.mark.skipif(sys.platform != "linux", reason="the memory of a process is told in other units elsewhere")
def test_the_cost_of_a_report_is_that_of_a_process_of_its_own() -> None:
    cost = report_cost(0.1)
    assert 0.3 < cost.log_mb < 3.0
    assert cost.seconds > 0.1
    assert 60.0 < cost.peak_mb < 300.0
    assert 4.0 < cost.html_mb < 10.0

"""A short watched run of each shipped configuration, driven once for all tests of this folder."""

import pytest

from drawbar.benchmark.closed_loop import probed_runs
from drawbar.benchmark.probe import Probe

STAGES, STEPS = 5, 30


@pytest.fixture(scope="session", params=["paper", "articulated"])
def probes(request: pytest.FixtureRequest) -> list[Probe]:
    return probed_runs(request.param, [STAGES], STEPS, with_peers=True)[0]

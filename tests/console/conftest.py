"""A short simulated run, made once."""

import pytest

from drawbar.config import load_configuration
from drawbar.simulation import simulate


@pytest.fixture(scope="session")
def run_log():
    """Return the log of a run along one figure-eight, and its configuration."""
    configuration = load_configuration("articulated", ["path.radii=[4.0]", "path.straight_length=1.0"])
    return simulate(configuration, 1), configuration

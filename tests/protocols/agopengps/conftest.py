"""Both firmwares of steer boards."""

import pytest
from steer_bench import BOARDS


@pytest.fixture(params=BOARDS)
def firmware(request: pytest.FixtureRequest) -> str:
    """Return the name of a firmware; a test is run with each."""
    return str(request.param)

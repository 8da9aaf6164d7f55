"""Configurations as files, and what refuses them."""

from collections.abc import Callable

import pytest

from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError

SMALLEST = """
name = "mine"
estimator = { model = "articulated" }
controller = { model = "articulated" }
tube = { tractor = { yaw = -0.3 }, trailer = { yaw = 0.3 } }
"""

Write = Callable[[str | bytes], str]


def refusal(source: str, *changes: str) -> str:
    with pytest.raises(ConfigurationError) as caught:
        load_configuration(source, changes)
    return str(caught.value)

"""What tests of the low level share."""

from collections.abc import Callable
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[3] / "docs"


@pytest.fixture
def repository_page() -> Callable[[str], str]:
    """Return a function that reads a page of the documentation."""
    return lambda name: (DOCS / name).read_text("utf-8")

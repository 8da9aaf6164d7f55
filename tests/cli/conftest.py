"""The command line in a folder of its own."""

from pathlib import Path

import pytest
from short_run import Drawbar


@pytest.fixture
def drawbar(drawbar: Drawbar, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Drawbar:
    """Return the function that runs the command line, inside tmp_path."""
    monkeypatch.chdir(tmp_path)
    return drawbar

"""Golden files that some machines have beside the repository; tests without theirs are skipped with the reason."""

import json
import os
from pathlib import Path
from typing import Any

import pytest

FOLDER = Path(os.environ.get("DRAWBAR_SHARED", Path(__file__).parents[3] / "shared")) / "vectors"


def load(name: str) -> Any:
    """Return what a golden JSON file holds, or skip the test."""
    file = FOLDER / name
    if not file.is_file():
        pytest.skip(f"the golden file ../shared/vectors/{name} is not on this machine")
    return json.loads(file.read_text())

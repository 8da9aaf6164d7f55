"""Golden files that some machines have beside the repository; tests without theirs are skipped with the reason."""

import csv
import json
import os
from pathlib import Path
from typing import Any

import pytest

FOLDER = Path(os.environ.get("DRAWBAR_SHARED", Path(__file__).parents[3] / "shared")) / "vectors"


def text(name: str) -> str:
    """Return a golden file, or skip the test."""
    file = FOLDER / name
    if not file.is_file():
        pytest.skip(f"the golden file ../shared/vectors/{name} is not on this machine")
    return file.read_text("utf-8")


def load(name: str) -> Any:
    """Return what a golden JSON file holds, or skip the test."""
    return json.loads(text(name))


def rows(name: str) -> list[dict[str, float]]:
    """Return the rows of a golden table, or skip the test."""
    return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(text(name).splitlines())]

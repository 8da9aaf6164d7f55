"""The tutorial's example runs, does what the tutorial says, and is what the tutorial shows."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from drawbar.geometry import Floats

ROOT = Path(__file__).parents[1]
EXAMPLE = ROOT / "examples" / "own_vehicle.py"
TUTORIAL = ROOT / "docs" / "tutorial.md"
SETTLED = slice(100, None)
"""samples after 10 s"""


def _imported(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module  # where dataclasses look themselves up
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def example() -> ModuleType:
    return _imported(EXAMPLE)


@pytest.fixture(scope="module", params=range(5), ids="seed {}".format)
def record(example: ModuleType, request: pytest.FixtureRequest) -> Floats:
    record: Floats = example.run(seconds=60.0, seed=request.param)
    return record


def test_settles_on_the_circle(record: Floats) -> None:
    distance = np.abs(record[SETTLED, 0])
    assert record[0, 0] == 1.5
    assert distance.mean() < 0.01
    assert distance.max() < 0.04


def test_steers_at_the_bound_first_and_never_beyond(example: ModuleType, record: Floats) -> None:
    steering = np.abs(record[:, 3])
    assert (steering <= example.LIMIT + 1e-9).all()
    assert (steering[:10] > example.LIMIT - 1e-6).all()
    assert (steering[SETTLED] < example.LIMIT / 2).all()


def test_finds_out_heading_and_offset(record: Floats) -> None:
    _, yaw, offset, _ = record[SETTLED].T
    assert np.sqrt(np.mean(yaw**2)) < np.radians(0.4)
    assert np.sqrt(np.mean(offset**2)) < np.radians(0.15)


def test_prints_what_the_tutorial_shows() -> None:
    printed = subprocess.run([sys.executable, EXAMPLE], capture_output=True, text=True, check=True).stdout
    (shown,) = re.findall(r"```text\n(.*?)```", TUTORIAL.read_text("utf-8"), re.DOTALL)
    for ours, theirs in zip(printed.split(), shown.split(), strict=True):
        try:  # compilers round the last digits differently
            assert float(ours.strip("[]")) == pytest.approx(float(theirs.strip("[]")), abs=0.02)
        except ValueError:
            assert ours == theirs


def test_the_tutorial_quotes_the_example() -> None:
    blocks = re.findall(r"```python\n(.*?)```", TUTORIAL.read_text("utf-8"), re.DOTALL)
    source = EXAMPLE.read_text("utf-8")
    assert blocks
    for block in blocks:
        assert block in source

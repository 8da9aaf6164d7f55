"""The stack that the manifest states, against what a Cortex-M7 was seen to use."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

MOST = 16 * 1024
OUTSIDE = 768
"""of the program around the library and of the C library's mathematics, bytes"""


def test_no_more_than_stated(record: Callable, forced_player: Any, for_targets: Path, tmp_path: Path) -> None:
    """The deepest chain of calls ends in the interior point, which hardly any step enters unless it is forced."""
    seen = forced_player.play(record("articulated", "start.left=3.0", steps=20), tmp_path).stack
    manifest = json.loads((for_targets / "manifest.json").read_text("utf-8"))
    stated = manifest["targets"]["cortex-m7"]["stack_bytes"]["drawbar_step"]
    assert 0.8 * stated < seen <= stated + OUTSIDE
    assert stated + OUTSIDE <= MOST

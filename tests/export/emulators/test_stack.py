"""The stack that the manifest states, against what a Cortex-M7 was seen to use."""

from collections.abc import Callable
from pathlib import Path

from drawbar.export.stack import CallGraph

MOST = 16 * 1024
OUTSIDE = 768
"""of the program around the library and of the C library's mathematics, bytes"""


def test_no_more_than_stated(record: Callable, player: Callable, built: Callable, tmp_path: Path) -> None:
    seen = player("cortex-m7").play(record("articulated", "start.left=3.0", steps=20), tmp_path).stack
    stated = CallGraph(built("cortex-m7").units).worst("drawbar_step").size
    assert 0.8 * stated < seen <= stated + OUTSIDE
    assert stated + OUTSIDE <= MOST

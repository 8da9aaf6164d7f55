"""The stack that the manifest states, against what a Cortex-M7 was seen to use."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from forced_solvers import ROUTES, forced

from drawbar.export.stack import CallGraph
from drawbar.export.targets import find_target
from drawbar.export.toolchain import build_target

TARGET = "cortex-m7"
MOST = 16 * 1024
OUTSIDE = 768
"""of the program around the library and of the C library's mathematics, bytes"""


@pytest.mark.parametrize("route", ROUTES)
def test_no_more_than_stated(
    route: str, player: Callable, record: Callable, exported: Callable, tmp_path: Path
) -> None:
    """The deepest chain of calls ends in the interior point, which hardly any step enters unless it is forced.

    What is stated is the forced library's own: its text differs, and with it what the compiler makes one function of.
    """
    library = forced(exported("articulated"), tmp_path / "forced", route)
    stated = CallGraph(build_target(find_target(TARGET), library).units).worst("drawbar_step").size
    seen = player(TARGET, library).play(record("articulated", "start.left=3.0", steps=20), tmp_path).stack
    assert 0.8 * stated < seen <= stated + OUTSIDE


def test_what_the_product_states(player: Callable, record: Callable, for_targets: Path, tmp_path: Path) -> None:
    stated = json.loads((for_targets / "manifest.json").read_text("utf-8"))["targets"][TARGET]["stack_bytes"]
    seen = player(TARGET).play(record("articulated", "start.left=3.0", steps=20), tmp_path).stack
    assert seen <= stated["drawbar_step"] + OUTSIDE <= MOST

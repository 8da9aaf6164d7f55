"""The exported library gives the commands of the Python product, on every target.

Of more configurations test_same_library.py holds that, bit for bit.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drawbar.export.targets import TARGETS, Precision
from drawbar.signals import FixStatus, Flag

LOSSES = (
    "{kind='gps_loss', start=100, duration=6}",
    "{kind='gps_loss', start=130, duration=10, antenna='tractor', report='held'}",
    "{kind='gps_loss', start=250, duration=6}",
    "{kind='side_slope', start=200, crab=0.1}",
)
BUMPS = tuple(
    f"{{kind='bump', start={start}, tractor_yaw={turn}, trailer_yaw={turn}}}"
    for start, turn in zip(range(20, 92, 12), (0.25, -0.25) * 3, strict=True)
)
EVENTS = f"machine.events=[{', '.join((*LOSSES, *BUMPS))}]"
EARLY = "machine.events=[{kind='gps_loss', start=20, duration=6}]"
INTERIOR_POINT = 1e-7
"""to which the solver's answer is judged where it is the interior point's, rad"""
SINGLE = 2e-4
"""what single precision may make of a command, rad; 5e-5 have been seen"""


@pytest.fixture(scope="session")
def run(record: Callable) -> Any:
    """A full run of the product: bumps let the joint saturate, fixes are lost, a sensor glitches."""
    return record("articulated", EVENTS, "start.left=3.0", glitches=True)


def test_the_run_holds_what_it_is_recorded_for(run: Any) -> None:
    assert len(run.records) > 1800, "the path was not driven to its end"
    fixes = [(record.estimate.tractor_fix, record.estimate.trailer_fix) for record in run.records]
    assert fixes.count((FixStatus.MISSING, FixStatus.MISSING)) == 60
    assert sum(tractor is FixStatus.STALE for tractor, _ in fixes) > 40
    assert sum(record.trailer_steering.saturated for record in run.records) > 2
    assert sum(bool(record.flags & Flag.SLOWED) for record in run.records) > 100


def test_as_python_compiles_it(run: Any, native: Callable, tmp_path: Path) -> None:
    replay = native("articulated").play(run, tmp_path)
    assert replay.statuses == run.statuses
    np.testing.assert_array_equal(replay.commands, run.commands)


@pytest.mark.parametrize(
    "target", [target.name for target in TARGETS if target.name not in ("macos-aarch64", "cortex-m4")]
)
def test_commands_on_other_targets_are_those_of_this_computer(
    target: str, run: Any, player: Callable, tmp_path: Path
) -> None:
    replay = player(target).play(run, tmp_path)
    assert replay.statuses == run.statuses
    np.testing.assert_allclose(replay.commands, run.commands, rtol=0.0, atol=INTERIOR_POINT)
    assert np.mean(np.abs(replay.commands - run.commands) <= 1e-9) >= 0.999


@pytest.mark.parametrize(
    ("target", "steps"), [("cortex-m7", 300), ("cortex-m4", 40)]
)  # the latter takes 35 times as long
def test_linked_by_the_compiler_of_arm(
    target: str, steps: int, record: Callable, arm_player: Callable, tmp_path: Path
) -> None:
    run = record("articulated", EARLY, steps=steps)
    replay = arm_player(target).play(run, tmp_path)
    median, longest = np.median(replay.instructions), np.max(replay.instructions)
    print(f"\n{target}: {median:.2f} million instructions in the median step, {longest:.2f} in the longest")
    assert replay.statuses == run.statuses
    np.testing.assert_allclose(replay.commands, run.commands, rtol=0.0, atol=1e-9)


def test_single_precision_on_a_processor_with_a_unit_for_it(
    record: Callable, arm_player: Callable, native: Callable, tmp_path: Path
) -> None:
    run = record("articulated", EARLY, steps=300)
    (tmp_path / "here").mkdir()
    here = native("articulated", Precision.SINGLE).play(run, tmp_path / "here")
    replay = arm_player("cortex-m4", Precision.SINGLE).play(run, tmp_path)
    assert replay.statuses == here.statuses == run.statuses
    median, longest = np.median(replay.instructions), np.max(replay.instructions)
    print(f"\ncortex-m4, single: {median:.2f} million instructions in the median step, {longest:.2f} in the longest")
    np.testing.assert_allclose(replay.commands, here.commands, rtol=0.0, atol=SINGLE)
    np.testing.assert_allclose(replay.commands, run.commands, rtol=0.0, atol=SINGLE)

"""Errors of hitch and joint within alignment: what teaches them, and what their corrections do."""

import math
from dataclasses import replace
from typing import Any

import pytest
from alignment import Alignment
from angle_drive import PARTS, SAMPLE, VEHICLE, Drive, drive
from ordinary import believed, measured

from drawbar.signals import FixStatus, Pose


def late_by_alignment(driven: Drive, **values: Any) -> float:
    """Return the latency that alignment finds of a hitch angle 0.15 s late, s; of estimates with these values."""
    alignment, last = Alignment(VEHICLE), None
    for k in range(2, len(driven.yaw) // PARTS):
        points, yaw, joint = driven.points[k * PARTS], driven.yaw[k * PARTS], driven.joint[k * PARTS]
        hitch, late = driven.hitch_at(k, 0.0), driven.hitch_at(k, 0.15)
        tractor = Pose(x=points[0], y=points[1], yaw=yaw)
        trailer = Pose(x=points[2], y=points[3], yaw=yaw - hitch - joint)
        now = replace(believed(tractor, trailer, time=k * SAMPLE, speed=2.0, hitch_angle=hitch), **values)
        if last is not None:
            seen = measured(*points, time=now.time, speed=2.0, hitch_angle=late, trailer_steering=joint)
            alignment.apply(seen, last, now)
        last = now
    return alignment.found().hitch_latency


def test_the_creep_that_is_estimated_counts() -> None:
    soft = drive(300, creep=0.36)
    assert late_by_alignment(soft) < 0.07
    assert 0.1 < late_by_alignment(soft, creep=0.36) < 0.16


@pytest.mark.parametrize("antenna", ["tractor_fix", "trailer_fix"])
def test_while_positions_of_an_antenna_are_rejected_nothing_is_learned(antenna: str) -> None:
    driven = drive(300)
    assert late_by_alignment(driven) > 0.1
    assert late_by_alignment(driven, **{antenna: FixStatus.REJECTED}) == 0.0


@pytest.mark.parametrize("age", [math.nan, 0.0, 0.05])
def test_what_is_found_adds_to_the_age_that_is_told(age: float) -> None:
    alignment = Alignment(VEHICLE)
    alignment.live.array("angles.latency")[...] = 0.1
    before = believed(Pose(x=0.0, y=0.0, yaw=0.0), Pose(x=-2.15, y=0.0, yaw=0.0), time=1.0)
    now = replace(before, time=1.2, hitch_angle=0.06)
    aligned = alignment.apply(
        measured(0.0, 0.0, -2.15, 0.0, time=1.2, hitch_angle=0.02, hitch_angle_age=age), before, now
    )
    assert aligned.hitch_angle == pytest.approx(0.02 + 0.3 * (0.1 + (0.0 if math.isnan(age) else age)), abs=1e-12)

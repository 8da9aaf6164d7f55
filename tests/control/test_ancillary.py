import math
from dataclasses import replace

import numpy as np
import pytest

from drawbar.control.ancillary import AncillaryLaw
from drawbar.control.settings import AncillaryGain
from drawbar.signals import BodyPlan, Pose, SolverStatus

GAIN = AncillaryGain(lateral=-0.4, yaw=-1.5)
LIMIT = 0.5


def plan(steering, predicted=(0.0, 0.0, 0.0)):
    poses = np.array([[-1.0, 5.0, 0.3], predicted, [9.0, 9.0, 9.0]])
    return BodyPlan(steering=steering, poses=poses, steerings=np.zeros(2), status=SolverStatus.SOLVED)


def second(predicted, pose, *, steering=0.0, gain=GAIN):
    """Return the steering of the sample after the one that predicted."""
    law = AncillaryLaw(gain, LIMIT)
    law.apply(plan(0.0, predicted), Pose(x=1.0, y=2.0, yaw=3.0))
    return law.apply(plan(steering, (7.0, 7.0, 7.0)), pose)


def test_the_first_sample_has_no_prediction_to_hold():
    steering = AncillaryLaw(GAIN, LIMIT).apply(plan(0.2), Pose(x=3.0, y=4.0, yaw=1.0))
    assert (steering.nominal, steering.ancillary, steering.command) == (0.2, 0.0, 0.2)
    assert not steering.saturated


def test_the_law_is_the_formula_in_the_predicted_frame():
    rng = np.random.default_rng(31)
    for _ in range(100):
        x, y, yaw, along, across, turn = rng.normal(size=6).tolist()
        pose = Pose(
            x=x + along * math.cos(yaw) - across * math.sin(yaw),
            y=y + along * math.sin(yaw) + across * math.cos(yaw),
            yaw=yaw + 0.1 * turn,
        )
        steering = second((x, y, yaw), pose, gain=AncillaryGain(lateral=-0.01, yaw=-0.2), steering=0.05)
        assert steering.ancillary == pytest.approx(-0.01 * across - 0.02 * turn, abs=1e-12)
        assert steering.command == 0.05 + steering.ancillary
        assert not steering.saturated


def test_the_law_does_not_see_where_north_is():
    reference = second((1.0, 2.0, 0.3), Pose(x=1.1, y=2.2, yaw=0.35)).ancillary
    for angle in (1.0, math.pi, -2.0, 40.0):
        c, s = math.cos(angle), math.sin(angle)

        def turned(x, y, c=c, s=s):
            return c * x - s * y + 30.0, s * x + c * y - 20.0

        x, y = turned(1.1, 2.2)
        moved = second((*turned(1.0, 2.0), 0.3 + angle), Pose(x=x, y=y, yaw=0.35 + angle))
        assert moved.ancillary == pytest.approx(reference, abs=1e-9)


def test_a_whole_turn_between_estimate_and_prediction_is_none():
    one = second((0.0, 0.0, 3.1), Pose(x=0.0, y=0.0, yaw=3.2)).ancillary
    assert one == pytest.approx(-0.15)
    assert second((0.0, 0.0, 3.1), Pose(x=0.0, y=0.0, yaw=3.2 - 2.0 * math.pi)).ancillary == pytest.approx(one)


def test_the_mirrored_world_gives_the_mirrored_steering():
    one = second((0.0, 0.1, 0.2), Pose(x=0.1, y=0.3, yaw=0.1), steering=0.05)
    other = second((0.0, -0.1, -0.2), Pose(x=0.1, y=-0.3, yaw=-0.1), steering=-0.05)
    assert other.command == pytest.approx(-one.command, abs=1e-15)


def test_the_sum_is_clipped_and_the_clip_is_reported():
    for sign in (1.0, -1.0):
        steering = second((0.0, 0.0, 0.0), Pose(x=0.0, y=0.0, yaw=-0.1 * sign), steering=0.45 * sign)
        assert steering.ancillary == pytest.approx(0.15 * sign)
        assert steering.command == LIMIT * sign
        assert steering.saturated
    assert not second((0.0, 0.0, 0.0), Pose(x=0.0, y=0.0, yaw=0.0), steering=LIMIT).saturated


def test_what_is_not_finite_is_neither_clipped_nor_counted_as_clipped():
    steering = second((0.0, 0.0, 0.0), Pose(x=math.nan, y=0.0, yaw=0.0), steering=0.1)
    assert math.isnan(steering.command)
    assert not steering.saturated
    assert second((0.0, 0.0, 0.0), Pose(x=0.0, y=0.0, yaw=0.0), steering=math.inf).command == math.inf


def test_only_the_newest_prediction_counts():
    law = AncillaryLaw(GAIN, LIMIT)
    standing = Pose(x=0.0, y=0.0, yaw=0.0)
    law.apply(plan(0.0, (0.0, 0.5, 0.0)), standing)
    assert law.apply(plan(0.0, (0.0, 0.0, 0.0)), standing).ancillary == pytest.approx(0.2)
    assert law.apply(plan(0.0), replace(standing)).ancillary == 0.0

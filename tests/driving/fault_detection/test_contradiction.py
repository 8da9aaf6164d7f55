"""Contradiction: detectors that each see a part see one wrong angle together, and the wrong sensor is named."""

import math

import pytest

from drawbar.driving.fault_detection.contradiction import Contradiction, Shares, contradiction

DEGREE = math.pi / 180.0
BEYOND = Shares(angles=1.01)


def test_one_beyond_its_own_limit_is_enough():
    assert contradiction(BEYOND, 0.0, astray=False) is Contradiction.TRAILER
    assert contradiction(Shares(angles=0.99), 0.0, astray=False) is Contradiction.NONE


@pytest.mark.parametrize("parts", [(0.7, 0.0, 0.8, 0.7), (0.6, 0.9, 0.85, 0.6), (0.95, 0.0, 0.95, 0.0)])
def test_several_near_their_limits_are_one_contradiction(parts):
    shares = Shares(*parts)
    assert contradiction(shares, 0.0, astray=False) is Contradiction.TRAILER
    for i in range(4):
        alone = Shares(*(part if i == j else 0.0 for j, part in enumerate(parts)))
        assert contradiction(alone, 0.0, astray=False) is Contradiction.NONE


def test_what_a_reversed_sensor_would_do_counts_half():
    assert contradiction(Shares(residuals=0.6, reversed=0.99, angles=0.8), 0.0, astray=False) is Contradiction.NONE


def test_an_estimate_that_is_astray_has_followed_a_wrong_angle():
    assert contradiction(Shares(), 0.0, astray=True) is Contradiction.TRAILER


def test_a_hitch_sensor_that_rather_looks_reversed_bends_the_turns_of_the_estimate_too():
    for turning, seen in ((0.6, Contradiction.TRAILER), (0.8, Contradiction.FRONT_WHEELS)):
        shares = Shares(residuals=0.7, reversed=0.7, angles=0.9, turning=turning)
        assert contradiction(shares, 5.0 * DEGREE, astray=False) is seen


@pytest.mark.parametrize(
    ("turning", "seen"),
    [
        (3.0, Contradiction.TRAILER),
        (-3.6, Contradiction.FRONT_WHEELS),
        (3.6, Contradiction.FRONT_WHEELS),
        (math.nan, Contradiction.TRAILER),
    ],
)
@pytest.mark.parametrize("shares", [BEYOND, Shares(0.7, 0.0, 0.8, 0.7), None])
def test_where_the_tractor_turns_otherwise_its_wheels_are_measured_wrong(shares, turning, seen):
    assert contradiction(shares or Shares(), turning * DEGREE, astray=shares is None) is seen

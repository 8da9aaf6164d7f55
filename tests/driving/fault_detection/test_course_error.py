"""Course error: an estimate that moves in another direction than the antenna has followed a wrong sensor."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from fixes import fixes_of

from drawbar.driving.fault_detection.course_error import CourseError

DEGREE = math.pi / 180.0
FAULT = 20.0
"""time from which the estimate is astray, s"""


def found(
    astray, *, rate=0.0, speed=2.0, forward=0.0, noise=0.5, late=0.01, crab=0.0, sample_time=0.2, every=1, until=10.0
):
    """Return after how long an estimate is seen to be astray, s; infinity: never.

    astray(t): direction of the estimate less the antenna's, a time after the fault, degrees; rate: of the yaw, rad/s;
    noise: of courses, degrees; late: age of an epoch at its step, s; every: steps from epoch to epoch.
    """
    error, rng = CourseError(forward, sample_time), np.random.default_rng(5)
    for k in range(round((FAULT + until) / sample_time)):
        time = k * sample_time
        if k % every == 0:
            epoch = 1.0 + time - late
            course = (
                3.0 + rate * (epoch - 1.0) + crab + math.atan(forward * rate / speed) + rng.normal(0.0, noise) * DEGREE
            )
            course = math.remainder(course, math.tau)
            error.receive_fixes(fixes_of(epoch=round(1e9 * epoch), tractor_speed=speed, tractor_course=course))
        yaw = 3.0 + rate * time + DEGREE * (astray(time - FAULT) if time >= FAULT else 0.0)
        pose = SimpleNamespace(yaw=math.remainder(yaw, math.tau))
        error.update(
            SimpleNamespace(estimate=SimpleNamespace(time=1.0 + time, tractor=pose, tractor_crab=crab, speed=speed))
        )
        if error.is_large:
            assert time >= FAULT
            return time - FAULT
    return math.inf


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    "settings", [{}, {"rate": 0.25, "forward": 1.0}, {"crab": 0.2}, {"late": 0.3}, {"late": -0.03}]
)
def test_an_estimate_that_goes_astray_is_seen_within_a_second(side, settings):
    assert found(lambda t: side * 10.0, **settings) <= 0.81
    assert found(lambda t: side * 4.0, **settings) == math.inf


def test_three_epochs_in_a_row_count_at_any_rate():
    assert found(lambda t: 10.0, sample_time=0.05) == pytest.approx(0.1)
    assert found(lambda t: 10.0, every=5) == pytest.approx(2.0)
    assert found(lambda t: 10.0 if t < 0.3 else 0.0) == math.inf
    assert found(lambda t: 10.0 * (-1.0) ** round(5.0 * t)) == math.inf


def test_where_masts_swing_more_is_usual():
    assert found(lambda t: 10.0, noise=4.0) == math.inf
    assert found(lambda t: 40.0, noise=4.0) <= 0.81


def test_slow_or_late_epochs_say_nothing():
    assert found(lambda t: 90.0, speed=0.6) == math.inf
    assert found(lambda t: 90.0, late=1.5) == math.inf


def test_where_there_is_no_estimate_nothing_is_kept():
    """A run that has ended leaves none, for as long as nobody begins the next."""
    error, nan = CourseError(0.0, 0.2), math.nan
    for k in range(100):
        time = nan if k >= 20 else 0.2 * k
        pose = SimpleNamespace(yaw=time)
        error.update(SimpleNamespace(estimate=SimpleNamespace(time=time, tractor=pose, tractor_crab=time, speed=time)))
    assert not error._estimates


def test_what_is_computed_again_is_judged_anew():
    error = CourseError(0.0, 0.2)
    error._in_a_row = 3
    assert error.is_large
    error.clear()
    assert not error.is_large

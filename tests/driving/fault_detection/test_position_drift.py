"""Position drift: positions of both antennas are held against the velocities that their receivers report."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest

from drawbar.driving.fault_detection.position_drift import PositionDrift
from drawbar.messages import Fixes
from drawbar.signals import FixQuality, Measurement

PERIOD = 0.2
UNUSED = ("tractor_x", "tractor_y", "trailer_x", "trailer_y", "hitch_angle", "speed", "tractor_steering")
UNUSED += ("trailer_steering",)


def epoch(time, *, speed=2.0, radius=math.inf, noise=(0.0,) * 4, aside=(0.0, 0.0), told=1.0, lag=0.0, **given):
    """Return what both receivers say at a time (s) on a line or circle; aside in m to the left of the start."""
    turned = speed * time / radius
    x = radius * math.sin(turned) if turned else speed * time
    y = radius * (1.0 - math.cos(turned)) if turned else 0.0
    values = dict.fromkeys((field.name for field in fields(Fixes)), 0)
    values["epoch"] = round((1.0 + time) * 1e9)
    for i, body in enumerate(("tractor", "trailer")):
        values |= {
            f"{body}_x": x + noise[2 * i],
            f"{body}_y": y + noise[2 * i + 1] + aside[i],
            f"{body}_speed": told * speed,
            f"{body}_course": turned - speed * lag / radius,
            f"{body}_quality": int(FixQuality.FIXED),
        }
    return Fixes(**(values | given))


def heard(drift, times, **given):
    """Return when a drift was first seen, s; None: never."""
    for time in times:
        drift.hear(epoch(time, **given))
        if drift.exists:
            return time
    return None


def times(end, begin=0.0):
    return np.arange(begin, end, PERIOD).tolist()


@pytest.mark.parametrize("radius", [math.inf, 8.0, -8.0, 3.4])
@pytest.mark.parametrize("speed", [0.3, 1.0, 3.0])
@pytest.mark.parametrize("lag", [0.0, 0.15])
def test_ordinary_noise_is_no_drift(radius, speed, lag):
    drift, rng = PositionDrift(), np.random.default_rng(1)
    for time in times(600.0):
        drift.hear(epoch(time, speed=speed, radius=radius, lag=lag, noise=tuple(rng.normal(0.0, 0.03, 4))))
        assert not drift.exists, time


@pytest.mark.parametrize(("speed", "latest"), [(1.0, 1.1), (2.0, 1.1), (3.0, 1.1)])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_both_antennas_that_drift_are_seen_and_one_alone_is_not(speed, latest, side):
    for both in (True, False):
        drift, begin = PositionDrift(), 5.0
        assert heard(drift, times(begin), speed=speed) is None
        found = None
        for time in times(20.0, begin):
            off = 0.3 * side * (time - begin)
            drift.hear(epoch(time, speed=speed, aside=(off, off if both else 0.0)))
            found = time if drift.exists and found is None else found
        assert (found is not None) == both
        assert found is None or 0.6 < found - begin <= latest


def test_a_velocity_whose_direction_lags_by_far_is_a_contradiction():
    assert heard(PositionDrift(), times(10.0), speed=2.0, radius=8.0, lag=0.1) is None
    assert heard(PositionDrift(), times(10.0), speed=2.0, radius=8.0, lag=0.6) is not None


def test_a_jump_is_seen_only_if_it_stays():
    drift = PositionDrift()
    assert heard(drift, times(5.0)) is None
    drift.hear(epoch(5.0, aside=(0.4, 0.4)))
    assert heard(drift, times(12.0, 5.2)) is None
    assert heard(drift, times(14.0, 12.0), aside=(0.4, 0.4)) == pytest.approx(12.2)


def test_one_that_the_estimator_rejects_is_no_drift():
    """Both receivers change places in a curve, which looks as if they went aside."""
    drift = PositionDrift()
    assert heard(drift, times(5.0), radius=8.0) is None
    assert heard(drift, times(10.0, 5.0), radius=8.0, aside=(1.0, 1.0)) is None


def test_a_speed_in_a_wrong_unit_is_no_drift():
    assert heard(PositionDrift(), times(20.0), told=1.94) is None


@pytest.mark.parametrize(
    "given", [{"tractor_quality": int(FixQuality.FLOAT)}, {"trailer_course": math.nan}, {"tractor_x": math.nan}]
)
def test_without_fixed_positions_and_velocities_nothing_is_said(given):
    drift = PositionDrift()
    for time in times(20.0):
        drift.hear(replace(epoch(time, aside=(0.3 * time, 0.3 * time)), **given))
        assert not drift.exists


def test_after_a_gap_it_begins_anew():
    drift = PositionDrift()
    assert heard(drift, times(5.0)) is None
    assert heard(drift, times(12.0, 6.0), aside=(1.0, 1.0)) is None
    assert heard(PositionDrift(), times(20.0), speed=0.1) is None


def test_from_where_they_were_before_the_velocities_lead_on():
    drift, begin = PositionDrift(), 5.0
    assert heard(drift, times(begin), radius=20.0) is None
    for time in times(8.0, begin):
        off = 0.3 * (time - begin)
        drift.hear(epoch(time, radius=20.0, aside=(off, off)))
        if drift.exists and time < 6.1:
            drift.begin_dead_reckoning()
    measured = Measurement(time=0.0, **dict.fromkeys(UNUSED, 0.0))
    true = epoch(times(8.0)[-1], radius=20.0)
    carried = drift.dead_reckoned(measured)
    found = (carried.tractor_x, carried.tractor_y, carried.trailer_x, carried.trailer_y)
    assert found == pytest.approx((true.tractor_x, true.tractor_y, true.trailer_x, true.trailer_y), abs=0.01)
    drift.hear(epoch(9.0))
    assert math.isnan(drift.dead_reckoned(measured).tractor_x), "an epoch was lost"

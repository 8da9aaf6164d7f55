"""Antennas apart: both are held against where the estimate has them."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from drawbar.driving.fault_detection.antennas_apart import AntennasApart
from drawbar.geometry import arm_offset
from drawbar.signals import Pose, SolverStatus
from drawbar.vehicle.parameters import Mast, Masts

SAMPLE = 0.2
YAW = 0.7
NOISE = 0.03
MAST = Mast(forward=0.4, left=0.1, up=2.5, roll_offset=0.03)


def step(tractor=0.0, trailer=0.0, *, masts=None, roll=math.nan, speed=2.0, status=SolverStatus.SOLVED):
    """Return a step whose antennas are so far to the left of where they are estimated, m; on leaning masts."""
    masts, places = masts or Masts(), {}
    for body, left in (("tractor", tractor), ("trailer", trailer)):
        mast = getattr(masts, body)
        lean = 0.0 if math.isnan(roll) else roll - mast.roll_offset
        east, north = arm_offset(YAW, lean, 0.0, mast.arm)
        places |= {f"{body}_x": 5.0 + east - left * math.sin(YAW), f"{body}_y": 3.0 + north + left * math.cos(YAW)}
        places |= {f"{body}_roll": roll, f"{body}_pitch": math.nan}
    pose = Pose(x=5.0, y=3.0, yaw=YAW)
    estimate = SimpleNamespace(tractor=pose, trailer=pose, status=status)
    return SimpleNamespace(measurement=SimpleNamespace(speed=speed, **places), estimate=estimate)


def after(apart, seconds, *given, **named):
    return [apart.update(step(*given, **named)) for _ in range(round(seconds / SAMPLE))][-1]


@pytest.mark.parametrize(("tractor", "trailer", "share"), [(0.04, -0.05, 1.5), (-0.09, 0.0, -1.5), (0.09, 0.09, 0.0)])
def test_what_one_antenna_is_more_to_the_left_than_the_other(tractor, trailer, share):
    apart = AntennasApart(Masts(), SAMPLE)
    assert after(apart, 1.4, tractor, trailer) == 0.0, "it is averaged"
    assert apart.update(step(tractor, trailer)) == pytest.approx(share)


def test_noise_of_positions_is_no_contradiction():
    apart, rng = AntennasApart(Masts(), SAMPLE), np.random.default_rng(3)
    shares = [abs(apart.update(step(*rng.normal(0.0, NOISE, 2)))) for _ in range(5000)]
    assert 0.4 < max(shares) < 1.0


def test_the_most_of_two_seconds_counts():
    apart = AntennasApart(Masts(), SAMPLE)
    most = after(apart, 1.6, 0.09)
    assert after(apart, 1.8) == most
    assert abs(after(apart, 2.0)) < 0.5


def test_where_the_ground_has_them_apart_more_is_usual():
    apart, rough = AntennasApart(Masts(), SAMPLE), AntennasApart(Masts(), SAMPLE)
    for i in range(600):
        rough.update(step(0.12 * math.sin(0.3 * i)))
    assert after(apart, 4.0, 0.09) > 1.0
    assert after(rough, 4.0, 0.09) < 1.0
    standing = AntennasApart(Masts(), SAMPLE)
    for i in range(600):
        standing.update(step(0.12 * math.sin(0.3 * i), speed=0.0))
    assert after(standing, 4.0, 0.09) > 1.0, "nothing is learned at standstill"


def test_a_fault_is_not_usual_before_it_is_seen():
    apart = AntennasApart(Masts(), SAMPLE)
    after(apart, 8.0, 0.02)
    assert max(apart.update(step(0.02 + 0.02 * SAMPLE * i)) for i in range(40)) > 1.2, "2 cm/s, within 8 s"


def test_masts_that_lean_are_allowed_for():
    masts = Masts(tractor=MAST)
    assert after(AntennasApart(masts, SAMPLE), 1.6, masts=masts, roll=0.1) == pytest.approx(0.0, abs=1e-9)
    assert after(AntennasApart(masts, SAMPLE), 1.6, masts=masts) == pytest.approx(0.0, abs=1e-9), "no sensor tells"


@pytest.mark.parametrize("how", ["no position", "no estimate"])
def test_it_begins_anew_where_something_is_missing(how):
    apart = AntennasApart(Masts(), SAMPLE)
    assert after(apart, 1.6, 0.09) > 1.0
    broken = step(math.nan) if how == "no position" else step(status=SolverStatus.MAXIMUM_ITERATIONS)
    assert apart.update(broken) == 0.0
    assert after(apart, 1.4, 0.09) == 0.0

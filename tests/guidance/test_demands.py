"""A path that the front wheels cannot follow is refused before it is driven."""

import math
from functools import partial

import numpy as np
import pytest

from drawbar.errors import PathError
from drawbar.guidance.demands import demand_steering, largest_off_tracking, steering_shift
from drawbar.guidance.figure_eight import figure_eights
from drawbar.guidance.path import Path
from drawbar.vehicle.off_tracking import steady_off_tracking
from drawbar.vehicle.parameters import VehicleParameters

EIGHTS = figure_eights([10.0, 5.0], 20.0)
ANGLE = math.atan(VehicleParameters().wheelbase / 5.0)
REACH = math.sqrt(24.0 * 0.5 * 5.0)
"""m: over so much of an arc of 5 m radius a clothoid shifts it by 0.5 m"""


def demanded(speed: float = 1.0, path: Path = EIGHTS, **of_vehicle: float) -> None:
    demand_steering(path, VehicleParameters(**of_vehicle), speed=speed, tolerance=0.5)


def test_limit_must_reach_the_tightest_curves_angle() -> None:
    demanded(tractor_steering_limit=1.01 * ANGLE)
    with pytest.raises(PathError, match=r"0\.2 1/m, needs 0\.27\d rad .*tractor_steering_limit = 0\.27 rad"):
        demanded(tractor_steering_limit=0.99 * ANGLE)


def test_rate_must_turn_from_one_curve_to_the_next_and_more_so_when_fast() -> None:
    rate = ANGLE / REACH
    demanded(tractor_steering_rate=1.02 * rate)
    with pytest.raises(PathError, match=r"tractor_steering_rate = .* too slow"):
        demanded(tractor_steering_rate=0.98 * rate)
    with pytest.raises(PathError, match=r"at 2 m/s"):
        demanded(speed=2.0, tractor_steering_rate=1.02 * rate)


def test_a_shift_is_what_is_just_accepted() -> None:
    """Front wheels that need a reach of s shift the arc of 5 m radius by s^2 / (24 * 5 m)."""
    reach = 4.0
    vehicle = VehicleParameters(tractor_steering_rate=ANGLE / reach)
    shift = partial(steering_shift, EIGHTS, vehicle, tolerance=0.5)
    assert shift(speed=1.0) == pytest.approx(reach**2 / 120.0, abs=0.005)
    assert shift(speed=0.5) == pytest.approx(reach**2 / 480.0, abs=0.005)
    demand_steering(EIGHTS, vehicle, speed=1.0, tolerance=shift(speed=1.0))
    with pytest.raises(PathError):
        demand_steering(EIGHTS, vehicle, speed=1.0, tolerance=0.9 * shift(speed=1.0))
    assert steering_shift(straight_line(), vehicle, speed=9.0, tolerance=0.5) == 0.0


def straight_line() -> Path:
    places = np.arange(0.0, 5.0, 0.25)
    zero = np.zeros(len(places))
    return Path.through(
        arc_length=places, x=places, y=zero, yaw=zero, label_of_piece=np.zeros(19, np.int8), label_names=("straight",)
    )


def test_straight_line_asks_nothing() -> None:
    line = straight_line()
    steering = {"tractor_steering_limit": 1e-3, "tractor_steering_rate": 1e-3}
    demanded(path=line, **steering)
    with pytest.raises(PathError, match="tractor_steering_limit"):
        demanded(**steering)


def test_gentle_spiral_needs_less_than_a_sudden_curve() -> None:
    """Curvature rises from 0 to 0.2 1/m over 60 m: the wheels have all the time of it."""
    places = np.linspace(0.0, 60.0, 601)
    yaw = 0.5 * (0.2 / 60.0) * places**2
    x, y = (
        np.concatenate([[0.0], np.cumsum(np.diff(places) * f(0.5 * (yaw[1:] + yaw[:-1])))]) for f in (np.cos, np.sin)
    )
    spiral = Path.through(
        arc_length=places, x=x, y=y, yaw=yaw, label_of_piece=np.zeros(600, np.int8), label_names=("spiral",)
    )
    rate = 0.3 * ANGLE / REACH
    demanded(path=spiral, tractor_steering_rate=rate)
    with pytest.raises(PathError, match="too slow"):
        demanded(tractor_steering_rate=rate)


def test_the_worst_curve_for_the_trailer_is_the_tightest_that_lasts() -> None:
    vehicle = VehicleParameters(trailer_steering_limit=0.1)
    off_tracking, curvature = largest_off_tracking(EIGHTS, vehicle)
    assert curvature == pytest.approx(0.2, rel=1e-4)
    assert off_tracking == pytest.approx(float(steady_off_tracking(vehicle, np.array([0.2]))[0]), rel=1e-3)
    assert off_tracking > 0.1
    long = VehicleParameters(trailer_steering_limit=0.1, trailer_length=25.0)
    assert largest_off_tracking(EIGHTS, long)[1] < 0.2, "longer than the curves"
    assert largest_off_tracking(straight_line(), vehicle) == (0.0, 0.0)

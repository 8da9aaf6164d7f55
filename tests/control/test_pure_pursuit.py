import cmath
import math

import numpy as np
import pytest
from controllers import PurePursuit

from drawbar.control.settings import PurePursuitSettings
from drawbar.vehicle.parameters import VehicleParameters

VEHICLE, SAMPLE_TIME = VehicleParameters(), 0.2


def steering(here, look_ahead=1.6):
    settings = PurePursuitSettings(model="pure_pursuit", look_ahead=look_ahead)
    law = PurePursuit(VEHICLE, settings, SAMPLE_TIME)
    return law.feedback(here.estimate, here.reference).tractor.steering


@pytest.mark.parametrize("look_ahead", [0.7, 1.6, 3.0])
@pytest.mark.parametrize("curvature", [-0.15, 0.0, 0.1])
def test_on_a_circle_the_pursued_arc_is_the_circle(situation, curvature, look_ahead):
    here = situation(curvature=curvature, ahead=3.0)
    delta = steering(here, look_ahead)
    assert math.tan(delta) == pytest.approx(VEHICLE.wheelbase * curvature, rel=1e-3, abs=1e-12)


def test_the_arc_leads_from_the_axle_along_its_heading_to_the_point_on_the_path(situation):
    for left, yaw, look_ahead in ((0.1, 0.1, 1.0), (-0.5, 0.2, 2.0), (0.1, -0.1, 1.6)):
        here = situation(curvature=0.05, left=left, yaw=yaw)
        pose = here.estimate.tractor
        curvature = math.tan(steering(here, look_ahead)) / VEHICLE.wheelbase
        centre = complex(pose.x, pose.y) + cmath.rect(1.0 / curvature, pose.yaw + math.pi / 2.0)
        x, y = (
            np.interp(look_ahead, SAMPLE_TIME * np.arange(21), here.reference.tractor.samples[:, i]) for i in (0, 1)
        )
        assert abs(complex(x, y) - centre) == pytest.approx(abs(1.0 / curvature), rel=1e-3)


def test_where_the_samples_end_the_path_goes_on(situation):
    # standing, all samples are one point
    for curvature in (-0.1, 0.0, 0.15):
        standing, rolling = (situation(curvature=curvature, ahead=2.0, left=0.02, speed=v) for v in (0.0, 1.0))
        assert steering(standing) == pytest.approx(steering(rolling), abs=1e-3)


def test_it_goes_on_as_the_last_sample_says(situation):
    here = situation(speed=0.0)
    here.reference.tractor.samples[-1] = 0.5, 0.1, 0.2, 0.1
    beyond = 1.6 - math.hypot(0.5, 0.1)
    goal = complex(0.5, 0.1) + cmath.rect(beyond, 0.2 + 0.05 * beyond)
    slope = 2.0 * VEHICLE.wheelbase * math.sin(cmath.phase(goal)) / abs(goal)
    assert math.tan(steering(here)) == pytest.approx(slope, abs=1e-12)


@pytest.mark.parametrize("left", [-1.0, 0.5])
def test_it_converges_to_a_line(situation, left):
    law = PurePursuit(VEHICLE, PurePursuitSettings(model="pure_pursuit"), SAMPLE_TIME)
    x, y, yaw = 0.0, left, 0.0
    for _ in range(100):
        here = situation(ahead=x, left=y, yaw=yaw)
        plan = law.feedback(here.estimate, here.reference)
        x, y, yaw = plan.tractor.poses[1].tolist()
    assert (y, yaw) == pytest.approx((0.0, 0.0), abs=1e-3)

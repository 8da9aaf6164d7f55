import math
from dataclasses import replace

import numpy as np
import pytest
from controllers import AncillaryLaw

from drawbar.control.settings import ArticulatedControllerSettings, BodyTubeSettings, TubeSettings
from drawbar.control.tube.tube import tubes_of
from drawbar.signals import BodyPlan, SolverStatus
from drawbar.vehicle.parameters import VehicleParameters

GAIN = np.array([-0.4, -1.5, -0.2])
LIMIT = 0.5


@pytest.fixture(scope="module")
def tube():
    """Return a tractor's tube with the gain, and bounds from which it has a set."""
    tractor = BodyTubeSettings(lateral=GAIN[0], yaw=GAIN[1], steering=GAIN[2], disturbances={"tractor_crab": 0.01})
    settings = ArticulatedControllerSettings(model="articulated")
    return tubes_of(VehicleParameters(), settings, TubeSettings(tractor=tractor), speed=1.0, sample_time=0.2).tractor


@pytest.fixture(scope="module")
def law(tube):
    return AncillaryLaw(tube, LIMIT)


def plan(steering, deviation=()):
    return BodyPlan(
        steering=steering,
        poses=np.zeros((3, 3)),
        steerings=np.zeros(2),
        deviation=np.array(deviation, float),
        status=SolverStatus.SOLVED,
    )


def test_the_law_is_the_formula(law):
    rng = np.random.default_rng(31)
    for deviation in 0.05 * rng.normal(size=(100, 3)):
        steering = law.apply(plan(0.05, deviation))
        assert steering.nominal == 0.05
        assert steering.ancillary == pytest.approx(GAIN @ deviation, abs=1e-15)
        assert steering.command == 0.05 + steering.ancillary
        assert not steering.saturated


def test_a_plan_that_holds_the_vehicle_to_nothing_gets_no_correction(law):
    for apart in (law.apply(plan(0.2)), AncillaryLaw(None, LIMIT).apply(plan(0.2, (0.1, 0.1, 0.1)))):
        assert (apart.nominal, apart.ancillary, apart.command) == (0.2, 0.0, 0.2)
        assert math.isnan(apart.margin)


def test_the_sum_is_clipped_and_the_clip_is_reported(law):
    for sign in (1.0, -1.0):
        steering = law.apply(plan(0.45 * sign, (0.0, -0.1 * sign, 0.0)))
        assert steering.ancillary == pytest.approx(0.15 * sign)
        assert steering.command == LIMIT * sign
        assert steering.saturated
    assert not law.apply(plan(LIMIT, (0.0, 0.0, 0.0))).saturated


def test_what_is_not_finite_is_neither_clipped_nor_counted_as_clipped(law):
    steering = law.apply(plan(0.1, (math.nan, 0.0, 0.0)))
    assert math.isnan(steering.command)
    assert not steering.saturated
    endless = law.apply(plan(math.inf, (0.0, 0.0, 0.0)))
    assert endless.command == math.inf
    assert not endless.saturated


def test_the_margin_is_one_at_the_centre_and_falls_to_zero_on_the_boundary(law, tube):
    assert law.apply(plan(0.0, np.zeros(3))).margin == 1.0
    for axis, extent in zip(np.eye(3), tube.seen(np.eye(3)), strict=True):
        for share in (0.3, 0.8, 1.5):
            margin = law.apply(plan(0.0, share * extent * axis)).margin
            assert margin <= 1.0 - share + 1e-12  # along a coordinate, or sooner along another facet
            assert law.apply(plan(0.0, -share * extent * axis)).margin == pytest.approx(margin)
    without = replace(tube, facets=np.zeros((0, 3)), heights=np.zeros(0))
    assert math.isnan(AncillaryLaw(without, LIMIT).apply(plan(0.0, np.zeros(3))).margin)


def test_a_deviation_that_is_not_finite_has_no_margin(law):
    for place in np.eye(3):
        deviation = np.where(place == 1.0, math.nan, 0.01)
        assert math.isnan(law.apply(plan(0.0, deviation)).margin)

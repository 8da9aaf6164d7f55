import numpy as np
import pytest
from controllers import ArticulatedTractor

from drawbar.control.settings import ArticulatedControllerSettings
from drawbar.signals import BodyReference, SolverStatus
from drawbar.vehicle.parameters import VehicleParameters

STAGES = 40


@pytest.fixture(scope="module")
def settings():
    return ArticulatedControllerSettings(model="articulated", horizon=STAGES)


@pytest.fixture(scope="module")
def tube(settings, untightened):
    return untightened(settings).tractor


def circle(spacing):
    """Return a reference along a circle of 6.67 m, its stages so far apart (m)."""
    angle = spacing * np.arange(STAGES + 1) / 6.67
    samples = np.column_stack((6.67 * np.sin(angle), 6.67 * (1.0 - np.cos(angle)), angle, np.full(STAGES + 1, 0.15)))
    return BodyReference(progress=0.0, lateral_error=0.0, closest=samples[0], samples=samples)


def test_a_first_plan_along_a_bend_is_found_at_once(settings, tube, situation):
    controller = ArticulatedTractor(VehicleParameters(), settings, 0.2, tube)
    estimate = situation().estimate
    plan = controller.feedback(estimate, circle(0.2 * estimate.longitudinal_slip * estimate.speed))
    assert plan.status is SolverStatus.SOLVED
    controller.prepare()
    assert np.abs(controller.solver.defects).max() < 0.05


def test_a_torn_plan_is_called_so_and_given_up(settings, tube, situation):
    controller = ArticulatedTractor(VehicleParameters(), settings, 0.2, tube)
    estimate = situation().estimate
    reference = circle(0.2 * estimate.longitudinal_slip * estimate.speed)
    controller.feedback(estimate, reference)
    controller.solver.x[20:, 0] += 3.0
    controller.prepare()
    assert controller.feedback(estimate, reference).status is SolverStatus.CHECK_FAILED
    controller.prepare()
    assert np.abs(controller.solver.defects).max() < 0.05
    assert controller.feedback(estimate, reference).status is SolverStatus.SOLVED

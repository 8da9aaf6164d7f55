"""What is added to the ground's effects and told to nobody."""

import numpy as np
import pytest

from drawbar.machine.events import SideSlope
from drawbar.machine.settings import SimulatedMachineSettings
from drawbar.machine.simulated import SimulatedMachine
from drawbar.signals import Command, Pose
from drawbar.vehicle.parameters import VehicleParameters


def driven(settings, unknown=None, samples=30):
    machine = SimulatedMachine(
        vehicle=VehicleParameters(),
        settings=settings,
        sample_time=0.2,
        start=Pose(x=0.0, y=0.0, yaw=0.3),
        seed=0,
        unknown=unknown,
    )
    machine.read()
    truths = [machine.truth()]
    for k in range(samples):
        machine.write(Command(time=0.2 * k, tractor_steering=0.1, trailer_steering=-0.05, speed=1.0))
        machine.read()
        truths.append(machine.truth())
    return truths


def test_an_unknown_crab_on_all_axles_moves_the_machine_as_a_slope_does(ideal):
    crab = 0.03
    event = SideSlope(start=0.0, crab=crab, ramp=1e-6)
    slope = driven(ideal.model_copy(update={"events": (event,)}))
    unknown = driven(ideal, lambda: np.array([0.0, 0.0, crab, crab, crab]))
    for one, other in zip(slope, unknown, strict=True):
        assert (other.tractor.x, other.tractor.y) == pytest.approx((one.tractor.x, one.tractor.y), abs=2e-4)
        assert other.trailer.yaw == pytest.approx(one.trailer.yaw, abs=2e-4)
    assert slope[-1].tractor_crab == crab
    assert unknown[-1].tractor_crab == 0.0  # not even the truth tells


def test_each_sample_has_its_own_error_from_its_begin_to_its_end(ideal):
    errors = iter(np.linspace(0.0, 0.1, 30))
    given = []

    def unknown():
        given.append(next(errors))
        return np.array([given[-1], 0.0, 0.0, 0.0, 0.0]) - np.array([0.2, 0.0, 0.0, 0.0, 0.0])

    slowed, free = driven(ideal, unknown), driven(ideal)
    assert len(given) == 30
    last, undisturbed = (
        np.hypot(run[-1].tractor.x - run[-2].tractor.x, run[-1].tractor.y - run[-2].tractor.y) for run in (slowed, free)
    )
    assert last / undisturbed == pytest.approx(
        (free[-1].longitudinal_slip - 0.1) / free[-1].longitudinal_slip, rel=1e-3
    )


def test_nothing_unknown_is_the_identical_run():
    settings = SimulatedMachineSettings()
    assert driven(settings) == driven(settings, lambda: np.zeros(5))

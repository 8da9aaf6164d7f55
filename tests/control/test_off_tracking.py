"""What the trailer's steering leaves of its off-tracking, against exact circles and the simulated machine."""

import math
from dataclasses import replace

import numpy as np
import pytest
from c_signals import given

from drawbar.codegen import Workspace, build
from drawbar.config import load_configuration
from drawbar.control.off_tracking import sharing_settings
from drawbar.control.settings import SharingSettings
from drawbar.machine.sensor_settings import SensorSettings
from drawbar.machine.settings import CrabProcess, GroundSettings, SimulatedMachineSettings, SlipProcess
from drawbar.machine.simulated import SimulatedMachine
from drawbar.signals import Command, Pose
from drawbar.simulation import simulate
from drawbar.vehicle.off_tracking import steady_off_tracking
from drawbar.vehicle.parameters import VehicleParameters

VEHICLE = VehicleParameters()
SAMPLE_TIME = 0.2
TRAILER = VEHICLE.trailer_length + VEHICLE.drawbar_length
STAGES = 400
UNIT = f"""
#include "off_tracking.h"
#include "fields.h"
struct component {{
    struct shared_error shared;
    double samples[{STAGES}][4], result[{STAGES}], slopes[{STAGES}];
    int32_t stages;
}};
int64_t drawbar_size = sizeof(struct component);
const struct drawbar_field drawbar_fields[] = {{
    SHARED_ERROR_FIELDS(shared) FIELD(component, samples, 0, {STAGES}, 4, 0) FIELD(component, result, 0, {STAGES}, 0, 0)
    FIELD(component, stages, 1, 1, 0, 0) END_OF_FIELDS
}};
int targets(struct component *p, const struct drawbar_estimate *estimate)
{{
    shared_targets(&p->shared, estimate, (const double (*)[4])p->samples, p->stages, p->result, p->slopes);
    return 0;
}}
int remainder_of(struct component *p, const struct drawbar_estimate *e)
{{
    for (int k = 0; k < p->stages; ++k)
        p->result[k] = off_tracking_remainder(&p->shared.off_tracking, p->samples[k][3], e->tractor_crab,
                                              e->trailer_crab);
    return 0;
}}
"""


class SharedError:
    """The arithmetic of off_tracking.h."""

    def __init__(self, **settings):
        self.workspace = Workspace(build("off_tracking", UNIT))
        sharing = SharingSettings(**({"widening": 0.0} | settings))
        for name, value in sharing_settings(VEHICLE, sharing, SAMPLE_TIME).items():
            self.workspace.array(name)[:] = value

    def targets(self, estimate, curvature):
        """Return the tractor's lateral targets (n,) on curvatures (n,)."""
        return self._call("targets", estimate, curvature)

    def remainder(self, estimate, curvature):
        """Return what the trailer's steering leaves of the error (n,) on curvatures (n,)."""
        return self._call("remainder_of", estimate, curvature)

    def _call(self, function, estimate, curvature):
        array = self.workspace.array
        array("samples")[: len(curvature), 3], array("stages")[:] = curvature, len(curvature)
        self.workspace.function(function, pointers=1)(given(estimate))
        return array("result")[: len(curvature)].copy()


@pytest.fixture(scope="module")
def remainder(situation):
    """Return a function of curvatures (n,) and both crab angles."""
    estimate, shared = situation().estimate, SharedError()

    def remainder(curvature, tractor_crab, trailer_crab):
        crabs = {"tractor_crab": tractor_crab, "trailer_crab": trailer_crab}
        return shared.remainder(replace(estimate, **crabs), curvature)

    return remainder


def exact_error(curvature, tractor_crab, trailer_crab, joint, vehicle=VEHICLE):
    """Return the lateral error of the trailer's antenna when everything turns about one centre, m.

    All distances are measured from that centre, which lies across each axle's direction of motion.
    """
    a, c, d, length = vehicle.free_joint_offset, vehicle.trailer_antenna, vehicle.drawbar_length, vehicle.trailer_length
    radius = 1.0 / curvature
    centre = radius * complex(-math.sin(tractor_crab), math.cos(tractor_crab))  # seen from the rear axle
    to_joint = abs(centre + a)
    free_joint = complex(length + d * math.cos(joint), d * math.sin(joint))  # seen from the trailer's axle
    across = complex(-math.sin(trailer_crab), math.cos(trailer_crab))
    # |across * axle_radius - free_joint| = to_joint, the root on the tractor's side
    projection = (across.conjugate() * free_joint).real
    root = math.sqrt(projection**2 - abs(free_joint) ** 2 + to_joint**2)
    axle_radius = projection + math.copysign(root, radius)
    return radius - math.copysign(abs(across * axle_radius - c), radius)


@pytest.mark.parametrize("curvature", [1e-4, 0.1, 0.125, -0.15])
@pytest.mark.parametrize("crabs", [(0.0, 0.0), (0.0524, 0.0524), (-0.0524, -0.0524), (0.03, -0.05)])
def test_the_remainder_is_what_the_turned_joint_leaves_on_a_circle(curvature, crabs, remainder):
    limit = VEHICLE.trailer_steering_limit
    ends = sorted(exact_error(curvature, *crabs, joint) for joint in (-limit, limit))
    left = max(ends[0], 0.0) + min(ends[1], 0.0)
    assert remainder(np.array([curvature]), *crabs) == pytest.approx([left], abs=0.015 * abs(curvature))


LONG = VehicleParameters(
    wheelbase=2.8,
    hitch_length=1.6,
    drawbar_length=1.0,
    trailer_length=5.0,
    trailer_antenna=1.5,
    trailer_steering_limit=0.45,
    curvature_limit=0.1,
)
"""A trailer that cuts in by more than its steering takes back: a metre is left on a radius of 12 m."""


@pytest.mark.parametrize("vehicle", [VEHICLE, LONG])
@pytest.mark.parametrize("curvature", [0.001, 0.05, 0.0833, -0.125])
def test_steady_off_tracking_is_the_least_of_all_joint_angles(vehicle, curvature):
    limit = vehicle.trailer_steering_limit
    errors = [exact_error(curvature, 0.0, 0.0, joint, vehicle) for joint in np.linspace(-limit, limit, 2001)]
    least = 0.0 if min(errors) < 0.0 < max(errors) else min(abs(error) for error in errors)
    assert steady_off_tracking(vehicle, np.array([curvature])) == pytest.approx([least], abs=1e-9)


def steady_error(curvature, tractor_crab, trailer_crab):
    """Return how far inside its tractor's circle the simulated trailer runs, joint at its limit outwards, m."""
    firm = SlipProcess(mean=1.0, deviation=0.0)
    ground = GroundSettings(
        longitudinal_slip=firm,
        tractor_slip=firm,
        tractor_crab=CrabProcess(mean=tractor_crab, deviation=0.0),
        trailer_crab=CrabProcess(mean=trailer_crab, deviation=0.0),
    )
    settings = SimulatedMachineSettings(ground=ground, sensors=SensorSettings(position=0.0))
    start = Pose(x=0.0, y=0.0, yaw=0.0)
    machine = SimulatedMachine(vehicle=VEHICLE, settings=settings, sample_time=SAMPLE_TIME, start=start, seed=0)
    steering = math.atan(VEHICLE.wheelbase * curvature / math.cos(tractor_crab) + math.tan(tractor_crab))
    for _ in range(200):
        machine.write(Command(time=0.0, tractor_steering=steering, trailer_steering=math.radians(20.0), speed=1.0))
        machine.read()
    truth = machine.truth()
    course = truth.tractor.yaw + tractor_crab
    centre = complex(truth.tractor.x, truth.tractor.y) + 1j * complex(math.cos(course), math.sin(course)) / curvature
    return 1.0 / curvature - abs(complex(truth.trailer.x, truth.trailer.y) - centre)


@pytest.mark.parametrize("crab", [0.0, 0.0524])
def test_the_simulated_trailer_keeps_the_remainder(crab, remainder):
    left = remainder(np.array([0.125]), crab, crab)
    assert left == pytest.approx([steady_error(0.125, crab, crab)], abs=1.5e-3)
    assert left[0] > 0.01


def test_what_the_trailer_can_steer_away_is_no_remainder(remainder):
    gentle = np.linspace(-0.09, 0.09, 7)
    assert remainder(gentle, 0.0, 0.0) == pytest.approx(np.zeros(7), abs=0.0)
    # hung to one side by a slope, the trailer's cut-in to the other side cancels
    assert remainder(np.array([-0.125]), 0.0524, 0.0524) == 0.0


def test_the_remainder_is_mirrored_with_the_world(remainder):
    curvatures = np.linspace(-0.3, 0.3, 13)
    here = remainder(curvatures, 0.03, -0.02)
    assert remainder(-curvatures, -0.03, 0.02) == pytest.approx(-here, abs=1e-15)


def test_on_an_endless_curve_the_tractor_takes_its_share_beyond_the_accepted_error(situation, remainder):
    for curvature in (0.2, -0.25):
        estimate = situation(curvature=curvature).estimate
        curvatures = np.full(400, curvature)
        left = remainder(curvatures[:1], 0.0, 0.0)[0]
        target = SharedError(share=0.6, accepted_error=0.02).targets(estimate, curvatures)[-1]
        assert target * left < 0.0, "the tractor goes to the other side"
        assert abs(target) == pytest.approx(0.6 * (abs(left) - 0.02), rel=1e-9)


def test_the_tractor_takes_no_more_than_half(situation, remainder):
    curvatures = np.full(400, 0.3)
    left = remainder(curvatures[:1], 0.0, 0.0)[0]
    target = SharedError(share=0.9, accepted_error=0.0).targets(situation().estimate, curvatures)[-1]
    assert target == pytest.approx(-0.5 * left, rel=1e-9)


@pytest.mark.parametrize("speed", [0.8, 2.5])
def test_both_bodies_share_what_a_long_trailer_cannot_steer_away(speed):
    radius = 12.0
    shape = [f"path.radii=[{radius}]", "path.straight_length=40.0"]
    changes = [f"speed={speed}", *shape, "estimator.model=ideal", "machine.sensors.position=0.0"]
    log = simulate(load_configuration("articulated", changes).model_copy(update={"vehicle": LONG}))
    beside = {body: np.abs(log.column(f"reference.{body}.lateral_error")) for body in ("tractor", "trailer")}
    curvature = np.abs(log.column("reference.trailer.closest.3"))
    tractor, trailer = (float(np.median(each[curvature > 0.99 / radius])) for each in beside.values())
    left = float(steady_off_tracking(LONG, np.array([1.0 / (radius + tractor)]))[0])
    assert left > 0.9
    assert tractor + trailer == pytest.approx(left, abs=0.05)
    assert tractor == pytest.approx(trailer, abs=0.1)
    assert beside["trailer"][curvature < 1e-3].mean() < 0.03, "it knows where the tractor is on its way back"


def test_an_accepted_error_stays_with_the_trailer(situation, remainder):
    curvatures = np.full(400, 0.25)
    left = remainder(curvatures[:1], 0.0, 0.0)[0]
    targets = SharedError(accepted_error=1.01 * float(left)).targets(situation().estimate, curvatures)
    assert targets == pytest.approx(np.zeros(400), abs=0.0)


def test_the_tractor_keeps_outside_of_every_curve(situation):
    for curvature in (0.05, -0.1):
        targets = SharedError(share=0.0, widening=0.05).targets(situation().estimate, np.full(400, curvature))
        assert targets[-1] == pytest.approx(-0.05 * curvature, rel=1e-9)


def test_without_sharing_the_tractor_keeps_to_the_path(situation):
    targets = SharedError(share=0.0).targets(
        situation(tractor_crab=0.05, trailer_crab=0.05).estimate, np.full(21, 0.15)
    )
    assert targets == pytest.approx(np.zeros(21), abs=0.0)


def test_the_target_lags_by_the_trailers_length_at_any_speed(situation):
    for speed in (0.5, 2.0):
        curvatures = np.full(400, 0.25)
        targets = SharedError().targets(situation(speed=speed).estimate, curvatures)
        travelled = speed * SAMPLE_TIME * np.arange(400)
        assert targets == pytest.approx(targets[-1] * -np.expm1(-travelled / TRAILER), abs=1e-12)


def test_what_is_planned_for_the_next_sample_is_its_target(situation):
    estimate, curvatures = situation().estimate, np.full(22, 0.25)
    part = SharedError()
    first = part.targets(estimate, curvatures[:21])
    second = part.targets(estimate, curvatures[1:])
    assert first[0] == 0.0
    assert second[:20] == pytest.approx(first[1:], abs=1e-15)


def test_standing_still_the_target_stays(situation):
    part = SharedError()
    part.targets(situation().estimate, np.full(21, 0.25))
    targets = part.targets(situation(speed=0.0).estimate, np.full(21, -0.25))
    assert np.ptp(targets) == 0.0
    assert targets[0] < 0.0


@pytest.mark.parametrize("name", ["speed", "longitudinal_slip", "tractor_crab", "trailer_crab"])
def test_an_estimate_that_is_not_finite_is_forgotten(situation, name):
    estimate, curvatures = situation().estimate, np.full(21, 0.25)
    part, other = SharedError(), SharedError()
    for each in (part, other):
        each.targets(estimate, curvatures)
    assert np.isnan(part.targets(replace(estimate, **{name: math.nan}), curvatures)[1:]).all()
    assert part.targets(estimate, curvatures).tolist() == other.targets(estimate, curvatures).tolist()

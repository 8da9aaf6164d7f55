"""The adversary against brute force: no other sequence of errors gets the linear error further."""

import numpy as np
import pytest

from drawbar.bounded import EstimateErrors, GroundErrors
from drawbar.control.settings import ArticulatedControllerSettings, BodyTubeSettings, Nominal, TubeSettings
from drawbar.control.tube.adversary import worst_signs
from drawbar.control.tube.tube import tubes_of
from drawbar.vehicle.parameters import VehicleParameters

PUSH = 40
TRACTOR_ERRORS = ("tractor_lateral", "tractor_yaw", "tractor_steering")
GROUND, ESTIMATE = list(GroundErrors.model_fields), list(EstimateErrors.model_fields)


def tubes(nominal):
    settings = TubeSettings(
        nominal=nominal,
        tractor=BodyTubeSettings(lqr={"lateral": 1.0, "yaw": 1.0, "command": 5.0}),
        trailer=BodyTubeSettings(articulation=-0.3),
    )
    product = ArticulatedControllerSettings(model="articulated")
    return tubes_of(VehicleParameters(), product, settings, speed=1.0, sample_time=0.2)


def simulated(tube, ground, estimates):
    """Return x̂ - x̄ (m + 1, n) of the linear error model; errors of the ground (m, d), of the estimate (m + 1, n)."""
    A, B, G, gain = tube.model.A[0], tube.model.B[0], tube.model.G[0], tube.gain
    names = tube.model.disturbances
    seen = [estimates[0]]
    for w, eps, later in zip(ground, estimates[:-1], estimates[1:], strict=True):
        kept = -eps if tube.nominal is Nominal.PREDICTED else seen[-1] - eps  # x - x̄ that the sample begins with
        pushed = G[:, [names.index(name) for name in names if name in GROUND]] @ w
        seen.append(A @ kept + B * (gain @ seen[-1]) + pushed + later)
    return np.array(seen)


@pytest.mark.parametrize("nominal", list(Nominal))
def test_no_other_errors_push_the_tractor_further(nominal):
    tube, (ground, estimate) = tubes(nominal).tractor, worst_signs(tubes(nominal))
    acting = [GROUND.index(name) for name in tube.model.disturbances if name in GROUND]
    own = [ESTIMATE.index(name) for name in TRACTOR_ERRORS]
    rng, directions = np.random.default_rng(7), np.vstack([np.eye(3), tube.gain])
    for turn, direction in enumerate(np.concatenate([directions, -directions])):
        rows = slice(turn * PUSH, (turn + 1) * PUSH)
        plan_ground, plan_estimate = ground[rows][:, acting], np.vstack([estimate[rows][:, own], np.zeros(3)])
        reached = simulated(tube, plan_ground, plan_estimate)[-1] @ direction
        for _ in range(50):
            other_ground, other_estimate = plan_ground.copy(), plan_estimate.copy()
            changed = rng.random(PUSH) < 0.1
            other_ground[changed] = rng.uniform(-1.0, 1.0, other_ground[changed].shape)
            other_estimate[:-1][changed] = rng.uniform(-1.0, 1.0, other_estimate[:-1][changed].shape)
            assert simulated(tube, other_ground, other_estimate)[-1] @ direction <= reached + 1e-12
        assert reached > 0.0


def test_what_acts_on_both_bodies_pushes_the_one_then_the_other():
    ground, estimate = worst_signs(tubes(Nominal.PROPAGATED))
    assert ground.shape == (2 * 8 * PUSH, 5)
    assert estimate.shape == (2 * 8 * PUSH, 6)
    assert set(np.unique(np.hstack([ground, estimate]))) <= {-1.0, 0.0, 1.0}
    shared, own = (np.split(ground[:, GROUND.index(name)], 2) for name in ("tractor_crab", "trailer_crab"))
    assert (shared[0] != shared[1]).any()
    np.testing.assert_array_equal(own[0], own[1])

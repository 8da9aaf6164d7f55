"""The tubes of the declared models: no disturbance within its bound takes an error out of its set in one step."""

import numpy as np
import pytest
from controllers import AncillaryLaw

from drawbar.control.settings import BodyTubeSettings, Nominal, TubeOperatingRange
from drawbar.control.tube.sources import declared_sources
from drawbar.control.tube.tube import closed_loop, tube_of
from drawbar.errors import TubeError
from drawbar.signals import BodyPlan, SolverStatus

BODIES = [(model, name) for model in ("articulated", "tricycle") for name in ("tractor", "trailer")]


def disturbances(model, sources, rng, count):
    """Return extreme disturbances (v, count, n) at each operating point, of the generators at that point."""
    total = np.zeros((len(model.A), count, len(model.states)))
    for source in sources:
        signs = rng.choice([-1.0, 1.0], size=(len(model.A), count, source.generators.shape[1]))
        total += source.bound * signs @ np.broadcast_to(source.generators, (len(model.A), *source.generators.shape[1:]))
    return total


def margin(tube, error):
    """Return what the ancillary law says of an error's distance to the boundary of its tube."""
    nowhere = {"steering": 0.0, "poses": np.zeros((2, 3)), "steerings": np.zeros(1)}
    return AncillaryLaw(tube, 1.0).apply(BodyPlan(**nowhere, deviation=error, status=SolverStatus.SOLVED)).margin


@pytest.mark.parametrize("nominal", Nominal)
@pytest.mark.parametrize(("model", "name"), BODIES)
def test_nothing_leaves_in_one_step(model, name, nominal, body, declared, boundary, scattered):
    rng = np.random.default_rng(7)
    vehicle, settings = body(model, name), declared[model, name]
    tube = tube_of(name, vehicle, settings, nominal)
    around, errors = tube.invariant_set, vehicle.model
    n = len(errors.states)
    assert around.bounded.tolist() == list(range(n))
    scales = around.support(np.eye(n))
    A = closed_loop(errors, tube.gain, nominal)
    sources = declared_sources(name, errors, tube.gain, settings, nominal)
    extremes = disturbances(errors, sources, rng, 200)
    points = boundary(around, scattered(8, 60, scales))
    directions = scattered(9, 80, scales)
    limits = around.support(directions) * (1.0 + 1e-9)
    after = (points @ A.transpose(0, 2, 1))[:, :, None] + extremes[:, None]
    assert after[..., 0].size >= 100_000  # of each of twelve tubes: more than a million in all
    worst = (after.reshape(-1, n) @ directions.T).max(axis=0)
    assert np.all(worst <= limits)
    # and not for want of trying: the set is filled in its coordinates' directions, where the operating points agree
    if np.ptp(A, axis=0).max() < 1e-12:
        assert worst[:n] == pytest.approx(limits[:n], rel=1e-6)


@pytest.mark.parametrize(("model", "name"), BODIES)
def test_operating_points_may_change_at_every_step(model, name, body, declared):
    rng = np.random.default_rng(10)
    vehicle, settings = body(model, name), declared[model, name]
    tube = tube_of(name, vehicle, settings, Nominal.PROPAGATED)
    A = closed_loop(vehicle.model, tube.gain, Nominal.PROPAGATED)
    sources = declared_sources(name, vehicle.model, tube.gain, settings, Nominal.PROPAGATED)
    error = np.zeros((300, len(tube.gain)))
    reached = np.zeros(len(tube.gain))
    for _ in range(200):
        at = rng.integers(len(A), size=len(error))
        pushes = disturbances(vehicle.model, sources, rng, len(error))[at, np.arange(len(error))]
        error = np.einsum("kij,kj->ki", A[at], error) + pushes
        reached = np.maximum(reached, np.abs(error).max(axis=0))
        assert margin(tube, error[0]) > 0.0
    limits = tube.support(np.eye(len(reached)))
    assert np.all(reached <= limits)
    assert np.all(reached >= 0.15 * limits)


def test_the_margin_is_one_inside_none_on_the_edge_and_negative_outside(body, declared, boundary):
    vehicle = body("articulated", "tractor")
    tube = tube_of("tractor", vehicle, declared["articulated", "tractor"], Nominal.PREDICTED)
    assert margin(tube, np.zeros(3)) == 1.0
    edge = boundary(tube.invariant_set, tube.facets)
    for point in edge:
        assert margin(tube, point) == pytest.approx(0.0, abs=1e-9)
        assert margin(tube, 0.5 * point) == pytest.approx(0.5, abs=1e-9)
        assert margin(tube, 1.5 * point) == pytest.approx(-0.5, abs=1e-9)


def test_what_the_law_sees_and_what_is_true_differ_by_the_estimate(body, declared):
    vehicle, settings = body("articulated", "trailer"), declared["articulated", "trailer"]
    axes, wide = np.eye(2), np.array([0.01, 0.01])
    own = tube_of("trailer", vehicle, settings, Nominal.PROPAGATED)
    assert own.seen(axes) - own.support(axes) == pytest.approx(wide)
    reset = tube_of("trailer", vehicle, settings, Nominal.PREDICTED)
    assert reset.support(axes) - reset.seen(axes) == pytest.approx(wide)


def test_a_gain_on_yaw_alone_bounds_yaw_alone(body):
    paper = BodyTubeSettings(yaw=-3.0, disturbances={"yaw_rate": 0.01, "lateral_rate": 0.01})
    tube = tube_of("tractor", body("tricycle", "tractor"), paper, Nominal.PROPAGATED)
    lateral, yaw = tube.support(np.eye(2))
    assert np.isinf(lateral)
    assert tube.invariant_set.bounded.tolist() == [1]
    # yaw alone is a scalar error with the largest and smallest pole of the operating range
    assert 0.01 * 0.2 / 3.0 / 0.15 < yaw < 0.01 * 0.2 / 0.2
    assert np.isfinite(margin(tube, np.array([50.0, 0.5 * yaw])))
    # a nominal state that starts at the estimate carries no lateral error on
    reset = tube_of("tractor", body("tricycle", "tractor"), paper, Nominal.PREDICTED)
    assert np.isfinite(reset.support(np.eye(2))).all()


def test_without_feedback_only_what_decays_by_itself_is_bounded(body):
    settings = BodyTubeSettings(disturbances={"steering_rate": 0.1, "steering_offset": 0.01})
    tube = tube_of("tractor", body("articulated", "tractor"), settings, Nominal.PROPAGATED)
    assert tube.invariant_set.bounded.tolist() == [2]
    assert tube.support(np.eye(3)[2:])[0] == pytest.approx(0.1 * 0.3, rel=1e-6)  # rate times lag


def test_a_gain_of_the_wrong_sign_has_no_set(body):
    with pytest.raises(TubeError, match="no error of"):
        tube_of(
            "trailer",
            body("tricycle", "trailer"),
            BodyTubeSettings(lateral=0.8, yaw=1.6, disturbances={"coupling": 0.01}),
            Nominal.OPTIMISED,
        )


def test_operating_points_too_far_apart_have_no_common_set(body, declared):
    wide = TubeOperatingRange(speed=(0.1, 2.0), tractor_slip=(0.3, 1.0))
    with pytest.raises(TubeError, match=r"tube\.operating_range"):
        tube_of("tractor", body("articulated", "tractor", wide), declared["articulated", "tractor"], Nominal.PROPAGATED)


def test_nothing_declared_is_no_set_and_nothing_tightened(body):
    tube = tube_of("tractor", body("articulated", "tractor"), BodyTubeSettings(yaw=-0.3), Nominal.PREDICTED)
    assert tube.invariant_set is None
    assert np.isnan(margin(tube, np.zeros(3)))
    assert np.isnan(tube.support(np.eye(3))).all()
    assert all(bound.tightened == bound.original for bound in tube.bounds.values())

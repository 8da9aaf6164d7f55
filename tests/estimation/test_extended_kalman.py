"""Against a dense filter in textbook form: formulas of docs/theory, differences for Jacobians, full covariances."""

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from estimators import ExtendedKalmanFilter, MovingHorizonEstimator

from drawbar.errors import ModelError
from drawbar.estimation.articulated import ArticulatedEstimation
from drawbar.estimation.settings import (
    ArticulatedDrift,
    ArticulatedEstimatorSettings,
    ScreeningSettings,
    SlideSettings,
    SlipBounds,
    TricycleDrift,
    TricycleEstimatorSettings,
)
from drawbar.estimation.tricycle import TricycleEstimation
from drawbar.geometry import Floats
from drawbar.optimal.problem import row
from drawbar.signals import Command, FixStatus, SolverStatus
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise

VEHICLE, NOISE, SAMPLE_TIME = VehicleParameters(), SensorNoise(), 0.2
L_T, L_I, L, D, C = 1.4, 1.3, 1.1, 0.2, 0.25
MASKED = dict.fromkeys(("tractor_x", "tractor_y", "trailer_x", "trailer_y"), math.nan)
YAWS = {"tricycle": (2, 5), "articulated": (2, 3)}
CREDULOUS = ScreeningSettings(
    lateral=1e9, longitudinal=1e9, shift=1e9, repetition=1e9, hitch=math.pi, single_growth=1.0
)
UNKNOWN_SLIDE = SlideSettings(prior=0.0)
NOTHING = MASKED | dict.fromkeys(("hitch_angle", "speed", "tractor_steering", "trailer_steering"), math.nan)


def tricycle_rates(z, u):
    theta, psi, (mu, kappa, eta, beta, v) = z[2], z[5], z[6:]
    pull, angle = L / L_T * math.tan(kappa * u[0]), eta * u[1] + beta
    turn = mu * v / L_I * (math.sin(angle) - pull * math.cos(angle))
    tractor = [mu * v * math.cos(theta), mu * v * math.sin(theta), mu * v * math.tan(kappa * u[0]) / L_T]
    return np.array([*tractor, mu * v * math.cos(psi), mu * v * math.sin(psi), turn, *[0.0] * 5])


def tricycle_output(z):
    return np.array([z[0], z[1], z[3], z[4], z[9], z[10]])


def articulated_rates(z, u):
    _, _, theta, psi, delta, joint, mu, kappa, b, alpha_i, v, alpha_r = z
    speed, gamma = mu * v, theta - psi
    omega = speed * (math.tan(kappa * delta + b) - math.tan(alpha_r)) / L_T
    slide = speed * math.tan(alpha_r) - (L - D) * omega
    along = speed * math.cos(gamma) - slide * math.sin(gamma) + D * u[1] * math.sin(joint)
    across = speed * math.sin(gamma) + slide * math.cos(gamma) - D * u[1] * math.cos(joint)
    lever = L_I + D * math.cos(joint) + math.tan(alpha_i) * D * math.sin(joint)
    east = speed * (math.cos(theta) - math.tan(alpha_r) * math.sin(theta))
    north = speed * (math.sin(theta) + math.tan(alpha_r) * math.cos(theta))
    return np.array([east, north, omega, (across - math.tan(alpha_i) * along) / lever, *u, *[0.0] * 6])


def articulated_output(z):
    x, y, theta, psi, delta, joint, v = *z[:6], z[10]
    omega = articulated_rates(z, np.zeros(2))[2]
    parts = [(L - D, theta), (D, psi + joint), (L_I - C, psi)]
    trailer = [
        x - sum(r * math.cos(a) for r, a in parts),
        y - sum(r * math.sin(a) for r, a in parts),
    ]
    return np.array([x, y, *trailer, theta - psi - joint, v, delta, joint, theta, omega, z[9], z[11]])


TEXTBOOK = {"tricycle": (tricycle_rates, tricycle_output), "articulated": (articulated_rates, articulated_output)}


def step(rates, z, u):
    h = SAMPLE_TIME
    k1 = rates(z, u)
    k2 = rates(z + h / 2 * k1, u)
    k3 = rates(z + h / 2 * k2, u)
    k4 = rates(z + h * k3, u)
    return z + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def slope(function, at):
    """Return the Jacobian by central differences."""
    size = 1e-6
    columns = [(function(at + size * e) - function(at - size * e)) / (2 * size) for e in np.eye(len(at))]
    return np.array(columns).T


def outputs_of(model, measurement):
    """Return the outputs (ny,) that a measurement is; both crab angles are believed small while a fix is missing."""
    y = [getattr(measurement, name) for name in NOTHING]
    if model.name == "tricycle":
        return np.array(y)
    crab = 0.0 if math.isnan(sum(y[:4])) else math.nan
    return np.array([*y, measurement.tractor_yaw, measurement.tractor_yaw_rate, crab, crab, 0.0, 0.0])


def dense_filter(model, measurements):
    """Return the corrected states and covariances of a covariance-form filter, clipped; NaN rows left out."""
    problem = model.problem
    rates, output = TEXTBOOK[problem.model.name]
    names = [variable.name for variable in (*problem.model.states, *problem.model.parameters)]
    z = ExtendedKalmanFilter(model, measurements[0]).state.copy()
    P = np.diag(np.square(row(problem.prior_deviation, problem.estimated)))
    R = np.diag(1.0 / np.array(row(problem.weights, problem.model.outputs)))
    u, result = np.zeros(2), []
    for measurement in measurements:
        y = outputs_of(model, measurement)
        seen = np.isfinite(y[:-2])
        H = slope(output, z)[seen]
        K = P @ H.T @ np.linalg.inv(H @ P @ H.T + R[:-2, :-2][np.ix_(seen, seen)])
        z, P = z + K @ (y[:-2] - output(z))[seen], P - K @ H @ P
        for i, name in enumerate(names):
            if name in problem.bounds:
                z[i] = min(max(z[i], problem.bounds[name].lower), problem.bounds[name].upper)
        result.append((z.copy(), P.copy()))
        u = np.where(np.isfinite(y[-2:]), y[-2:], u)
        A, B = slope(lambda x, u=u: step(rates, x, u), z), slope(lambda v, z=z: step(rates, z, v), u)
        z = step(rates, z, u)
        common = np.array(row(problem.common_deviation, problem.estimated))
        noise = np.diag(np.square(row(problem.process_deviation, problem.estimated))) + np.outer(common, common)
        P = A @ P @ A.T + B @ R[-2:, -2:] @ B.T + noise
    return result


def make(name, *, still=False, **changes):
    """Return an estimation model that believes every fix; `still` without process noise."""
    changes = {"screening": CREDULOUS} | changes
    slide = {"slide": UNKNOWN_SLIDE} if name == "articulated" else {}
    if name == "tricycle":
        drift = TricycleDrift(position=0.0, yaw=0.0, slip=0.0, hitch_angle=0.0, speed=0.0)
        tricycle = TricycleEstimatorSettings.model_validate(
            {"model": name, "weighting": "statistical"} | ({"drift": drift} if still else {}) | changes
        )
        return TricycleEstimation(VEHICLE, NOISE, tricycle, SAMPLE_TIME)
    none = ArticulatedDrift(**dict.fromkeys(ArticulatedDrift.model_fields, 0.0))
    settings = ArticulatedEstimatorSettings.model_validate(
        {"model": name} | slide | ({"drift": none} if still else {}) | changes
    )
    return ArticulatedEstimation(VEHICLE, NOISE, settings, SAMPLE_TIME)


def filtered(model, measurements):
    """Return the filter's estimates, states and covariances after each correction."""
    estimator = ExtendedKalmanFilter(model, measurements[0])
    estimates, states, covariances = [], [], []
    for measurement in measurements:
        estimates.append(estimator.update(measurement))
        states.append(estimator.state.copy())
        covariances.append(estimator.root @ estimator.root.T)
        assert estimator.deviation == pytest.approx(np.sqrt(np.diag(covariances[-1])))
        estimator.prepare()
    return estimates, np.array(states), np.array(covariances)


@pytest.fixture(scope="module")
def patchy(recording):
    """Return the recording with gaps of every kind."""
    rng = np.random.default_rng(4)
    groups = [("tractor_x", "tractor_y"), ("trailer_x", "trailer_y"), *((name,) for name in [*NOTHING][4:])]
    gaps = [{name: math.nan for group in groups if rng.random() < 0.2 for name in group} for _ in recording]
    gaps[0], gaps[70], gaps[150:170] = {}, NOTHING, [MASKED] * 20
    return [replace(measurement, **gap) for measurement, gap in zip(recording, gaps, strict=True)]


@pytest.mark.parametrize("weighting", ["paper", "statistical"])
@pytest.mark.parametrize("gaps", [False, True], ids=["complete", "patchy"])
def test_agrees_with_a_dense_filter_on_the_papers_model(recording, patchy, weighting, gaps):
    assert_dense(make("tricycle", weighting=weighting), patchy if gaps else recording)


@pytest.mark.parametrize("gaps", [False, True], ids=["complete", "patchy"])
def test_agrees_with_a_dense_filter_on_the_chain(recording, patchy, gaps):
    assert_dense(make("articulated"), patchy if gaps else recording)


@pytest.mark.parametrize("name", ["tractor_yaw", "tractor_yaw_rate"])
def test_agrees_with_a_dense_filter_on_the_chain_that_turns(patchy, name):
    values = np.random.default_rng(5).normal(0.0, 0.1, len(patchy))
    values[::7] = math.nan
    turning = [replace(each, **{name: value}) for each, value in zip(patchy, values.tolist(), strict=True)]
    assert_dense(make("articulated"), turning)


def assert_dense(model, measurements):
    _, states, covariances = filtered(model, measurements)
    expected_states, expected_covariances = (
        np.array(part) for part in zip(*dense_filter(model, measurements), strict=True)
    )
    assert np.abs(states - expected_states).max() < 1e-6
    scale = np.sqrt(np.einsum("kii,kjj->kij", expected_covariances, expected_covariances))
    assert np.abs((covariances - expected_covariances) / scale).max() < 1e-5


@pytest.mark.parametrize("name", ["tricycle", "articulated"])
def test_covariance_stays_positive_definite_without_process_noise(name, recording):
    # exact data for ever, and the prior's six decades: what breaks the covariance form
    estimator = ExtendedKalmanFilter(make(name, still=True), recording[0])
    for measurement in recording * 5:
        estimator.update(measurement)
        estimator.prepare()
    values = np.linalg.svd(estimator.root, compute_uv=False)
    assert values.min() > 0.0
    assert values.min() / values.max() > 1e-9


@pytest.mark.parametrize("name", ["tricycle", "articulated"])
def test_agrees_with_the_window_where_process_noise_is_zero(name, travel, measure):
    wide = SlipBounds(lower=0.0, upper=3.0)
    bounds = {"slip_bounds": wide} if name == "tricycle" else {}
    model = make(name, still=True, **bounds)
    time = SAMPLE_TIME * np.arange(300)
    start, p, inputs = (
        np.array([5.0, -3.0, 0.4, 2.8, -3.9, 0.4]),
        np.array([0.92, 0.95, 0.9, 0.0, 1.0]),
        np.stack([0.1 * np.sin(0.3 * time), 0.1 * np.sin(0.4 * time)], axis=1),
    )
    if name == "articulated":
        start, p = np.array([5.0, -3.0, 0.4, 0.4, 0.0, 0.0]), np.array([0.92, 0.95, 0.01, 0.01, 1.0, -0.01])
        inputs = 0.4 * inputs
    _, outputs = travel(model, start, p, inputs)
    measurements = measure(outputs, seed=8)
    window, recursive = MovingHorizonEstimator(model, measurements[0]), ExtendedKalmanFilter(model, measurements[0])
    for k, measurement in enumerate(measurements):
        one, other = window.update(measurement), recursive.update(measurement)
        if k >= 100:
            for body in ("tractor", "trailer"):
                left, right = getattr(one, body), getattr(other, body)
                assert math.hypot(left.x - right.x, left.y - right.y) < 2e-3
                assert abs(left.yaw - right.yaw) < 2.4e-3
            assert one.longitudinal_slip == pytest.approx(other.longitudinal_slip, abs=5e-3)
            assert one.tractor_slip == pytest.approx(other.tractor_slip, abs=5e-3)
            assert window.deviation == pytest.approx(recursive.deviation, rel=0.1)
        window.prepare()
        recursive.prepare()


def test_slips_stay_within_their_bounds_and_reach_them(recording):
    estimates, _, _ = filtered(make("tricycle", slip_bounds=SlipBounds(lower=0.88, upper=0.91)), recording)
    for name in ("longitudinal_slip", "tractor_slip", "trailer_slip"):
        values = np.array([getattr(estimate, name) for estimate in estimates])
        assert values.min() >= 0.88
        assert values.max() <= 0.91
        assert {0.88, 0.91} & set(values.tolist())


def test_missing_positions_are_bridged_and_widen_what_is_known(model, recording):
    lost = [replace(m, **MASKED) if k >= 150 else m for k, m in enumerate(recording[:200])]
    known, _, _ = filtered(model, recording[:200])
    blind, _, covariances = filtered(model, lost)
    away = [math.hypot(a.tractor.x - b.tractor.x, a.tractor.y - b.tractor.y) for a, b in zip(known, blind, strict=True)]
    assert max(away[:150]) == 0.0
    assert 0.0 < max(away) < (0.5 if model.problem.model.name == "articulated" else 3.0)
    assert (np.diff(covariances[150:, 0, 0]) > 0.0).all()


def test_a_sample_that_is_missing_altogether_is_the_prediction(recording):
    model = make("tricycle")
    estimator = ExtendedKalmanFilter(model, recording[0])
    for measurement in recording[:50]:
        estimator.update(measurement)
        estimator.prepare()
    predicted, root = estimator.state.copy(), estimator.root.copy()
    assert estimator.update(replace(recording[50], **NOTHING)).status is SolverStatus.SOLVED
    assert estimator.state == pytest.approx(predicted, abs=0.0)
    assert estimator.root @ estimator.root.T == pytest.approx(root @ root.T, abs=1e-15)


def test_what_overflows_leaves_the_prediction_and_says_so(model, recording):
    estimator = ExtendedKalmanFilter(model, recording[0])
    false = [replace(measurement, speed=1.7e308) for measurement in recording[60:62]]  # one alone is masked
    for measurement in [*recording[:60], false[0]]:
        estimator.update(measurement)
        estimator.prepare()
    predicted = estimator.state.copy()
    estimator.state[10] = -1.7e308  # the speed, of both models
    broken = estimator.update(false[1])
    assert broken.status is SolverStatus.NOT_FINITE
    assert (estimator.state[:10] == predicted[:10]).all()


def test_a_prediction_that_is_not_finite_shows_in_the_next_status(recording):
    model = make("tricycle")
    estimator = ExtendedKalmanFilter(model, recording[0])
    estimator.update(recording[0])
    estimator.root[:] = 1e308
    estimator.prepare()
    assert estimator.update(recording[1]).status is SolverStatus.NOT_FINITE
    estimator.prepare()
    assert estimator.update(recording[2]).status is SolverStatus.SOLVED


def test_every_input_must_be_measured(recording):
    model = make("tricycle")
    declared = model.problem.model
    doubled = replace(declared, output=ca.vertcat(declared.output[:-1], 2.0 * declared.u[1]))
    model.problem = replace(model.problem, model=doubled)
    with pytest.raises(ModelError, match="every input of 'tricycle' as an output"):
        ExtendedKalmanFilter(model, recording[0])


def test_the_command_tells_the_rates_at_which_the_steering_moves(recording):
    model = make("articulated")
    told, untold = (ExtendedKalmanFilter(model, recording[0]) for _ in range(2))
    for measurement in recording[:50]:
        told.update(measurement)
        untold.update(measurement)
        before, further = told.state[4:6].copy(), np.array([0.03, -0.02])  # below the actuators' rates
        asked = before + further
        told.prepare(Command(time=measurement.time, tractor_steering=asked[0], trailer_steering=asked[1], speed=1.0))
        untold.prepare()
        lagged = -math.expm1(-SAMPLE_TIME / VEHICLE.steering_lag) * further
        assert told.state[4:6] - before == pytest.approx(lagged, abs=1e-12)
    assert untold.state[4:6] != pytest.approx(told.state[4:6], abs=1e-3)


def test_a_command_that_has_not_arrived_yet_tells_nothing(recording):
    nothing = Command(time=math.nan, tractor_steering=math.nan, trailer_steering=math.nan, speed=math.nan)
    waiting, untold = (ExtendedKalmanFilter(make("articulated"), recording[0]) for _ in range(2))
    for measurement in recording[:5]:
        assert waiting.update(measurement) == untold.update(measurement)
        waiting.prepare(nothing)
        untold.prepare()
    assert waiting.update(recording[5]).status is SolverStatus.SOLVED


def test_a_fix_that_cannot_be_is_not_followed(recording):
    model = make("articulated", screening=ScreeningSettings())
    estimator = ExtendedKalmanFilter(model, recording[0])
    for measurement in recording[:60]:
        estimator.update(measurement)
        estimator.prepare()
    estimate = estimator.update(replace(recording[60], tractor_x=recording[60].tractor_x + 5.0))
    assert estimate.tractor_fix is FixStatus.REJECTED
    assert math.hypot(estimate.tractor.x - recording[60].tractor_x, estimate.tractor.y - recording[60].tractor_y) < 0.2


@pytest.mark.parametrize("name", ["tricycle", "articulated"])
def test_both_antennas_can_start_it_anew(name, recording):
    estimator = ExtendedKalmanFilter(make(name, screening=ScreeningSettings()), recording[0])
    first_deviation, statuses = estimator.deviation, []
    estimator.state[list(YAWS[name])] += 4.0 * math.pi  # continuous along a run
    for measurement in recording[:60]:
        estimator.update(measurement)
        estimator.prepare()
    yaws = estimator.state[list(YAWS[name])].copy()
    for measurement in recording[60:100]:  # a new base station
        towed = replace(measurement, tractor_x=measurement.tractor_x + 4.0, trailer_x=measurement.trailer_x + 4.0)
        estimate = estimator.update(towed)
        statuses.append((estimate.tractor_fix, estimate.trailer_fix))
        if statuses[-1] == (FixStatus.ACCEPTED, FixStatus.ACCEPTED):
            break
        estimator.prepare()
    assert set(statuses[:-1]) == {(FixStatus.REJECTED, FixStatus.REJECTED)}
    assert math.hypot(estimate.tractor.x - towed.tractor_x, estimate.tractor.y - towed.tractor_y) < 0.1  # of 4 m
    assert np.abs(estimator.state[list(YAWS[name])] - yaws).max() < 0.5  # the same branch
    assert estimator.deviation[6] == pytest.approx(first_deviation[6], rel=1e-2)  # no slip has shown yet


def window_deviation(estimator, model, travel) -> Floats:
    """Return what the window's residuals, differentiated by differences along its trajectory, say of its last state."""
    solver = estimator.solver
    declared, newest = model.problem.model, solver.newest
    nx, nu = len(declared.states), len(declared.inputs)
    weights = np.sqrt(row(model.problem.weights, declared.outputs))

    def both(v):
        z, u = v[: solver.x.shape[1]], v[solver.x.shape[1] :].reshape(newest, nu)
        states, outputs = travel(model, z[:nx], z[nx:], u)
        missing = np.isnan(solver.y[: newest + 1])
        missing[newest, -2:] |= solver.w[newest, -2:] == 0.0
        residuals = np.where(missing, 0.0, weights * outputs)
        return np.concatenate([states[-1], z[nx:], solver.root @ z, residuals.ravel()])

    at = np.concatenate([solver.x[0], solver.u[:newest].ravel()])
    J = slope(both, at)
    last, residuals = J[: solver.x.shape[1]], J[solver.x.shape[1] :]
    return np.sqrt(np.diag(last @ np.linalg.inv(residuals.T @ residuals) @ last.T))


@pytest.mark.parametrize("samples", [6, 40], ids=["filling", "full"])
def test_the_windows_deviation_is_that_of_its_least_squares(model, travel, measure, samples):
    p = [0.92, 0.95, 0.0, 0.0, 1.0, 0.0] if model.problem.model.name == "articulated" else [0.92, 0.95, 0.9, 0.0, 1.0]
    start = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0] if len(p) == 6 else [0.0, 0.0, 0.0, -2.15, 0.0, 0.0]
    inputs = np.full((samples, 2), 0.02)
    _, outputs = travel(model, np.array(start), np.array(p), inputs)
    measurements = measure(outputs)
    estimator = MovingHorizonEstimator(model, measurements[0])
    for measurement in measurements:
        estimator.update(measurement)
        estimator.prepare()  # linearises along the trajectory, where the differences are taken
    assert estimator.deviation == pytest.approx(window_deviation(estimator, model, travel), rel=1e-3)

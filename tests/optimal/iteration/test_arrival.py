"""The arrival cost: a Kalman filter where the model is linear, full information where there is no process noise."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import pytest

from drawbar.geometry import Floats
from drawbar.optimal import EstimationProblem, EstimationSolver
from drawbar.optimal.problem import row
from drawbar.signals import SolverStatus
from drawbar.vehicle.integrators import integrate
from drawbar.vehicle.model import Model, symbols, variables

SAMPLE, N = 0.2, 5
NOISE = np.array([0.3, 0.1])
"""standard deviations of the measured position and acceleration"""
STATES = ("position", "speed", "pull")
PRIOR, DEVIATION = np.array([0.5, -0.2, 0.1]), np.array([1.0, 2.0, 0.3])


def cart() -> Model:
    """A cart on a line, pulled by an unknown constant force beside the measured acceleration."""
    states, inputs = variables(position="m", speed="m/s"), variables(acceleration="m/s²")
    parameters = variables(pull="m/s²")
    x, u, p = symbols(states), symbols(inputs), symbols(parameters)
    return Model(
        name="cart",
        states=states,
        inputs=inputs,
        parameters=parameters,
        outputs=variables(position="m", acceleration="m/s²"),
        x=x,
        u=u,
        p=p,
        derivative=ca.vertcat(x[1] - 0.1 * x[0], u + p - 0.3 * x[1]),
        output=ca.vertcat(x[0], u),
    )


@dataclass(frozen=True, slots=True)
class Line:
    """The cart, discrete: next = A x + B u, with the pull as third state."""

    A: Floats
    B: Floats

    @classmethod
    def of(cls, model: Model) -> "Line":
        step = ca.vertcat(integrate(model, SAMPLE), model.p)
        x = ca.vertcat(model.x, model.p)
        slopes = ca.Function("slopes", [x, model.u], [ca.jacobian(step, x), ca.jacobian(step, model.u)])
        A, B = slopes(np.zeros(3), 0.0)
        return cls(np.array(A), np.array(B)[:, 0])


def problem(process: Floats, common: tuple[float, ...] = ()) -> EstimationProblem:
    return EstimationProblem(
        model=cart(),
        horizon=N,
        sample_time=SAMPLE,
        weights=dict(zip(("position", "acceleration"), 1.0 / NOISE**2, strict=True)),
        prior_deviation=dict(zip(STATES, DEVIATION, strict=True)),
        process_deviation=dict(zip(STATES, process, strict=True)),
        common_deviation=dict(zip(STATES, common, strict=False)),
    )


def measurements(count: int) -> Floats:
    """Return (count, 2) readings of a random run; one in ten is missing."""
    rng = np.random.default_rng(50)
    y = rng.normal(size=(count, 2)).cumsum(axis=0) * 0.1 + NOISE * rng.normal(size=(count, 2))
    y[rng.random(count) < 0.1, 0] = np.nan
    return y


def fed(solver: EstimationSolver, y: Floats) -> Iterator[int]:
    """Feed the readings one by one as in operation; yield the number read so far, after each feedback."""
    for k, reading in enumerate(y):
        if k > 0:
            assert solver.advance() == SolverStatus.SOLVED
        solver.y[solver.newest] = reading
        assert solver.feedback() == SolverStatus.SOLVED
        yield k + 1


def batch(line: Line, y: Floats) -> Floats:
    """Return the states (len(y), 3) that minimise the sum of squares over everything ever measured."""
    steps = len(y)
    reach = np.zeros((steps, 3, 3 + steps - 1))  # state k as a linear function of (x_0, every u)
    reach[0, :, :3] = np.eye(3)
    for k in range(steps - 1):
        reach[k + 1] = line.A @ reach[k]
        reach[k + 1, :, 3 + k] += line.B
    seen = ~np.isnan(y[:, 0])
    pushes = np.eye(3 + steps - 1)[3:] / NOISE[1]
    rows = [reach[seen, 0] / NOISE[0], pushes, np.eye(3 + steps - 1)[:3] / DEVIATION[:, None]]
    right = [y[seen, 0] / NOISE[0], y[:-1, 1] / NOISE[1], PRIOR / DEVIATION]
    best: Floats = np.linalg.lstsq(np.vstack(rows), np.concatenate(right), rcond=None)[0]
    states: Floats = reach @ best
    return states


@pytest.mark.parametrize(
    ("process", "common"),
    [
        ((0.05, 0.1, 0.02), ()),
        ((0.0, 0.1, 0.0), ()),
        ((0.0, 0.0, 0.0), ()),
        ((0.0, 0.0, 0.0), (0.03, 0.0, 0.05)),
        ((0.05, 0.1, 0.02), (0.1, 0.2, 0.3)),
    ],
)
def test_linear_arrival_cost_is_a_kalman_filter(process: tuple[float, ...], common: tuple[float, ...]) -> None:
    y, noise, shared = measurements(200), np.array(process), np.array(common or (0.0,) * 3)
    solver = EstimationSolver(problem(noise, common), PRIOR)
    line = Line.of(cart())
    mean, covariance = PRIOR.copy(), np.diag(DEVIATION**2)
    for count in fed(solver, y):
        oldest = count - N - 2
        if oldest < 0:
            continue
        if not np.isnan(y[oldest, 0]):
            gain = covariance[:, 0] / (covariance[0, 0] + NOISE[0] ** 2)
            mean = mean + gain * (y[oldest, 0] - mean[0])
            left = np.eye(3) - np.outer(gain, [1.0, 0.0, 0.0])
            covariance = left @ covariance @ left.T + NOISE[0] ** 2 * np.outer(gain, gain)
        mean = line.A @ mean + line.B * y[oldest, 1]
        push = NOISE[1] ** 2 * np.outer(line.B, line.B)
        covariance = line.A @ covariance @ line.A.T + push + np.diag(noise**2) + np.outer(shared, shared)
        np.testing.assert_allclose(solver.prior, mean, rtol=0, atol=1e-9)
        information = solver.root.T @ solver.root
        np.testing.assert_allclose(information @ covariance, np.eye(3), rtol=0, atol=1e-8)


def test_without_process_noise_the_window_knows_everything_ever_measured() -> None:
    y = measurements(60)
    solver = EstimationSolver(problem(np.zeros(3)), PRIOR)
    line = Line.of(cart())
    for count in fed(solver, y):
        expected = batch(line, y[:count])[-(N + 1) :]
        np.testing.assert_allclose(solver.x[: len(expected)], expected, rtol=0, atol=1e-7)


@pytest.mark.parametrize("process", [(0.05, 0.1, 0.02), (0.0, 0.0, 0.0)])
def test_an_input_that_nobody_measured_takes_what_was_known_along_it(process: tuple[float, ...]) -> None:
    y, line = measurements(60)[:, :1], Line.of(cart())
    y = np.hstack([y, np.full_like(y, np.nan)])
    solver = EstimationSolver(problem(np.array(process)), PRIOR)
    information = np.diag(DEVIATION**-2)
    for count in fed(solver, y):
        oldest = count - N - 2
        if oldest < 0:
            continue
        if not np.isnan(y[oldest, 0]):
            information[0, 0] += NOISE[0] ** -2
        inverse = np.linalg.inv(line.A)
        information = inverse.T @ information @ inverse
        for g, own in [(line.B, 0.0), *zip(np.diag(process), (1.0,) * 3, strict=True)]:
            pull = information @ g
            information = information - np.outer(pull, pull) / (own + g @ pull)
        scale = np.abs(information).max()
        np.testing.assert_allclose(solver.root.T @ solver.root, information, rtol=0, atol=1e-9 * scale)
        assert np.abs(solver.prior).max() < 100.0


def extended_kalman(case: Any, y: Floats, process: Floats) -> Floats:
    """Return the filtered states and parameters (len(y), n) of an extended Kalman filter; inputs are noise."""
    problem = case.problem
    model = problem.model.numeric()
    x = ca.vertcat(model.x, model.p)
    step = ca.vertcat(integrate(model, SAMPLE), model.p)
    kept = ca.vertcat(model.output[:8])
    evaluate = ca.Function(
        "linear",
        [x, model.u],
        [step, ca.jacobian(step, x), ca.jacobian(step, model.u), kept, ca.jacobian(kept, x)],
    )
    mean, covariance = case.initial.copy(), np.diag(np.square(row(problem.prior_deviation, problem.estimated)))
    noise = 1.0 / np.sqrt(row(problem.weights, model.outputs))
    rows = []
    for reading in y:
        _, _, _, h, H = (np.array(m) for m in evaluate(mean, np.zeros(2)))
        seen = ~np.isnan(reading[:8])
        H, innovation = H[seen], (reading[:8] - h[:, 0])[seen]
        spread = H @ covariance @ H.T + np.diag(noise[:8][seen] ** 2)
        gain = np.linalg.solve(spread, H @ covariance).T
        mean = mean + gain @ innovation
        covariance = covariance - gain @ spread @ gain.T
        rows.append(mean)
        following, A, B, _, _ = (np.array(m) for m in evaluate(mean, np.zeros(2)))
        mean = following[:, 0]
        covariance = A @ covariance @ A.T + B @ np.diag(noise[8:] ** 2) @ B.T + np.diag(process**2)
    return np.array(rows)


def test_without_process_noise_it_agrees_with_an_extended_kalman_filter(long_run: Any) -> None:
    case, y, true = long_run
    window, noiseless = case.problem.horizon, np.zeros(12)
    filtered = extended_kalman(case, y, noiseless)
    solver = EstimationSolver(case.problem, case.initial)
    estimates = np.array([solver.x[min(count - 1, window)].copy() for count in fed(solver, y)])
    apart, yaws = np.abs(estimates - filtered)[50:], [2, 3]
    assert apart[:, :2].max() < 0.002
    assert apart[:, yaws].max() < 0.0024
    off = np.abs(estimates[50:, :2] - true[50:, :2])
    assert off.max() < 0.03, "both are good estimates, not only alike"

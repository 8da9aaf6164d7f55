import math

import numpy as np
import pytest
from numpy.linalg import LinAlgError
from scipy.linalg import solve_discrete_are, solve_discrete_lyapunov

from drawbar.control.matrix_equations import regulator_gain, solve_lyapunov, spectral_radius


@pytest.mark.parametrize("seed", range(5))
def test_gain_is_the_limit_of_value_iteration(seed):
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(1, 6)), int(rng.integers(1, 3))
    A, B = rng.normal(size=(n, n)), rng.normal(size=(n, m))
    root = rng.normal(size=(n, n))
    Q, R = root @ root.T + 0.1 * np.eye(n), np.diag(rng.uniform(0.1, 2.0, m))
    P = Q
    for _ in range(2000):
        K = np.linalg.inv(R + B.T @ P @ B) @ B.T @ P @ A
        P = Q + K.T @ R @ K + (A - B @ K).T @ P @ (A - B @ K)
    assert regulator_gain(A, B, Q, R) == pytest.approx(K, rel=1e-8, abs=1e-10)


def test_gain_of_a_scalar_system_is_the_root_of_its_quadratic():
    a, b, q, r = 1.1, 0.4, 2.0, 0.5
    half = 0.5 * (q * b**2 + r * (a**2 - 1.0))
    p = (half + math.sqrt(half**2 + q * r * b**2)) / b**2
    gain = regulator_gain(*(np.array([[value]]) for value in (a, b, q, r)))
    assert gain[0, 0] == pytest.approx(a * b * p / (r + b**2 * p), rel=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_gain_of_unstable_systems_agrees_with_scipy(seed):
    rng = np.random.default_rng(100 + seed)
    A, B = 2.0 * rng.normal(size=(4, 4)), rng.normal(size=(4, 2))
    Q, R = np.diag([1.0, 0.0, 1.0, 0.0]), np.diag(10.0 ** rng.uniform(-4.0, 3.0, 2))
    P = solve_discrete_are(A, B, Q, R)
    assert spectral_radius(A) > 1.0
    assert regulator_gain(A, B, Q, R) == pytest.approx(np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A), rel=1e-6)


def test_one_step_of_newton_takes_out_what_doubling_rounds():
    rng = np.random.default_rng(4)  # six unstable states and one input: doubling alone leaves 1e-4
    A, B, Q, R = 2.0 * rng.normal(size=(6, 6)), rng.normal(size=(6, 1)), np.eye(6), np.array([[1e3]])
    gain = regulator_gain(A, B, Q, R)
    P = solve_discrete_lyapunov((A - B @ gain).T, Q + gain.T @ R @ gain)
    assert gain == pytest.approx(np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A), rel=1e-6)


def test_a_double_integrator_of_tiny_weights_keeps_the_gain_of_continuous_time():
    A, B = np.array([[1.0, 0.1], [0.0, 1.0]]), np.array([[0.005], [0.1]])
    gain = regulator_gain(A, B, 1e-20 * np.eye(2), np.array([[1.0]]))
    assert gain[0] == pytest.approx([1e-10, math.sqrt(2e-10)], rel=1e-4)


def test_what_no_gain_holds_is_an_error():
    A, Q, R = np.diag([1.0, 0.5]), np.diag([0.0, 1.0]), np.array([[1.0]])
    with pytest.raises(LinAlgError, match="spectral radius is 1"):  # nobody pays for the first state
        regulator_gain(A, np.array([[1.0], [1.0]]), Q, R)
    with pytest.raises(LinAlgError, match="a state grows"):  # nothing moves it
        regulator_gain(np.diag([1.1, 0.5]), np.array([[0.0], [1.0]]), np.eye(2), R)


@pytest.mark.parametrize("radius", [0.1, 0.9, 0.9995, 0.999999])
def test_lyapunov_agrees_with_scipy(radius):
    rng = np.random.default_rng(7)
    A = rng.normal(size=(5, 5))
    A *= radius / spectral_radius(A)
    assert solve_lyapunov(A, np.eye(5)) == pytest.approx(solve_discrete_lyapunov(A, np.eye(5)), rel=1e-8)


@pytest.mark.parametrize("radius", [1.0, 1.5])
def test_lyapunov_of_what_does_not_decay_is_an_error(radius):
    with pytest.raises(LinAlgError, match="spectral radius is 1"):
        solve_lyapunov(np.diag([radius, 0.2]), np.eye(2))

"""Matrix equations of linear control by doubling: each step takes twice as many samples together, in numpy alone.

scipy.linalg solves them too, but importing it takes longer than all else that a run does before its first step.
"""

import numpy as np
from numpy.linalg import LinAlgError

from drawbar.geometry import Floats

_DOUBLINGS = 60
_ROUNDING = 1e-14
_SLOWEST = 1.0 - 1e-7
"""spectral radius of a closed loop from which on rounding decides whether it is stable"""


def spectral_radius(A: Floats) -> float:
    """Return the largest magnitude of an eigenvalue of A (n, n), 0 for an empty matrix."""
    return float(np.abs(np.linalg.eigvals(A)).max(initial=0.0))


def solve_lyapunov(A: Floats, Q: Floats) -> Floats:
    """Return X (n, n) = A X A' + Q, the sum of A^k Q A'^k, by Smith's squared method (Smith 1968).

    Raises:
        LinAlgError: the sum does not converge, A (n, n) is not stable.
    """
    radius = spectral_radius(A)
    if not radius < 1.0:
        raise LinAlgError(f"Lyapunov's equation has no solution, the spectral radius is {radius:.9g}")
    X, power = Q, A
    for _ in range(_DOUBLINGS):
        more = power @ X @ power.T
        X, power = X + more, power @ power
        if _is_nothing_beside(more, X):
            return X
    raise LinAlgError(f"Lyapunov's sum does not converge, the spectral radius is {radius:.9g}")


def regulator_gain(A: Floats, B: Floats, Q: Floats, R: Floats) -> Floats:
    """Return K (nu, nx) such that u = -K x minimises the sum of x'Qx + u'Ru under x+ = A x + B u.

    Args:
        A: (nx, nx).
        B: (nx, nu).
        Q: (nx, nx), positive semidefinite.
        R: (nu, nu), positive definite.

    Raises:
        LinAlgError: no gain makes the closed loop stable and the cost smallest, as far as rounding lets see.
    """
    gain = _gain(A, B, R, _cost_of_many_samples(A, B, Q, R))
    slowest = spectral_radius(A - B @ gain)
    if not slowest < _SLOWEST:
        raise LinAlgError(f"the closed loop's spectral radius is {slowest:.9g}")
    cost = solve_lyapunov((A - B @ gain).T, Q + gain.T @ R @ gain)  # what rounding left goes by one step of Newton's
    return _gain(A, B, R, cost)


@np.errstate(over="ignore", invalid="ignore")
def _cost_of_many_samples(A: Floats, B: Floats, Q: Floats, R: Floats) -> Floats:
    """Return H (nx, nx), where x'Hx is the smallest cost of 1, 2, 4, ... samples (Chu, Fan, Lin and Wang 2004)."""
    power, G, H = A, B @ np.linalg.solve(R, B.T), Q
    for _ in range(_DOUBLINGS):
        through = np.linalg.solve(np.eye(len(A)) + G @ H, np.hstack([power, G]))
        onward, spread = np.hsplit(through, 2)
        more = power.T @ H @ onward
        G, H, power = G + power @ spread @ power.T, H + 0.5 * (more + more.T), power @ onward
        if not np.isfinite(H).all():
            raise LinAlgError("the cost has no bound: a state grows that no input holds")
        if _is_nothing_beside(more, H):
            break
    return H


def _is_nothing_beside(more: Floats, whole: Floats) -> bool:
    return bool(np.abs(more).max(initial=0.0) <= _ROUNDING * np.abs(whole).max(initial=0.0))


def _gain(A: Floats, B: Floats, R: Floats, P: Floats) -> Floats:
    return np.asarray(np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A))

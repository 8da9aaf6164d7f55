"""Fairing of a line: as close to the recorded points as curvature and its rate allow.

Points are complex, east + i north. The nodes are the control points of a uniform cubic B-spline, so their
second and third differences are the curvature at the spline's knots and its rate between them. `smooth` costs
one banded solve without limits. `limit` is for the stretches that are too tight after it: linear programs
that move the nodes along their normals, bound curvature and rate, and minimise first the largest deviation
from the recorded points, then the mean one and the variation of curvature.
"""

import numpy as np
import scipy.sparse as sparse
from scipy.interpolate import CubicSpline
from scipy.linalg import solveh_banded
from scipy.optimize import linprog
from scipy.spatial import KDTree

from drawbar.geometry import Floats
from drawbar.guidance.path import Complexes

_THIRD = (-1.0, 3.0, -3.0, 1.0)
"""coefficients of the third difference"""
_PINNED = 3
"""nodes at either end of a stretch that stay, so that curvature is continuous where stretches meet"""
_TRUST = 0.5
"""largest move of a node per linear program, m"""
_CONVERGED = 1e-3
"""largest last move, m"""
_ITERATIONS = 25
_LARGEST, _MEAN, _FAIR = 1e3, 1.0, 0.2
"""costs of the largest deviation (1/m), the mean one (1/m²) and the variation of curvature"""


def smooth(points: Complexes, length: float, *, step: float, movable: slice | None = None) -> Complexes:
    """Return the points that minimise sum |p - points|² + (length/step)⁶ sum |third difference of p|².

    Details shorter than `length` (m), or than the whole line, are smoothed away; step (m) is the distance
    between points. Only the points in `movable`, where it is given, may move; the others keep their places.
    """
    n = len(points)
    stiffness = min(length / step, n) ** 6  # beyond the line's own length there is only rounding to gain
    weight = np.ones(n)
    if movable is not None:
        weight[:] = 1e9
        weight[movable] = 1.0
    bands = np.zeros((4, n))  # upper bands of the penalty's Hessian, as solveh_banded wants them
    for i, first in enumerate(_THIRD):
        for k, second in enumerate(_THIRD[i:]):
            bands[3 - k, i + k : i + k + n - 3] += first * second * stiffness
    bands[3] += weight
    solved = solveh_banded(bands, _columns(points) * weight[:, None])
    smoothed: Complexes = solved[:, 0] + 1j * solved[:, 1]
    return smoothed


def knots(nodes: Complexes) -> tuple[Complexes, Complexes]:
    """Return positions (n,) and derivatives (n,) by index of the B-spline at its knots beside the nodes.

    The control polygon is continued at both ends with the curvature that it has there.
    """
    before = 3.0 * (nodes[0] - nodes[1]) + nodes[2]
    after = 3.0 * (nodes[-1] - nodes[-2]) + nodes[-3]
    ring = np.concatenate([[before], nodes, [after]])
    return (ring[:-2] + 4.0 * nodes + ring[2:]) / 6.0, 0.5 * (ring[2:] - ring[:-2])


def equal_steps(points: Complexes, count: int) -> Complexes:
    """Return `count` points in equal steps along the interpolating spline of the points."""
    spline = CubicSpline(chord_length(points), points)
    return np.asarray(spline(np.linspace(0.0, spline.x[-1], count)))


def chord_length(points: Complexes) -> Floats:
    """Return (n,) the length along the polyline up to each point, m."""
    lengths: Floats = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(points)))])
    return lengths


def _columns(points: Complexes) -> Floats:
    return np.column_stack([points.real, points.imag])


def _unit(vectors: Complexes) -> Complexes:
    return vectors / np.abs(vectors)


def curvatures(points: Complexes) -> Floats:
    """Return (n-2,) curvatures at the inner points, 1/m."""
    chords = np.diff(points)
    step = np.abs(chords)
    bends: Floats = 2.0 * np.angle(chords[1:] * chords[:-1].conj()) / (step[1:] + step[:-1])
    return bends


def limit(
    nodes: Complexes, recorded: Complexes, *, curvature: float, rate: float, free: tuple[bool, bool]
) -> Complexes:
    """Return nodes within the curvature (1/m) and rate (1/m²), close to the recorded points.

    nodes (n,): a first guess; free: whether its first and last nodes may move. The nodes come back as
    they are when the linear program has no solution; the caller checks the result anyway.
    """
    for _ in range(_ITERATIONS):
        nodes = equal_steps(nodes, len(nodes))
        moves = _best_moves(nodes, recorded, curvature, rate, free)
        if moves is None:
            break
        nodes = nodes + 1j * _unit(knots(nodes)[1]) * moves
        if np.abs(moves).max() <= _CONVERGED:
            break
    return nodes


def _best_moves(
    nodes: Complexes, recorded: Complexes, curvature: float, rate: float, free: tuple[bool, bool]
) -> Floats | None:
    """Return the moves (n,) of the nodes to their left, m, that solve the problem linearised at the nodes."""
    bends, kappa, step = _curvature_of_moves(nodes)
    changes, kappa_rate = (bends[1:] - bends[:-1]) / step, np.diff(kappa) / step
    shifts, deviation = _deviation_of_moves(nodes, recorded, step)
    n, m, r = len(nodes), len(recorded), len(kappa_rate)
    largest = np.ones((m, 1))
    one = sparse.eye_array
    # unknowns: moves (n), bound on each change of curvature (r), on each deviation (m), on the largest (1)
    blocks: list[list[object]] = []
    right: list[Floats] = []
    for sign in (1.0, -1.0):
        blocks += [
            [sign * bends, None, None, None],
            [sign * changes, -one(r), None, None],
            [sign * shifts, None, -one(m), None],
            [sign * shifts, None, None, -largest],
        ]
        right += [curvature - sign * kappa, -sign * kappa_rate, sign * deviation, sign * deviation]
    cost = np.concatenate([np.zeros(n), np.full(r, _FAIR * step), np.full(m, _MEAN * step), [_LARGEST]])
    upper = np.concatenate([np.full(n, _TRUST), np.full(r, rate), np.full(m + 1, np.inf)])
    lower = np.concatenate([np.full(n, -_TRUST), np.zeros(r + m + 1)])
    for fixed, ends in ((not free[0], slice(_PINNED)), (not free[1], slice(n - _PINNED, n))):
        if fixed:
            lower[ends] = upper[ends] = 0.0
    solution = linprog(
        cost,
        A_ub=sparse.block_array(blocks, format="csc"),
        b_ub=np.concatenate(right),
        bounds=np.column_stack([lower, upper]),
        method="highs-ipm",
    )
    return None if solution.x is None else np.asarray(solution.x[:n])


def _curvature_of_moves(nodes: Complexes) -> tuple[sparse.csr_array, Floats, float]:
    """Return the curvatures' derivative (n-2, n) by the moves, the curvatures (n-2,) and the step (m)."""
    n = len(nodes)
    step = float(np.abs(np.diff(nodes)).mean())
    kappa = curvatures(nodes)
    second = sparse.diags_array([1.0, -2.0, 1.0], offsets=[0, 1, 2], shape=(n - 2, n)) / step**2
    offset = sparse.diags_array([kappa**2], offsets=[1], shape=(n - 2, n))
    return sparse.csr_array(second + offset), kappa, step


def _deviation_of_moves(nodes: Complexes, recorded: Complexes, step: float) -> tuple[sparse.csr_array, Floats]:
    """Return how much the moves shift the line beside each recorded point (m, n), and the deviations (m,)."""
    n, m = len(nodes), len(recorded)
    position, derivative = knots(nodes)
    nearest = KDTree(_columns(position)).query(_columns(recorded))[1]
    seen = (recorded - position[nearest]) * _unit(derivative[nearest]).conj()
    place = np.clip(nearest + seen.real / step, 0.0, n - 1.0)
    before = np.minimum(place.astype(np.intp), n - 2)
    share = place - before
    rows = np.arange(m)
    entries = np.concatenate([1.0 - share, share])
    columns = np.concatenate([before, before + 1])
    return sparse.csr_array((entries, (np.concatenate([rows, rows]), columns)), shape=(m, n)), seen.imag

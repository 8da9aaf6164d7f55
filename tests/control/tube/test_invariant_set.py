"""Against sets that are known in closed form, an independent iteration, and a million attempts to leave."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from drawbar.control.tube.error_model import Source
from drawbar.control.tube.invariant_set import InvariantSet


def segments(*rows, bound=1.0, name="w"):
    return Source(name=name, unit="m", bound=bound, generators=np.array([rows], dtype=float))


def whole(A, *sources):
    return InvariantSet.of(np.array(A, dtype=float), sources, np.arange(len(A)))


@pytest.mark.parametrize("a", [0.0, 0.5, -0.8, 0.97])
def test_a_scalar_error_is_bounded_by_the_geometric_series(a):
    around = whole([[a]], segments([1.0], bound=0.2), segments([3.0], bound=0.1))
    exact = np.array([0.2, 0.3]) / (1.0 - abs(a))
    assert around.contributions(np.array([[-2.0]]))[0] == pytest.approx(2.0 * exact, rel=1e-6)
    excess = around.support(np.array([[1.0]]))[0] - exact.sum()
    assert -1e-12 <= excess <= around.excess[0] <= 1e-6


def double_integrator(gain):
    return np.array([[1.0, 1.0], [0.0, 1.0]]) + np.outer([0.5, 1.0], gain)


def test_the_double_integrator_under_deadbeat_control(scattered):
    # A_K is nilpotent: the set is W + A_K W, the sum of four segments
    A_K = double_integrator([-1.0, -1.5])
    assert np.allclose(A_K @ A_K, 0.0)
    around = whole(A_K, segments([1.0, 0.0], [0.0, 1.0], bound=0.3))
    for a in scattered(1, 50, np.ones(2)):
        assert around.support(a[None])[0] == pytest.approx(0.3 * (np.abs(a).sum() + np.abs(a @ A_K).sum()), rel=1e-6)


def test_the_double_integrator_with_two_real_poles():
    # poles p, q: the errors after an impulse through the input are alpha p^k + beta q^k; each part is summed in closed
    # form up to and from where the sign changes
    p, q = 0.8, 0.5
    gain = [-(1.0 - p) * (1.0 - q), -0.5 * (3.0 - p - q - p * q)]
    A_K, B = double_integrator(gain), np.array([0.5, 1.0])
    assert np.sort(np.linalg.eigvals(A_K)) == pytest.approx([q, p])
    around = whole(A_K, segments(B, bound=0.1))
    for a in np.eye(2):
        beta, alpha = np.linalg.solve([[1.0, 1.0], [q, p]], [a @ B, a @ A_K @ B])

        def tail(k, alpha=alpha, beta=beta):
            return alpha * p**k / (1.0 - p) + beta * q**k / (1.0 - q)

        change = np.log(-alpha / beta) / np.log(q / p) if alpha * beta < 0.0 else 0.0
        k = max(0, int(np.ceil(change)))
        assert around.support(a[None])[0] == pytest.approx(0.1 * (abs(tail(0) - tail(k)) + abs(tail(k))), rel=1e-6)


def test_an_independent_iteration_on_polygons_ends_in_the_same_set(scattered):
    A_K = np.array([[0.7, 0.4], [-0.3, 0.6]])
    source = segments([0.2, 0.1], [0.0, 0.3], bound=0.5)
    corners = 0.5 * np.array([[s * 0.2, s * 0.1 + t * 0.3] for s in (-1, 1) for t in (-1, 1)])
    polygon, image = corners, corners
    for _ in range(120):
        image = image @ A_K.T
        points = (polygon[:, None] + image[None]).reshape(-1, 2)
        polygon = points[ConvexHull(points, qhull_options="QJ1e-12").vertices]
    directions = scattered(2, 200, np.ones(2))
    assert whole(A_K, source).support(directions) == pytest.approx((polygon @ directions.T).max(axis=0), rel=1e-6)


def test_a_disturbance_without_interior_is_no_difficulty(scattered, boundary, furthest):
    # one segment in three dimensions: scaling the sum up could never make it invariant
    A = np.array([[0.9, 0.2, 0.0], [0.0, 0.8, 0.3], [-0.1, 0.0, 0.5]])
    around = whole(A, segments([0.0, 0.0, 1.0]))
    directions = scattered(3, 200, around.support(np.eye(3)))
    points = boundary(around, directions)
    after = points @ A.T + furthest(around.sources[0], directions)
    assert np.all(after @ directions.T <= around.support(directions) * (1.0 + 1e-9))


def test_more_terms_or_less_disturbance_never_make_the_set_larger(scattered):
    A = np.array([[0.95, 0.1], [0.0, 0.9]])
    one, two = whole(A, segments([0.0, 1.0])), whole(A, segments([0.0, 1.0]), segments([1.0, 0.0], bound=0.01))
    directions = scattered(4, 100, np.ones(2))
    assert np.all(one.support(directions) < two.support(directions))
    assert one.support(3.0 * directions) == pytest.approx(3.0 * one.support(directions))
    assert one.support(-directions) == pytest.approx(one.support(directions))


def test_along_a_coordinate_that_is_left_out_the_set_has_no_end():
    inner = InvariantSet.of(np.array([[0.5]]), [segments([1.0])], np.array([1]))
    support = inner.support(np.array([[0.0, 1.0], [1e-9, 1.0]]))
    assert support[0] == pytest.approx(2.0)
    assert np.isinf(support[1])

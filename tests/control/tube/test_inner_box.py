"""The box in a zonotope against closed forms and a brute-force search, and what may be chosen in a tube."""

from itertools import product

import numpy as np
import pytest
from scipy.optimize import linprog

from drawbar.control.settings import ArticulatedControllerSettings, BodyTubeSettings, Nominal, TubeSettings
from drawbar.control.tube.inner_box import initial_choice, inner_box
from drawbar.control.tube.tube import tubes_of
from drawbar.errors import ConfigurationError
from drawbar.vehicle.parameters import VehicleParameters


def is_sum(point, segments):
    """Tell whether a point is a sum of the segments, by a linear programme of its own."""
    return linprog(np.zeros(len(segments)), A_eq=segments.T, b_eq=point, bounds=(-1.0, 1.0)).success


def test_largest_box_in_simple_sets_is_that_of_the_closed_form():
    assert inner_box(np.diag([1.0, 2.0, 3.0]), np.array([1.0, 2.0, 3.0])) == pytest.approx([1.0, 2.0, 3.0])
    assert inner_box(np.diag([1.0, 2.0, 3.0]), np.ones(3)) == pytest.approx(np.ones(3))
    # a square on its tip, with half-diagonals of 2, and one segment alone, which holds no box
    assert inner_box(np.array([[1.0, 1.0], [1.0, -1.0]]), np.ones(2)) == pytest.approx([1.0, 1.0])
    assert inner_box(np.array([[1.0, 1.0]]), np.ones(2)) == pytest.approx([0.0, 0.0])


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_every_corner_of_the_box_is_inside_and_of_a_larger_one_some_corner_is_not(dimension):
    rng = np.random.default_rng(dimension)
    for _ in range(5):
        segments, shape = rng.normal(size=(6, dimension)), rng.uniform(0.2, 1.0, dimension)
        box = inner_box(segments, shape)
        assert box / shape == pytest.approx(np.full(dimension, box[0] / shape[0]))
        corners = np.array(list(product((-1.0, 1.0), repeat=dimension))) * box
        assert all(is_sum(0.9999 * corner, segments) for corner in corners)
        assert not all(is_sum(1.0001 * corner, segments) for corner in corners)


def tube(nominal, **declared):
    tractor = BodyTubeSettings(lqr={"lateral": 1.0, "yaw": 1.0, "command": 5.0}, **declared)
    settings = TubeSettings(nominal=nominal, tractor=tractor)
    product_ = ArticulatedControllerSettings(model="articulated")
    return tubes_of(VehicleParameters(), product_, settings, speed=1.0, sample_time=0.2).tractor


def test_what_is_chosen_leaves_room_for_the_error_of_the_estimate():
    errors = {"lateral": 0.001, "yaw": 0.0005, "steering": 0.0005}
    chosen_from = tube(
        Nominal.OPTIMISED, disturbances={"tractor_crab": 0.005, "steering_offset": 0.01}, estimation=errors
    )
    choice = initial_choice(chosen_from)
    assert (choice > 0.0).all()
    corners = np.array(list(product((-1.0, 1.0), repeat=3))) * choice
    estimates = np.array(list(product((-1.0, 1.0), repeat=3))) * chosen_from.estimation
    directions = np.random.default_rng(5).normal(size=(2000, 3))
    extent = chosen_from.support(directions)
    for corner, error in product(corners, estimates):
        assert (directions @ (corner - error) <= extent).all()  # x - x̄ in Z


def test_without_a_set_there_is_nothing_to_choose_from():
    with pytest.raises(ConfigurationError, match="needs declared"):
        initial_choice(tube(Nominal.OPTIMISED))

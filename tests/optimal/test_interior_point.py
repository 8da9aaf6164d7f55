"""Where the interior point starts, and where it starts anew: problems that it gave up once."""

from itertools import product

import numpy as np
import pytest

from drawbar.benchmark.hostile.collection import hostile_problem
from drawbar.benchmark.hostile.solvers import drawbar
from drawbar.benchmark.hostile.verdict import Verdict, judge
from drawbar.geometry import Floats
from drawbar.optimal.quadratic_program import QuadraticProgram, Sizes
from drawbar.signals import SolverStatus

STEADY = Sizes(stages=25, states=3, inputs=1, bounds=100, free_initial=False)
DELAY = Sizes(stages=20, states=4, inputs=2, bounds=120, free_initial=False)
FREE = Sizes(stages=15, states=3, inputs=2, bounds=78, free_initial=True)


def bounded(sizes: Sizes, state: float, force: float) -> QuadraticProgram:
    """Return a program with every state but a given first one within +-state and every input within +-force."""
    program = QuadraticProgram(sizes)
    states = (sizes.stages + 1) * sizes.states
    first = 0 if sizes.free_initial else sizes.states
    program.array("bound")[:] = np.arange(first, states + sizes.stages * sizes.inputs)
    limits = np.where(program.array("bound") < states, state, force)
    program.array("lower")[:], program.array("upper")[:] = -limits, limits
    return program


@pytest.mark.parametrize(
    ("price", "start", "effect"), list(product((100.0, 1e3, 1e4), (2.0, 4.0, 8.0, 16.0), (0.1, 0.01, 0.001)))
)
def test_dear_soft_bounds_that_must_give_way(price: float, start: float, effect: float) -> None:
    """The cost without bounds has curvatures of 1e-3, the multipliers reach the price: steps were of 1e-5."""
    program = bounded(STEADY, state=0.4, force=6.4)
    program.array("Q")[:] = np.diag([0.0, 1e-3, 0.0])
    program.array("R")[:] = 5.0
    program.array("A")[:] = np.eye(3) + 0.01 * np.array([[0.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.0, -1.0, 0.0]])
    program.array("B")[:] = effect * np.array([[-0.3], [-1.0], [1.0]])
    program.array("initial")[:] = start * np.array([1.0, -0.5, 0.3])
    program.array("soft_linear")[:], program.array("soft_quadratic")[:] = price, 10.0
    assert program.solve() == SolverStatus.SOLVED


@pytest.mark.parametrize("start", [1.0, 10.0])
def test_variables_that_nothing_moves_start_as_far_inside_as_there_is_room(start: float) -> None:
    """The second input does nothing and stays at zero; its bounds began with distances of 1e-12."""
    program = bounded(DELAY, state=0.5, force=0.8)
    program.array("Q")[:], program.array("R")[:] = np.eye(4), np.eye(2)
    program.array("A")[:] = np.diag(np.ones(3), 1)
    program.array("B")[:, 3, 0] = 1.0
    program.array("g")[:84] = np.tile([1.0, -2.0, 0.0, 3.0], 21)
    program.array("initial")[:] = start * np.array([1.0, -0.5, 0.3, 0.7])
    program.array("soft_linear")[:], program.array("soft_quadratic")[:] = 0.0, 300.0
    end = slice(76, 80)
    program.array("lower")[end] = program.array("upper")[end] = 0.3, -0.1, 0.2, 0.05
    program.array("soft_linear")[end], program.array("soft_quadratic")[end] = np.inf, 0.0
    assert program.solve() == SolverStatus.SOLVED


def test_free_first_state_that_costs_nothing() -> None:
    """Any first state within its bounds is a solution, and the cost is zero."""
    program = bounded(FREE, state=1.0, force=2.0)
    program.array("R")[:] = np.eye(2)
    program.array("A")[:] = 0.5 * np.eye(3)
    program.array("B")[:] = 0.1
    assert program.solve() == SolverStatus.SOLVED
    inputs: Floats = program.array("z")[48:]
    np.testing.assert_array_equal(inputs, 0.0)


@pytest.mark.parametrize("number", [331, 783, 1121])
def test_a_flat_cost_is_drawn_to_its_bounds_no_harder_than_it_takes(number: int) -> None:
    """Drawn in by as much as its minimum was far out, it began with multipliers of 1e20."""
    truth = hostile_problem("drawn", number)
    assert judge(truth, drawbar(truth.problem)) == Verdict.SOLVED


@pytest.mark.parametrize("number", [190, 302, 562])
def test_primal_regularisation_gives_way_to_what_the_cost_hardly_determines(number: int) -> None:
    """A curvature of 1e-9 beside a regularisation of 1e-8: each iteration left nine tenths of the residual."""
    truth = hostile_problem("drawn", number)
    assert judge(truth, drawbar(truth.problem)) == Verdict.SOLVED

"""Warm start with the active bounds of the problem before (pn_warm_start.h): same solution, no pass where they stay."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from drawbar.optimal import ControlSolver
from drawbar.signals import SolverStatus

NAMES = ["articulated_trailer", "articulated_centralised", "tricycle_trailer", "tricycle_centralised"]
SAMPLES, SEED = 25, 11
EXACT = {"rtol": 0, "atol": 1e-11}


def bounded(case: Any, share: float) -> ControlSolver:
    """Return the case's solver with only so much left of its bounds."""
    solver = case.solver()
    for name, bound in case.problem.bounds.items():
        solver.lower[name][:], solver.upper[name][:] = share * bound.lower, share * bound.upper
    return solver


def driven(solver: ControlSolver, kept: Any) -> Iterator[int]:
    """Follow the plans with noise, and yield the passes of every sample; `kept` gets the kept bounds before it."""
    rng = np.random.default_rng(SEED)
    solver.start()
    assert solver.feedback() == SolverStatus.SOLVED
    for _ in range(SAMPLES):
        solver.initial[:] = solver.x[1] + 0.002 * rng.standard_normal(len(solver.initial))
        solver.shift()
        kept(solver.workspace.array("qp.kept"))
        solver.prepare()
        assert solver.feedback() == SolverStatus.SOLVED
        yield solver.iterations


def left(_: Any) -> None:
    """Leave the kept bounds as they are."""


def forgotten(kept: Any) -> None:
    kept[:] = 0


@pytest.mark.parametrize("share", [1.0, 0.3, 0.1])
@pytest.mark.parametrize("name", NAMES)
def test_bounds_that_are_kept_lead_to_the_same_solution(name: str, share: float, named: Any) -> None:
    again, afresh = bounded(named(name), share), bounded(named(name), share)
    active = 0
    for _, passes in zip(driven(again, left), driven(afresh, forgotten), strict=True):
        active += passes > 0
        np.testing.assert_allclose(again.x, afresh.x, **EXACT)
        np.testing.assert_allclose(again.u, afresh.u, **EXACT)
    assert active > SAMPLES / 2


@pytest.mark.parametrize("name", ["articulated_trailer", "tricycle_trailer"])
def test_bounds_that_stay_active_cost_two_sweeps(name: str, named: Any) -> None:
    assert list(driven(bounded(named(name), 0.1), left)) == [1] * SAMPLES


@pytest.mark.parametrize("name", NAMES)
def test_whatever_is_kept_the_solution_is_the_same(name: str, named: Any) -> None:
    rng, arbitrary, afresh = np.random.default_rng(SEED), named(name).solver(), named(name).solver()
    states = arbitrary.workspace.array("x").shape[1]

    def drawn(kept: Any) -> None:
        """Mix nothing, any state and the inputs' own bounds at either side, and one that there is not."""
        kept[:] = rng.integers(-(states + 2), states + 3, kept.shape) * (rng.random(kept.shape) < 0.7)

    for _ in zip(driven(arbitrary, drawn), driven(afresh, forgotten), strict=True):
        np.testing.assert_allclose(arbitrary.x, afresh.x, **EXACT)
        np.testing.assert_allclose(arbitrary.u, afresh.u, **EXACT)


def test_kept_bounds_move_on_with_the_trajectory(named: Any) -> None:
    solver = named("articulated_centralised").solver()
    solver.start()
    kept = solver.workspace.array("qp.kept")
    kept[:] = np.arange(kept.size).reshape(kept.shape)
    before = kept.copy()
    solver.shift()
    np.testing.assert_array_equal(kept, np.vstack([before[1:], before[-1:]]))


def test_a_new_start_keeps_nothing(named: Any) -> None:
    solver = bounded(named("articulated_trailer"), 0.3)
    assert list(driven(solver, left))[-1] > 0
    assert solver.workspace.array("qp.kept").any()
    solver.start()
    assert not solver.workspace.array("qp.kept").any()

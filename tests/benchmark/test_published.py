"""The published problems of model predictive control: made, read, solved, and judged without a solver's own word."""

import io
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
import qpsolvers
from rich.console import Console

from drawbar.benchmark.hostile.solvers import SOLVERS
from drawbar.benchmark.hostile.verdict import Verdict
from drawbar.benchmark.published import quadruped
from drawbar.benchmark.published.families import Published, balancing, walking
from drawbar.benchmark.published.files import problems_in, read_problem
from drawbar.benchmark.published.results import compare, cost, published_table, stationarity
from drawbar.errors import SolverError
from drawbar.optimal.stage_problem import StageProblem

FAMILIES = {
    "LIPMWALK": lambda: islice(walking(), 0, 4, 3),
    "WHLIPBAL": lambda: islice(balancing(), 12),
    "QUADCMPC": lambda: islice(quadruped.problems(), 2, 4),
}
"""some problems of each, of few structures"""


def condensed(problem: StageProblem) -> qpsolvers.Problem:
    """Return the program of the inputs alone, as the benchmark's files hold it."""
    T, t = problem.reach()
    G = np.vstack([T[problem.bound], -T[problem.bound]])
    h = np.concatenate([problem.upper - t[problem.bound], t[problem.bound] - problem.lower])
    some = np.isfinite(h)
    H = problem.hessian()
    return qpsolvers.Problem(T.T @ H @ T, T.T @ (H @ t + problem.g), G[some], h[some])


@pytest.mark.parametrize("family", FAMILIES)
def test_all_are_solved(family: str) -> None:
    for number, problem in enumerate(FAMILIES[family]()):
        found = compare(Published(name=f"{family}{number}", family=family, problem=problem), ["drawbar", "clarabel"])
        assert found.verdicts == {"drawbar": Verdict.SOLVED, "clarabel": Verdict.SOLVED}
        assert found.optimality is not None
        assert found.optimality < 1e-9


def test_bounds_are_in_the_way_of_some() -> None:
    for problem in (next(walking()), next(quadruped.problems())):
        z = SOLVERS["clarabel"](problem).z
        assert z is not None
        inside = np.minimum(z[problem.bound] - problem.lower, problem.upper - z[problem.bound])
        assert (inside < 1e-6).any()


def test_a_point_beside_the_optimum_is_not_stationary() -> None:
    problem = next(walking())
    z = SOLVERS["clarabel"](problem).z
    assert z is not None
    T, t = problem.reach()
    u = problem.split(z)[1].ravel()
    assert stationarity(problem, T @ u + t) < 1e-7
    assert stationarity(problem, T @ (u + 0.1) + t) > 1e-4


def test_a_file_is_the_problem_it_was_saved_from(tmp_path: Path) -> None:
    problem = next(walking())
    condensed(problem).save(str(tmp_path / "WALK7.npz"))
    (found,) = problems_in(tmp_path)
    assert (found.name, found.family) == ("WALK7", "WALK")
    own, read = SOLVERS["drawbar"](problem).z, SOLVERS["drawbar"](found.problem).z
    assert own is not None
    assert read is not None
    np.testing.assert_allclose(problem.split(own)[1][:, 0], found.problem.split(read)[1][0], atol=1e-7)


@pytest.mark.parametrize(("most", "left"), [(1.5, 0.0), (10.0, 7.5)])
def test_equations_and_fixed_variables_are_eliminated(tmp_path: Path, most: float, left: float) -> None:
    wide = np.full(3, np.inf)
    saved = qpsolvers.Problem(
        np.eye(3),
        np.array([-3.0, 0.0, -5.0]),
        G=np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
        h=np.array([most, 1.0]),
        A=np.array([[1.0, 1.0, 0.0]]),
        b=np.array([2.0]),
        lb=np.array([-np.inf, -np.inf, 1.0]),
        ub=np.array([*wide[:2], 1.0]),
    )
    saved.save(str(tmp_path / "one.npz"))
    problem = read_problem(tmp_path / "one.npz")
    assert (problem.sizes.inputs, problem.sizes.states) == (1, 1)
    z = SOLVERS["drawbar"](problem).z
    assert z is not None
    assert problem.upper[0] - z[problem.bound[0]] == pytest.approx(left, abs=1e-8)


@pytest.mark.parametrize(("A", "least"), [(np.ones((2, 2)), -9.0), (np.eye(2), 5.0)])
def test_a_file_without_any_point_is_refused(tmp_path: Path, A: np.ndarray, least: float) -> None:
    box = {"lb": np.full(2, least), "ub": np.full(2, 9.0)}
    qpsolvers.Problem(np.eye(2), np.zeros(2), A=A, b=np.array([1.0, 2.0]), **box).save(str(tmp_path / "one.npz"))
    with pytest.raises(SolverError, match="no point"):
        read_problem(tmp_path / "one.npz")


def test_an_empty_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SolverError, match="holds no"):
        list(problems_in(tmp_path))


def test_the_table_counts_what_each_solver_solved() -> None:
    problem = next(walking())
    found = compare(Published(name="LIPMWALK0", family="LIPMWALK", problem=problem), ["drawbar", "daqp"])
    console = Console(file=io.StringIO(), width=120)
    console.print(published_table([found]))
    assert isinstance(console.file, io.StringIO)
    assert console.file.getvalue().splitlines()[-1].split()[:7] == ["LIPMWALK", "1", "16", "3", "1", "1", "1"]
    z = found.answers["drawbar"].z
    assert z is not None
    assert cost(problem, z) == pytest.approx(0.0801947633)

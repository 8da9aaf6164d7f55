"""What a solver refuses instead of failing silently, and bounds that change from stage to stage."""

import re
from typing import Any

import casadi as ca
import numpy as np
import pytest

from drawbar.errors import SolverError
from drawbar.optimal import Bound, ControlProblem, ControlSolver, EstimationProblem, EstimationSolver
from drawbar.optimal.quadratic_program import QuadraticProgram, Sizes
from drawbar.signals import SolverStatus
from drawbar.vehicle.model import Model, declare, variables

N, LIMIT = 6, 0.5
PRIOR = np.array([0.0, 1.0, 0.1])


def cart() -> Model:
    """Return a cart on a line with a constant drag, its position and acceleration as outputs."""

    def equations(x: Any, u: Any, p: Any) -> tuple[Any, Any]:
        return ca.vertcat(x[1], u + p), ca.vertcat(x[0], u)

    return declare(
        "cart",
        states=variables(position="m", speed="m/s"),
        inputs=variables(acceleration="m/s²"),
        parameters=variables(drag="m/s²"),
        outputs=variables(position="m", acceleration="m/s²"),
        equations=equations,
    )


def controller(**changes: Any) -> ControlSolver:
    whole: dict[str, Any] = {
        "model": cart(),
        "horizon": N,
        "sample_time": 0.5,
        "weights": {"position": 1.0, "acceleration": 1e-3},
        "terminal_weights": {"position": 1.0},
        "bounds": {"acceleration": Bound(lower=-LIMIT, upper=LIMIT), "speed": Bound(lower=-9.0, upper=9.0)},
    }
    return ControlSolver(ControlProblem(**(whole | changes)))


def estimator(prior: Any = PRIOR) -> EstimationSolver:
    problem = EstimationProblem(
        model=cart(),
        horizon=N,
        sample_time=0.5,
        weights={"position": 1.0, "acceleration": 1.0},
        prior_deviation={"position": 1.0, "speed": 1.0, "drag": 0.5},
        process_deviation={"position": 0.0, "speed": 0.1, "drag": 0.0},
        bounds={
            "speed": Bound(lower=-1.0, upper=1.0),
            "drag": Bound(lower=-2.0, upper=2.0),
            "acceleration": Bound(lower=-3.0, upper=3.0),
        },
    )
    return EstimationSolver(problem, prior)


@pytest.mark.parametrize(
    "name", ["x", "u", "y", "w", "p", "initial", "before", "initial_lower", "initial_upper", "defects"]
)
def test_another_array_under_a_name_of_the_solvers_is_refused(name: str) -> None:
    solver = controller()
    own = getattr(solver, name)
    with pytest.raises(SolverError, match=re.escape(f"write into its own: {name}[...] = ...")):
        setattr(solver, name, own.copy())
    assert getattr(solver, name) is own


def test_writing_in_place_is_allowed() -> None:
    solver = controller()
    solver.y[...] = 1.0
    solver.y += 1.0
    assert (solver.workspace.array("y") == 2.0).all()


@pytest.mark.parametrize("phase", ["feedback", "shift", "advance", "solve", "residuals"])
def test_a_phase_before_start_is_refused(phase: str) -> None:
    with pytest.raises(SolverError, match=re.escape("call start() before the first feedback(), advance() or solve()")):
        getattr(controller(), phase)()


def test_after_start_the_phases_are_the_c_functions_alone() -> None:
    solver = controller()
    solver.start()
    bound = type(solver.workspace.function("prepare"))
    assert all(type(phase) is bound for phase in (solver.prepare, solver.feedback, solver.shift))
    assert solver.feedback() == SolverStatus.SOLVED


def test_a_trajectory_of_ones_own_may_be_prepared_instead() -> None:
    solver = controller()
    solver.x[...], solver.u[...] = 0.25, 0.0
    assert solver.prepare() == SolverStatus.SOLVED
    assert solver.feedback() == SolverStatus.SOLVED


@pytest.mark.parametrize("value", [np.nan, 1e300])
@pytest.mark.parametrize("name", ["initial", "p"])
def test_start_needs_finite_numbers(name: str, value: float) -> None:
    solver = controller()
    getattr(solver, name).flat[0] = value
    with pytest.raises(SolverError, match=re.escape(f"start() needs {name} written, which must be ")):
        solver.start()


@pytest.mark.parametrize("wrong", ["rest", [[0.0], [0.0, 1.0]], np.zeros(3), np.full((N + 1, 2), 1e300), {}])
def test_a_start_that_is_no_trajectory_is_refused_and_writes_nothing(wrong: Any) -> None:
    solver = controller()
    with pytest.raises(SolverError, match=re.escape(f"start(): x must be an array ({N + 1}, 2) of finite numbers")):
        solver.start(x=wrong)
    with pytest.raises(SolverError, match=re.escape(f"start(): u must be an array ({N}, 1) of finite numbers")):
        solver.start(x=np.ones((N + 1, 2)), u=wrong)
    assert not solver.x.any()


@pytest.mark.parametrize("value", [1.1e12, 1e300, np.inf, -np.inf])
def test_a_measurement_beyond_all_numbers_is_refused_and_then_missing(value: float) -> None:
    prior = np.array([0.0, 0.5, 0.0])
    solver, masked = estimator(prior), estimator(prior)
    for sample in range(3 * N):
        for each, wrong in ((solver, value), (masked, np.nan)):
            each.y[each.newest] = (wrong if sample == N + 1 else 0.25 * sample, 0.0)
            before = each.x.copy()
            status = each.feedback()
            if each is solver and sample == N + 1:
                assert status == SolverStatus.BAD_INPUT
                np.testing.assert_array_equal(each.x, before)
            else:
                assert status == SolverStatus.SOLVED
            assert each.advance() == SolverStatus.SOLVED
    np.testing.assert_allclose(solver.x, masked.x, rtol=0.0, atol=1e-6)


@pytest.mark.parametrize("name", ["y", "p", "initial"])
def test_what_a_controller_cannot_compute_with_is_refused_and_leaves_nothing_behind(name: str) -> None:
    solver = controller()
    solver.start()
    assert solver.feedback() == SolverStatus.SOLVED
    plan = solver.x.copy()
    array = getattr(solver, name)
    array.flat[-1] = 1e300
    assert solver.feedback() == SolverStatus.BAD_INPUT
    np.testing.assert_array_equal(solver.x, plan)
    array.flat[-1] = 0.0
    assert solver.prepare() == solver.feedback() == SolverStatus.SOLVED


def test_bounds_of_every_stage_are_written_by_name() -> None:
    solver = controller()
    assert {name: array.shape for name, array in solver.lower.items()} == {"speed": (N,), "acceleration": (N,)}
    assert (solver.lower["acceleration"] == -LIMIT).all()
    solver.upper["acceleration"][2:] = 0.25
    solver.upper["speed"][:1] = 0.1
    solver.start()
    solver.y[...] = 100.0
    for _ in range(5):
        solver.prepare()
        assert solver.feedback() == SolverStatus.SOLVED
    assert solver.x[1, 1] == pytest.approx(0.1, abs=1e-6)
    np.testing.assert_allclose(solver.u[1:, 0], [LIMIT, *(N - 2) * [0.25]], atol=1e-6)


def test_bounds_beside_a_free_first_state() -> None:
    solver = controller(initial_weights={"position": 1.0, "speed": 1.0})
    solver.initial_upper[...] = 7.0
    assert (solver.upper["speed"] == 9.0).all()
    assert (solver.upper["acceleration"] == LIMIT).all()


def test_bounds_of_an_estimator() -> None:
    solver = estimator()
    shapes = {name: array.shape for name, array in solver.upper.items()}
    assert shapes == {"speed": (N + 1,), "drag": (1,), "acceleration": (N,)}
    assert {name: array[-1] for name, array in solver.upper.items()} == {"speed": 1, "drag": 2, "acceleration": 3}


def test_bounds_that_were_not_declared_are_reported() -> None:
    with pytest.raises(SolverError, match="No bound on 'position' was declared; there are speed, acceleration"):
        controller().lower["position"]


def test_another_array_for_a_bound_is_refused() -> None:
    with pytest.raises(SolverError, match=re.escape("['speed'][...] = ...")):
        controller().lower["speed"] = np.zeros(N)


@pytest.mark.parametrize(
    ("prior", "complaint"),
    [
        (None, "An estimator needs a prior: a first guess of position, speed, drag"),
        (np.zeros(2), "The prior must be 3 finite numbers within ±1e+12, position, speed, drag; got [0.0, 0.0]"),
        (np.zeros((3, 1)), "The prior must be 3 finite numbers"),
        (np.array([0.0, np.nan, 0.0]), "The prior must be 3 finite numbers"),
        (np.array([0.0, 1e300, 0.0]), "The prior must be 3 finite numbers within ±1e+12"),
        ("still", "got 'still'"),
        ([0.0, [1.0], 2.0], "got [0.0, [1.0], 2.0]"),
        ({"position": 0.0}, "got {'position': 0.0}"),
    ],
)
def test_a_prior_that_is_none_is_refused(prior: Any, complaint: str) -> None:
    with pytest.raises(SolverError, match=re.escape(complaint)):
        estimator(prior)


def test_a_prior_of_another_size_is_refused_at_a_restart() -> None:
    with pytest.raises(SolverError, match="The prior must be 3 finite numbers"):
        estimator().restart(np.zeros(2))


@pytest.mark.parametrize("name", ["prior", "root"])
def test_a_prior_is_not_written_without_its_root(name: str) -> None:
    with pytest.raises(ValueError, match="read-only"):
        getattr(estimator(), name)[...] = 0.0


def test_an_arrival_cost_of_ones_own() -> None:
    solver, root = estimator(), np.diag([1e3, 1e3, 1e3])
    prior = np.array([5.0, 0.5, 0.0])
    assert solver.set_arrival_cost(prior, root) == SolverStatus.SOLVED
    assert solver.feedback() == SolverStatus.SOLVED
    np.testing.assert_allclose(solver.x[0], prior, atol=1e-6)
    np.testing.assert_array_equal(solver.root, root)


@pytest.mark.parametrize(
    ("root", "complaint"),
    [
        (np.zeros((2, 2)), "root must be an array (3, 3) of finite numbers"),
        (np.full((3, 3), np.nan), "root must be an array (3, 3) of finite numbers"),
        ("round", "upper triangular; got 'round'"),
        (np.tril(np.ones((3, 3))), "root must be upper triangular"),
    ],
)
def test_a_root_that_is_none_is_refused(root: Any, complaint: str) -> None:
    with pytest.raises(SolverError, match=re.escape(complaint)):
        estimator().set_arrival_cost(PRIOR, root)


def test_a_quadratic_program_has_no_bounds_until_they_are_written() -> None:
    program = QuadraticProgram(Sizes(stages=2, states=1, inputs=1, bounds=3, free_initial=False))
    program.array("A")[...], program.array("B")[...] = 1.0, 1.0
    program.array("R")[...], program.array("g")[...] = 1.0, -5.0
    program.array("bound")[...] = (3, 4, 1)
    assert program.solve() == SolverStatus.SOLVED
    assert program.array("z")[3] > 5.0
    program.array("upper")[0] = 1.0
    assert program.solve() == SolverStatus.SOLVED
    assert program.array("z")[3] == pytest.approx(1.0)


def test_a_quadratic_program_tells_its_arrays() -> None:
    program = QuadraticProgram(Sizes(stages=2, states=1, inputs=1, bounds=3, free_initial=False))
    with pytest.raises(SolverError, match="There is no array 'lowr'; there are Q, "):
        program.array("lowr")


@pytest.mark.parametrize("wrong", [{"stages": 0}, {"states": 0}, {"inputs": 0}, {"bounds": -1}])
def test_sizes_that_are_none_are_refused(wrong: dict[str, int]) -> None:
    with pytest.raises(SolverError, match="at least one stage, state and input"):
        Sizes(**{"stages": 2, "states": 1, "inputs": 1, "bounds": 0, "free_initial": False, **wrong})


def test_bounds_cannot_be_replaced_by_update_or_as_a_whole() -> None:
    solver = controller()
    with pytest.raises(SolverError, match="one bound after the other"):
        solver.lower.update(acceleration=np.zeros(N))
    with pytest.raises(SolverError, match=r"lower = \.\.\. would bind"):
        solver.lower = {}  # type: ignore[assignment]


def test_a_problem_of_another_kind_is_refused() -> None:
    control, estimation = controller().problem, estimator().problem
    with pytest.raises(SolverError, match="must be of type ControlProblem for this solver, got EstimationProblem"):
        ControlSolver(estimation)  # type: ignore[arg-type]
    with pytest.raises(SolverError, match="must be of type EstimationProblem for this solver, got ControlProblem"):
        EstimationSolver(control, PRIOR)  # type: ignore[arg-type]

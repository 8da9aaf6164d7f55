"""Bounds on outputs and changes of inputs, weights of changes, weights and bounds of stages: IPOPT's solution.

IPOPT is given the problem as its user means it, with the constraints as such, the change as a difference, and one input
for all shooting intervals of a sample.
"""

from typing import Any

import casadi as ca
import numpy as np
import pytest

from drawbar.errors import SolverError
from drawbar.geometry import Floats
from drawbar.optimal import Bound, ControlProblem, ControlSolver, Solution
from drawbar.signals import SolverStatus
from drawbar.vehicle.integrators import integrate
from drawbar.vehicle.model import Model, declare, variables

N, SAMPLE = 12, 0.3
START, BEFORE = np.array([0.0, 0.2, 0.0, 2.0]), 0.1
LATERAL, CHANGE, FAST, PUSH = 0.5, 0.09, 2.4, 0.3
NEAR = 1.0
"""m², least square of the distance from an obstacle"""
PASSED = {1: 0.977, 3: 0.994}
"""m, least distance from it between the nodes, by intervals in a sample: as the tutorial says"""
WEIGHTS = {"x": 0.1, "y": 0.5, "speed": 1.0, "push": 0.3, "lateral": 0.0, "clearance": 0.0}
CHANGES = {"steering": 3.0}
SOFT = Bound(lower=-LATERAL, upper=LATERAL, linear_penalty=0.05, quadratic_penalty=1.0)


def car() -> Model:
    """Return a car with a lateral acceleration, and the square of its distance from a moving obstacle."""

    def equations(x: Any, u: Any, p: Any) -> tuple[Any, Any]:
        turn = x[3] * ca.tan(u[1]) / 1.5
        moved = ca.vertcat(x[3] * ca.cos(x[2]), x[3] * ca.sin(x[2]), turn, u[0])
        clearance = ca.sumsqr(x[:2] - p)
        return moved, ca.vertcat(x[0], x[1], x[3], u[0], x[3] * turn, clearance)

    return declare(
        "car",
        states=variables(x="m", y="m", yaw="rad", speed="m/s"),
        inputs=variables(push="m/s²", steering="rad"),
        parameters=variables(obstacle_x="m", obstacle_y="m"),
        outputs=variables(x="m", y="m", speed="m/s", push="m/s²", lateral="m/s²", clearance="m²"),
        equations=equations,
    )


def problem(**changes: Any) -> ControlProblem:
    whole: dict[str, Any] = {
        "model": car(),
        "horizon": N,
        "sample_time": SAMPLE,
        "weights": WEIGHTS,
        "terminal_weights": {"x": 0.1, "y": 0.5, "speed": 1.0, "clearance": 0.0},
        "bounds": {
            "speed": Bound(lower=0.0, upper=FAST),
            "push": Bound(lower=-1.0, upper=PUSH),
            "lateral": SOFT,
            "clearance": Bound(lower=NEAR, upper=np.inf),
        },
        "change_weights": CHANGES,
        "change_bounds": {"steering": Bound(lower=-CHANGE, upper=CHANGE)},
    }
    return ControlProblem(**(whole | changes))


@pytest.fixture(scope="module", params=[1, 3], ids="{} intervals per sample".format)
def solver(request: pytest.FixtureRequest) -> ControlSolver:
    """Return a solver with data in which every kind of constraint is in the way at some stage."""
    solver = ControlSolver(problem(intervals_per_sample=request.param))
    along = SAMPLE / request.param * np.arange(N * request.param + 1)
    solver.initial[:], solver.before[:] = START, BEFORE
    solver.p[:] = np.column_stack([4.0 - 0.1 * along, -0.5 + 0.05 * along])
    solver.y[:] = 0.0
    solver.y[:, 0], solver.y[:, 2] = 2.3 * along, 2.3
    solver.w[3 * request.param, 1], solver.upper["speed"][5 * request.param : 8 * request.param] = 20.0, 2.1
    solver.upper["push"][8] = 0.25
    straight = np.column_stack([2.0 * along, *np.tile(START[1:, None], len(along))])
    solver.start(x=straight, u=np.tile([0.0, 0.05], (N, 1)))
    return solver


@pytest.fixture(scope="module")
def found(solver: ControlSolver) -> Solution:
    """Return what the solver finds from its start."""
    return solver.solve(tolerance=1e-9, most=100)


def reference(solver: ControlSolver) -> tuple[Floats, Floats]:
    """Return IPOPT's x (N+1, nx) and u (N, nu), started where the solver is."""
    model, held = solver.problem.model, solver.problem.intervals_per_sample
    last = N * held
    step = ca.Function("F", [model.x, model.u, model.p], [integrate(model, SAMPLE / held)])
    output = ca.Function("h", [model.x, model.u, model.p], [model.output])
    opti = ca.Opti()
    x, u, slack = opti.variable(4, last + 1), opti.variable(2, N), opti.variable(last)
    cost, before = 0.0, BEFORE
    opti.subject_to(x[:, 0] == START)
    for k in range(last + 1):
        n = min(k, last - 1) // held
        h = output(x[:, k], u[:, n], solver.p[k])
        weights = solver.w[k] if k < last else np.where(np.isin(np.arange(6), [3, 4]), 0.0, solver.w[k])
        cost += 0.5 * sum(float(w) * (h[i] - float(solver.y[k, i])) ** 2 for i, w in enumerate(weights) if w)
        if k > 0:
            opti.subject_to(opti.bounded(0.0, x[3, k], float(solver.upper["speed"][k - 1])))
            opti.subject_to(h[5] >= NEAR)
        if k < last:
            opti.subject_to(x[:, k + 1] == step(x[:, k], u[:, n], solver.p[k]))
            opti.subject_to(opti.bounded(-LATERAL - slack[k], h[4], LATERAL + slack[k]))
            opti.subject_to(slack[k] >= 0.0)
            cost += SOFT.linear_penalty * slack[k] + 0.5 * SOFT.quadratic_penalty * slack[k] ** 2
        if k < last and k % held == 0:
            change = u[1, n] - before
            opti.subject_to(opti.bounded(-CHANGE, change, CHANGE))
            opti.subject_to(opti.bounded(-1.0, u[0, n], float(solver.upper["push"][n])))
            cost += 0.5 * CHANGES["steering"] * change**2
            before = u[1, n]
    opti.minimize(cost)
    quiet = {"print_level": 0, "sb": "yes", "tol": 1e-11, "bound_relax_factor": 0.0}
    opti.solver("ipopt", {"print_time": False}, quiet)
    opti.set_initial(x, solver.x.T)
    opti.set_initial(u, solver.u.T)
    solution = opti.solve()
    return np.array(solution.value(x)).T, np.array(solution.value(u)).T


def test_the_solution_is_that_of_ipopt(solver: ControlSolver, found: Solution) -> None:
    assert found.solved
    assert found.status == SolverStatus.SOLVED
    x, u = reference(solver)
    np.testing.assert_allclose(found.x, x, rtol=0, atol=1e-6)
    np.testing.assert_allclose(found.u, u, rtol=0, atol=1e-6)


def test_every_constraint_is_in_the_way_and_kept(solver: ControlSolver, found: Solution) -> None:
    held = solver.problem.intervals_per_sample
    change = np.diff(found.u[:, 1], prepend=BEFORE)
    lateral = found.x[:-1, 3] ** 2 * np.tan(np.repeat(found.u[:, 1], held)) / 1.5
    clearance = ((found.x[1:, :2] - solver.p[1:]) ** 2).sum(axis=1)
    speed = found.x[1:, 3]
    assert np.abs(change).max() == pytest.approx(CHANGE, abs=1e-7)
    assert clearance.min() == pytest.approx(NEAR, abs=1e-7)
    assert held == 1 or np.isclose(clearance, NEAR, atol=1e-7)[16], "at node 17, within a sample"
    assert np.abs(lateral).max() > LATERAL + 1e-3, "the soft bound gives way"
    assert np.isclose(np.abs(lateral), LATERAL, atol=1e-7).any(), "and holds elsewhere"
    assert speed[5 * held : 8 * held].max() == pytest.approx(2.1, abs=1e-7)
    assert (speed <= FAST + 1e-7).all()
    np.testing.assert_allclose(found.u[[0, 8], 0], [PUSH, 0.25], atol=1e-7)


def test_bounds_of_inputs_and_changes_are_one_a_sample(solver: ControlSolver) -> None:
    nodes = N * solver.problem.intervals_per_sample
    sizes = {"speed": nodes, "lateral": nodes, "clearance": nodes, "push": N, "steering_change": N}
    assert {name: len(bounds) for name, bounds in solver.lower.items()} == sizes


def test_nodes_within_a_sample_keep_the_bound_between_samples(solver: ControlSolver, found: Solution) -> None:
    model, held, parts = solver.problem.model, solver.problem.intervals_per_sample, 20
    step = ca.Function("F", [model.x, model.u, model.p], [integrate(model, SAMPLE / held / parts)])
    along = step.mapaccum(parts).map(N * held)
    inputs = np.repeat(found.u, held, axis=0)
    x = np.array(along(found.x[:-1].T, np.repeat(inputs, parts, axis=0).T, np.repeat(solver.p[:-1], parts, axis=0).T))
    obstacle = np.linspace(solver.p[0], solver.p[-1], N * held * parts + 1)[1:]
    assert np.hypot(*(x[:2].T - obstacle).T).min() == pytest.approx(PASSED[held], abs=5e-4)


def test_residuals_see_what_is_wrong(solver: ControlSolver, found: Solution) -> None:
    assert found.residuals.largest <= 1e-9
    limited = 6 * solver.problem.intervals_per_sample
    for name, disturb in (
        ("defect", lambda: solver.x.__setitem__((4, 0), found.x[4, 0] + 0.01)),
        ("violation", lambda: solver.x.__setitem__((limited, 3), 2.11)),
        ("stationarity", lambda: solver.y.__setitem__((5, 1), 0.01)),
        ("complementarity", lambda: solver.lower["clearance"].__isub__(0.01)),
    ):
        kept = {each: getattr(solver, each).copy() for each in "xuy"}
        disturb()
        assert getattr(solver.residuals(), name) > 1e-3, name
        for each, values in kept.items():
            getattr(solver, each)[:] = values
        solver.lower["clearance"][:] = NEAR
    assert solver.residuals().largest < 1e-9


def test_a_warm_start_is_at_the_solution(solver: ControlSolver, found: Solution) -> None:
    solver.start(found.x, found.u)
    again = solver.solve(tolerance=1e-8)
    assert again.steps == 1
    np.testing.assert_allclose(again.x, found.x, atol=1e-8)


def test_the_input_before_is_the_one_that_the_plan_applied(solver: ControlSolver, found: Solution) -> None:
    solver.start(found.x, found.u)
    solver.advance()
    assert solver.before.tolist() == [found.u[0, 1]]
    solver.before[:], solver.initial[:] = BEFORE, START


def test_the_plan_moves_on_by_a_sample_and_its_end_is_predicted(solver: ControlSolver, found: Solution) -> None:
    held = solver.problem.intervals_per_sample
    solver.start(found.x, found.u)
    y, p = solver.y.copy(), solver.p.copy()
    solver.shift()
    assert solver.prepare() == SolverStatus.SOLVED
    np.testing.assert_array_equal(solver.x[:-held], found.x[held:])
    np.testing.assert_array_equal(solver.u, np.vstack([found.u[1:], found.u[-1]]))
    for moved, before in ((solver.y, y), (solver.p, p)):
        np.testing.assert_array_equal(moved, np.vstack([before[held:], before[-held:]]))
        moved[:] = before
    assert np.abs(solver.defects).max() < 1e-8, "the repeated input drives the last sample's nodes"


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"bounds": {"wings": SOFT}}, "'wings' is no state, input, output of 'car'"),
        ({"change_bounds": {"lateral": SOFT}}, "change_bounds: 'lateral' is no input of 'car'"),
        ({"change_weights": {"x": 1.0}}, "change_weights: there is no 'x'; the names are push, steering"),
        (
            {"initial_weights": dict.fromkeys(("x", "y", "yaw", "speed"), 1.0)},
            "take 'lateral', 'clearance', 'steering' out of",
        ),
        (
            {
                "initial_weights": dict.fromkeys(("x", "y", "yaw", "speed"), 1.0),
                "bounds": {},
                "change_weights": {},
                "change_bounds": {},
                "intervals_per_sample": 2,
            },
            "goes with intervals_per_sample = 1 only, got 2",
        ),
        ({"intervals_per_sample": 0}, "intervals_per_sample must be a whole number from 1 to 100, got 0"),
        ({"intervals_per_sample": 1.5}, "intervals_per_sample must be a whole number from 1 to 100, got 1.5"),
    ],
)
def test_a_problem_that_contradicts_itself_is_refused(changes: dict[str, Any], complaint: str) -> None:
    with pytest.raises(SolverError, match=complaint):
        problem(**changes)


def test_a_name_that_means_two_things_is_refused() -> None:
    model = declare(
        "twice",
        states=variables(x="m"),
        inputs=variables(u="m/s"),
        parameters=(),
        outputs=variables(x="m"),
        equations=lambda x, u, p: (u, 2.0 * x),
    )
    with pytest.raises(SolverError, match="'x' of 'twice' is a state or input, and an output that is something else"):
        ControlProblem(
            model=model,
            horizon=2,
            sample_time=0.1,
            weights={"x": 1.0},
            terminal_weights={"x": 1.0},
            bounds={"x": Bound(lower=0.0, upper=1.0)},
        )


def test_a_start_of_another_size_or_not_finite_is_refused(solver: ControlSolver) -> None:
    with pytest.raises(SolverError, match=r"start\(\): u must be an array \(12, 2\) .* got shape \(11, 2\)"):
        solver.start(u=np.zeros((N - 1, 2)))
    with pytest.raises(SolverError, match=r"start\(\): x must be an array .* got shape \(13, 4\) with nan"):
        solver.start(x=np.full((N + 1, 4), np.nan))

"""The compiled adaptive integrator: CVODES' states and derivatives, and a problem's solution by IPOPT on collocation.

The oscillator is that of van der Pol, which swings slowly and jumps at times. Each sample has two shooting intervals.
"""

from typing import Any

import casadi as ca
import numpy as np
import pytest

from drawbar.geometry import Floats
from drawbar.optimal import Bound, ControlProblem, ControlSolver, EstimationProblem, EstimationSolver
from drawbar.signals import SolverStatus
from drawbar.vehicle.integrators import Integrator, exact
from drawbar.vehicle.model import Model, declare, variables

N, HELD, SAMPLE = 12, 2, 0.5
M = N * HELD
START, STIFFNESS, TOLERANCE = np.array([2.0, 0.0]), 5.0, 1e-5
PUSH, RATE, PENALTY, CHANGE = 3.0, 0.6, 1.0, 0.1
"""m/s², bound of the input; m/s, soft bound of the rate; its price; weight of the input's change"""
STEP = 1e-6
"""of differences"""


def oscillator() -> Model:
    def equations(x: Any, u: Any, p: Any) -> tuple[Any, Any]:
        return ca.vertcat(x[1], p * (1.0 - x[0] ** 2) * x[1] - x[0] + u), ca.vertcat(x[0], u, x[1])

    return declare(
        "relaxation",
        states=variables(position="m", speed="m/s"),
        inputs=variables(push="m/s²"),
        parameters=variables(stiffness="1/s"),
        outputs=variables(position="m", push="m/s²", rate="m/s"),
        equations=equations,
    )


ADAPTIVE: dict[str, Any] = {
    "model": oscillator(),
    "sample_time": SAMPLE,
    "integrator": Integrator.ADAPTIVE,
    "integration_steps": 100,
    "integration_tolerance": TOLERANCE,
}


@pytest.fixture
def controller() -> ControlSolver:
    """Return a controller at rest with a bounded input, a softly bounded output and a weight of changes."""
    problem = ControlProblem(
        **ADAPTIVE,
        horizon=N,
        intervals_per_sample=HELD,
        weights={"position": 1.0, "push": 1e-2, "rate": 0.0},
        terminal_weights={"position": 10.0, "rate": 1.0},
        bounds={
            "push": Bound(lower=-PUSH, upper=PUSH),
            "rate": Bound(lower=-RATE, upper=RATE, linear_penalty=PENALTY),
        },
        change_weights={"push": CHANGE},
    )
    solver = ControlSolver(problem)
    solver.initial[:], solver.p[:], solver.y[:] = START, STIFFNESS, 0.0
    solver.start()
    return solver


@pytest.fixture
def estimator() -> EstimationSolver:
    """Return an estimator of state and stiffness."""
    problem = EstimationProblem(
        **ADAPTIVE,
        horizon=4,
        weights={"position": 1.0, "push": 1.0, "rate": 0.0},
        prior_deviation={"position": 0.1, "speed": 1.0, "stiffness": 1.0},
        process_deviation={"position": 0.0, "speed": 0.0, "stiffness": 0.0},
    )
    return EstimationSolver(problem, np.array([*START, STIFFNESS]))


def ends(solver: Any) -> Floats:
    """Return the states (intervals, nx) at the ends of the intervals along a solver's trajectory."""
    assert solver.prepare() == SolverStatus.SOLVED
    states = len(solver.problem.model.states)
    return np.array(solver.workspace.array("qp.c")[:, :states] + solver.x[1:, :states])


def scattered(solver: Any) -> None:
    """Put the trajectory where the oscillator jumps and where it does not."""
    rng = np.random.default_rng(7)
    solver.x[:, 0], solver.x[:, 1] = rng.uniform(-2.0, 2.0, (2, len(solver.x)))
    solver.u[:] = rng.uniform(-1.0, 1.0, solver.u.shape)


def test_states_and_derivatives_are_those_of_cvodes(controller: ControlSolver) -> None:
    scattered(controller)
    controller.start(controller.x.copy(), controller.u.copy())  # the held inputs follow
    held = np.repeat(controller.u, HELD, axis=0)
    step = exact(oscillator(), SAMPLE / HELD).map(M)

    def truth(x: Floats, u: Floats) -> Floats:
        return np.array(step(x.T, u.T, controller.p[:-1].T)).T

    x = controller.x[:-1]
    after = truth(x, held)
    assert (np.abs(ends(controller) - after) < TOLERANCE * (1.0 + np.abs(after))).all()
    A, B = (controller.workspace.array(f"qp.{name}")[:, :2].copy() for name in "AB")
    for j, shift in enumerate(1e-4 * np.eye(2)):
        slope = (truth(x + shift, held) - truth(x - shift, held)) / 2e-4
        np.testing.assert_allclose(A[:, :, j], slope, rtol=1e-3, atol=1e-3)
    slope = (truth(x, held + 1e-4) - truth(x, held - 1e-4)) / 2e-4
    np.testing.assert_allclose(B[::HELD, :, 0], slope[::HELD], rtol=1e-3, atol=1e-3)
    np.testing.assert_array_equal(B[1::HELD], 0.0)


@pytest.mark.parametrize("name", ["controller", "estimator"])
def test_derivatives_are_those_of_the_steps_taken(name: str, request: pytest.FixtureRequest) -> None:
    solver = request.getfixturevalue(name)
    scattered(solver)
    ends(solver)
    rows = len(solver.x) - 1
    slopes = {"x": solver.workspace.array("qp.A")[:rows].copy(), "u": solver.workspace.array("qp.B")[:rows].copy()}
    for which in "xu":
        values = solver.workspace.array(which)
        for j in range(values.shape[1]):
            kept = values.copy()
            values[:, j] += STEP
            above = ends(solver)
            values[:, j] -= 2.0 * STEP
            slope = (above - ends(solver)) / (2.0 * STEP)
            values[:] = kept
            np.testing.assert_allclose(slopes[which][:, :2, j], slope, rtol=1e-6, atol=1e-6)


def test_an_interval_whose_end_is_not_reached_has_no_values(controller: ControlSolver) -> None:
    tolerance = controller.workspace.array("constants")[-1:]
    tolerance[:] = 1e-9
    assert controller.prepare() == SolverStatus.NOT_FINITE
    assert np.isnan(controller.defects).any()
    assert controller.feedback() == SolverStatus.NOT_FINITE
    tolerance[:] = TOLERANCE
    assert controller.prepare() == SolverStatus.SOLVED


def collocated(controller: ControlSolver) -> tuple[Floats, Floats]:
    """Return IPOPT's x (M+1, nx) and u (N,), every interval in six elements of Radau's method of order 7."""
    elements, order, model = 6, 4, oscillator()
    per = elements * order
    slopes = np.array(ca.collocation_coeff(ca.collocation_points(order, "radau"))[0])
    f = ca.Function("f", [model.x, model.u, model.p], [model.derivative])
    opti = ca.Opti()
    u, x, slack = opti.variable(1, N), opti.variable(2, M * per + 1), opti.variable(M)
    change = u - ca.horzcat(0.0, u[:-1])
    cost = 0.5 * CHANGE * ca.sumsqr(change) + PENALTY * ca.sum1(slack) + 0.5e-2 * ca.sumsqr(u)
    opti.subject_to(x[:, 0] == START)
    opti.subject_to(opti.bounded(-PUSH, u, PUSH))
    opti.subject_to(slack >= 0.0)
    for k in range(M):
        for first in range(k * per, (k + 1) * per, order):
            inside = x[:, first : first + order + 1]
            moved = SAMPLE / HELD / elements * f(inside[:, 1:], u[k // HELD], STIFFNESS)
            opti.subject_to(ca.vec(inside @ slopes) == ca.vec(moved))
        cost += 0.5 * x[0, k * per] ** 2 / HELD
        opti.subject_to(opti.bounded(-RATE - slack[k], x[1, (k + 1) * per], RATE + slack[k]))
    opti.minimize(cost + 0.5 * (10.0 * x[0, -1] ** 2 + x[1, -1] ** 2))
    quiet = {"print_level": 0, "sb": "yes", "tol": 1e-10, "bound_relax_factor": 0.0}
    opti.solver("ipopt", {"print_time": False, "expand": True}, quiet)
    opti.set_initial(u, controller.u.T)
    opti.set_initial(x, np.column_stack([np.repeat(controller.x[:-1].T, per, axis=1), controller.x[-1]]))
    solution = opti.solve()
    return np.array(solution.value(x)).T[::per], np.array(solution.value(u)).ravel()


def test_the_solution_is_that_of_ipopt_on_collocation(controller: ControlSolver) -> None:
    found = controller.solve(tolerance=1e-9)
    assert found.solved
    assert (np.abs(found.u) > PUSH - 1e-9).sum() >= 2, "the bound is in the way"
    assert np.abs(found.x[:, 1]).max() > RATE + 1e-3, "the soft bound gives way"
    x, u = collocated(controller)
    np.testing.assert_allclose(found.x, x, rtol=0.0, atol=2.0 * TOLERANCE)
    np.testing.assert_allclose(found.u.ravel(), u, rtol=0.0, atol=5.0 * TOLERANCE)

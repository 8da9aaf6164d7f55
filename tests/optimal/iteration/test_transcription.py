"""What the generated C computes, against finite differences and CasADi's own Jacobians."""

from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from drawbar.geometry import Floats
from drawbar.optimal import EstimationProblem
from drawbar.optimal.problem import row
from drawbar.optimal.solver_source import LEVENBERG
from drawbar.optimal.transcription import transcribe
from drawbar.signals import SolverStatus

STEP = 1e-6


def disturbed(case: Any) -> Any:
    """Return a solver at a random point of the problem, not a trajectory of its model."""
    solver, rng = case.solver(), np.random.default_rng(40)
    solver.x += 0.1 * rng.normal(size=solver.x.shape)
    solver.u += 0.1 * rng.normal(size=solver.u.shape)
    if isinstance(case.problem, EstimationProblem):
        solver.x[1:, len(case.problem.model.states) :] = solver.x[0, len(case.problem.model.states) :]
    return solver


def test_sensitivities_of_every_interval(case: Any) -> None:
    solver = disturbed(case)
    linearise = solver.workspace.function("linearise")
    F = solver.workspace.array("qp.c")
    linearise()
    slopes = {"x": solver.workspace.array("qp.A").copy(), "u": solver.workspace.array("qp.B").copy()}
    for name, values in (("x", solver.x), ("u", solver.u)):
        rows = slice(0, len(F))
        for j in range(values.shape[1]):
            kept = values.copy()
            values[:, j] = kept[:, j] + STEP
            linearise()
            above = F.copy()
            values[:, j] = kept[:, j] - STEP
            linearise()
            values[:] = kept
            difference = (above - F) / (2 * STEP)
            moving = slopes[name].shape[1]
            np.testing.assert_allclose(slopes[name][rows, :, j], difference[:, :moving], rtol=0, atol=2e-9)
            constant = np.zeros_like(difference[:, moving:])
            if name == "x" and j >= moving:
                constant[:, j - moving] = 1.0
            np.testing.assert_allclose(difference[:, moving:], constant, rtol=0, atol=2e-9)


def test_states_that_only_inputs_move_have_rows_of_the_identity(case: Any) -> None:
    solver = disturbed(case)
    solver.workspace.function("linearise")()
    A, t = solver.workspace.array("qp.A")[: case.problem.horizon], transcribe(case.problem)
    moving, still = A.shape[1], t.x.numel() - t.still_states
    identity = np.eye(moving, A.shape[2])
    assert t.constant_states <= t.still_states
    assert np.all(A[:, still:] == identity[still:])
    assert still == 0 or np.any(A[:, still - 1] != identity[still - 1])


def half_cost(case: Any, x: Floats, u: Floats) -> float:
    """Return half the sum of squares at (x, u), missing measurements and the arrival cost included."""
    t, solver_data = transcribe(case.problem).numeric(), case
    output = ca.Function("h", [t.x, t.u, t.p], [t.output])
    n = case.problem.horizon
    value = 0.0
    for k in range(n + 1):
        h = np.array(output(x[k], u[min(k, n - 1)], solver_data.p[k])).ravel()
        weights = np.array(stage_weights(case, k))
        residual = np.where(np.isnan(case.y[k]), 0.0, h - case.y[k])
        value += 0.5 * float(weights @ residual**2)
    if t.free_initial:
        value += 0.5 * float((((x[0] - case.initial) / prior_deviations(case)) ** 2).sum())
    return value


def stage_weights(case: Any, k: int) -> Floats:
    """Return the weights of stage k; an output of the input has none at the last stage."""
    problem, last = case.problem, k == case.problem.horizon
    if not isinstance(problem, EstimationProblem):
        return np.array(row(problem.terminal_weights if last else problem.weights, problem.model.outputs))
    gone = np.array(transcribe(problem).input_outputs) & last
    return np.where(gone, 0.0, row(problem.weights, problem.model.outputs))


def prior_deviations(case: Any) -> Floats:
    return np.array(row(case.problem.prior_deviation, case.problem.estimated))


def test_gradient_is_the_slope_of_the_cost(case: Any) -> None:
    solver = disturbed(case)
    x, u = solver.x.copy(), solver.u.copy()
    solver.prepare()
    solver.feedback()
    g = solver.workspace.array("qp.g")
    nx, nu = x.shape[1], u.shape[1]
    stages = [0, 4, case.problem.horizon]  # an ordinary one, one with gaps, the last
    for k in stages:
        for j in range(nx):
            sides = [half_cost(case, x + sign * STEP * unit(x, k, j), u) for sign in (1, -1)]
            slope = (sides[0] - sides[1]) / (2 * STEP)
            np.testing.assert_allclose(g[k * nx + j], slope, rtol=1e-6, atol=1e-4)
    for j in range(nu):
        sides = [half_cost(case, x, u + sign * STEP * unit(u, 4, j)) for sign in (1, -1)]
        slope = (sides[0] - sides[1]) / (2 * STEP)
        np.testing.assert_allclose(g[x.size + 4 * nu + j], slope, rtol=1e-6, atol=1e-4)


def unit(like: Floats, k: int, j: int) -> Floats:
    result = np.zeros_like(like)
    result[k, j] = 1.0
    return result


def test_hessian_is_that_of_gauss_and_newton(case: Any) -> None:
    assert not transcribe(case.problem).crosses
    judge_hessian(case)


def test_hessian_where_an_output_depends_on_a_state_and_an_input(named: Any) -> None:
    case = named("tricycle_tractor")
    model = case.problem.model
    output = ca.vertcat(model.output[:-1], model.output[-1] * (1.0 + ca.sin(model.x[1])))
    mixed = replace(case, problem=replace(case.problem, model=replace(model, name="mixed", output=output), bounds={}))
    assert transcribe(mixed.problem).crosses
    judge_hessian(mixed)


def judge_hessian(case: Any) -> None:
    solver = disturbed(case)
    x, u, n = solver.x.copy(), solver.u.copy(), case.problem.horizon
    solver.prepare()
    t = transcribe(case.problem).numeric()
    z = ca.vertcat(t.x, t.u)
    jacobian = ca.Function("J", [t.x, t.u, t.p], [ca.jacobian(t.output, z)])
    Q, S, R = (solver.workspace.array(f"qp.{name}") for name in "QSR")
    nx = x.shape[1]
    for k in range(n + 1):
        J = np.array(jacobian(x[k], u[min(k, n - 1)], case.p[k]))
        weights = np.where(np.isnan(case.y[k]), 0.0, stage_weights(case, k))
        H = J.T @ (weights[:, None] * J)
        if k == 0 and t.free_initial:
            H[:nx, :nx] += np.diag(1.0 / prior_deviations(case) ** 2)
        np.testing.assert_allclose(Q[k], H[:nx, :nx], rtol=1e-12, atol=1e-12)
        if k < n:
            np.testing.assert_allclose(S[k] if len(S) else 0.0, H[nx:, :nx], rtol=1e-12, atol=1e-12)
            np.testing.assert_allclose(R[k], H[nx:, nx:] + LEVENBERG * np.eye(len(H) - nx), rtol=1e-12, atol=1e-12)
    assert solver.feedback() == SolverStatus.SOLVED

"""The real-time iteration repeated to convergence is the solution that IPOPT finds for the same nonlinear problem."""

from typing import Any

import casadi as ca
import numpy as np

from drawbar.geometry import Floats
from drawbar.optimal import EstimationProblem
from drawbar.optimal.problem import row
from drawbar.signals import SolverStatus
from drawbar.vehicle.integrators import integrate

OPTIONS: dict[str, Any] = {
    "print_time": False,
    "ipopt": {
        "print_level": 0,
        "sb": "yes",
        "tol": 1e-12,
        "acceptable_tol": 1e-12,
        "bound_relax_factor": 0.0,
    },
}


def reference_solution(case: Any, x0: Floats, u0: Floats) -> tuple[Floats, Floats]:
    """Return IPOPT's x (N+1, nx) and u (N, nu); the estimator's parameters are the last columns of x."""
    problem, model = case.problem, case.problem.model.numeric()
    estimation = isinstance(problem, EstimationProblem)
    n, nx, nu, npar = problem.horizon, len(model.states), len(model.inputs), len(model.parameters)
    step = ca.Function("F", [model.x, model.u, model.p], [integrate(model, problem.sample_time)])
    output = ca.Function("h", [model.x, model.u, model.p], [model.output])
    depends = ca.which_depends(model.output, model.u, 1, True)
    x, u, p = ca.SX.sym("x", nx, n + 1), ca.SX.sym("u", nu, n), ca.SX.sym("p", npar if estimation else 0)
    variables = ca.vertcat(ca.vec(x), ca.vec(u), p)
    cost, defects = ca.SX(0), []
    for k in range(n + 1):
        known = p if estimation else ca.DM(case.p[k])
        h = output(x[:, k], u[:, min(k, n - 1)], known)
        weights = row(problem.weights if estimation or k < n else problem.terminal_weights, model.outputs)
        for i, weight in enumerate(weights):
            if not (np.isnan(case.y[k, i]) or (k == n and depends[i])):
                cost += weight * (h[i] - case.y[k, i]) ** 2
        if k < n:
            defects.append(step(x[:, k], u[:, k], known) - x[:, k + 1])
    if estimation:
        first = (ca.vertcat(x[:, 0], p) - case.initial) / ca.DM(row(problem.prior_deviation, problem.estimated))
        cost += ca.sumsqr(first)
    else:
        defects.append(x[:, 0] - ca.DM(case.initial))
    limits = [problem.bounds.get(v.name) for v in (*model.states, *model.inputs, *model.parameters)]
    lower, upper = (
        np.array([end if b is None else getattr(b, side) for b in limits])
        for side, end in (("lower", -np.inf), ("upper", np.inf))
    )
    spread = np.concatenate(
        [
            np.tile(np.arange(nx), n + 1),
            np.tile(np.arange(nx, nx + nu), n),
            np.arange(nx + nu, nx + nu + p.numel()),
        ]
    )
    solver = ca.nlpsol("nlp", "ipopt", {"x": variables, "f": cost, "g": ca.vertcat(*defects)}, OPTIONS)
    start = np.concatenate([x0[:, :nx].ravel(), u0.ravel(), x0[0, nx:]])
    found = solver(x0=start, lbx=lower[spread], ubx=upper[spread], lbg=0, ubg=0)
    assert solver.stats()["success"]
    z = np.array(found["x"]).ravel()
    states = z[: (n + 1) * nx].reshape(n + 1, nx)
    inputs = z[(n + 1) * nx : (n + 1) * nx + n * nu].reshape(n, nu)
    return np.hstack([states, np.tile(z[z.size - p.numel() :], (n + 1, 1))]), inputs


def test_repeated_iteration_finds_the_solution_of_the_nonlinear_problem(case: Any) -> None:
    solver = case.solver()
    x, u = reference_solution(case, solver.x, solver.u)
    active = False
    for _ in range(80):
        before = solver.x.copy()
        assert solver.prepare() == SolverStatus.SOLVED
        assert solver.feedback() == SolverStatus.SOLVED
        active |= solver.iterations > 0
        if np.abs(solver.x - before).max() < 1e-10:
            break
    else:
        raise AssertionError("the iteration does not settle")
    assert active, "no bound was in the way"
    np.testing.assert_allclose(solver.x, x, rtol=0, atol=1e-6)
    np.testing.assert_allclose(solver.u, u, rtol=0, atol=1e-6)
    left = solver.residuals()
    assert left.stationarity < 1e-7 * np.abs(solver.workspace.array("qp.g")).max()
    assert max(left.defect, left.violation, left.complementarity) < 1e-8

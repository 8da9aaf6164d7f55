"""The integrators: their order, and what the one for stiff models is for."""

from typing import Any

import casadi as ca
import numpy as np
import pytest

from drawbar.geometry import Floats
from drawbar.optimal import Bound, ControlProblem, ControlSolver
from drawbar.vehicle.integrators import Integrator, discretise, rosenbrock
from drawbar.vehicle.model import Model, declare, variables

FAST = 1e-4
"""s, time constant of the servo"""


def pendulum() -> Model:
    """Return a pendulum whose pivot is accelerated by a servo that follows its command within 0.1 ms."""

    def equations(x: Any, u: Any, p: Any) -> tuple[Any, Any]:
        push = x[2]
        rates = ca.vertcat(x[1], -9.81 * ca.sin(x[0]) - 0.3 * x[1] - push * ca.cos(x[0]), (u - push) / FAST)
        return rates, ca.vertcat(x[0], u)

    return declare(
        "stiff",
        states=variables(angle="rad", rate="rad/s", push="m/s²"),
        inputs=variables(command="m/s²"),
        parameters=(),
        outputs=variables(angle="rad", command="m/s²"),
        equations=equations,
    )


def van_der_pol() -> Model:
    return declare(
        "oscillator",
        states=variables(x="m", v="m/s"),
        inputs=variables(u="m/s²"),
        parameters=(),
        outputs=variables(x="m"),
        equations=lambda x, u, p: (ca.vertcat(x[1], (1.0 - x[0] ** 2) * x[1] - x[0] + u), x[0]),
    )


def exact(model: Model, x: Any, u: Any, seconds: float) -> Floats:
    """Return the state after some time by CVODES."""
    ode = {"x": model.x, "p": model.u, "ode": model.derivative}
    found = ca.integrator("exact", "cvodes", ode, 0.0, seconds, {"abstol": 1e-13, "reltol": 1e-12})(x0=x, p=u)
    return np.array(found["xf"]).ravel()


def after(model: Model, x: Any, u: Any, steps: int, integrator: Integrator, seconds: float = 1.0) -> Floats:
    step = ca.Function("F", [model.x, model.u], [discretise(model, seconds, steps, integrator)])
    return np.array(step(x, u)).ravel()


@pytest.mark.parametrize(("integrator", "order"), [(Integrator.RUNGE_KUTTA, 4), (Integrator.ROSENBROCK, 3)])
def test_order(integrator: Integrator, order: int) -> None:
    model, x, u = van_der_pol(), [1.0, 0.5], 0.3
    truth = exact(model, x, u, 1.0)
    errors = [np.abs(after(model, x, u, steps, integrator) - truth).max() for steps in (16, 32, 64)]
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), order, atol=0.15)


def test_a_stiff_model_needs_the_method_for_it() -> None:
    model, x, u = pendulum(), [0.3, 0.0, 2.0], -1.0
    truth = exact(model, x, u, 0.1)
    assert not np.abs(after(model, x, u, 4, Integrator.RUNGE_KUTTA, 0.1)).max() < 1e6, "unstable"
    found = after(model, x, u, 4, Integrator.ROSENBROCK, 0.1)
    np.testing.assert_allclose(found, truth, atol=2e-3)


def test_what_has_died_out_is_gone_after_one_step() -> None:
    decay = declare(
        "decay",
        states=variables(x="m"),
        inputs=variables(u="m/s"),
        parameters=(),
        outputs=variables(x="m"),
        equations=lambda x, u, p: (-1e9 * x + u, x),
    )
    assert abs(after(decay, 1.0, 0.0, 1, Integrator.ROSENBROCK)[0]) < 1e-8


def test_a_controller_of_a_stiff_model_agrees_with_ipopt() -> None:
    model, horizon, sample = pendulum(), 15, 0.1
    limit = Bound(lower=-1.5, upper=1.5)
    solver = ControlSolver(
        ControlProblem(
            model=model,
            horizon=horizon,
            sample_time=sample,
            weights={"angle": 1.0, "command": 1e-3},
            terminal_weights={"angle": 10.0},
            bounds={"command": limit},
            integrator=Integrator.ROSENBROCK,
        )
    )
    start = [0.4, 0.0, 0.0]
    solver.initial[:], solver.y[:] = start, 0.0
    solver.start()
    found = solver.solve(tolerance=1e-9)
    assert found.solved
    assert (np.abs(found.u) > 1.5 - 1e-9).any()
    opti, step = ca.Opti(), ca.Function("F", [model.x, model.u], [rosenbrock(model, sample)])
    x, u = opti.variable(3, horizon + 1), opti.variable(1, horizon)
    opti.subject_to(x[:, 0] == start)
    for k in range(horizon):
        opti.subject_to(x[:, k + 1] == step(x[:, k], u[:, k]))
    opti.subject_to(opti.bounded(-1.5, u, 1.5))
    opti.minimize(ca.sumsqr(x[0, :-1]) + 1e-3 * ca.sumsqr(u) + 10.0 * x[0, -1] ** 2)
    opti.solver(
        "ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes", "tol": 1e-11, "bound_relax_factor": 0.0}
    )
    solution = opti.solve()
    np.testing.assert_allclose(found.x, np.array(solution.value(x)).T, atol=1e-6)
    np.testing.assert_allclose(found.u.ravel(), np.array(solution.value(u)).ravel(), atol=1e-6)

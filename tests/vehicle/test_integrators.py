"""The integrators: their order, and what the one for stiff models is for."""

from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drawbar.geometry import Floats
from drawbar.optimal import Bound, ControlProblem, ControlSolver
from drawbar.vehicle.integrators import FIRST_SHARE, Integrator, attempt, discretise, exact, rosenbrock
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


def van_der_pol(stiffness: float = 1.0) -> Model:
    return declare(
        "oscillator",
        states=variables(x="m", v="m/s"),
        inputs=variables(u="m/s²"),
        parameters=(),
        outputs=variables(x="m"),
        equations=lambda x, u, p: (ca.vertcat(x[1], stiffness * (1.0 - x[0] ** 2) * x[1] - x[0] + u), x[0]),
    )


def reactor() -> Model:
    """Return a stirred tank that ignites: the rate of its reaction grows with the temperature."""

    def equations(x: Any, u: Any, p: Any) -> tuple[Any, Any]:
        rate = 0.02 * x[0] * ca.exp(20.0 * x[1] / (1.0 + x[1]))
        return ca.vertcat(1.0 - x[0] - rate, 3.0 * (u - x[1]) + 2.0 * rate), x[1]

    return declare(
        "reactor",
        states=variables(concentration="1", temperature="1"),
        inputs=variables(jacket="1"),
        parameters=(),
        outputs=variables(temperature="1"),
        equations=equations,
    )


def true(model: Model, x: Any, u: Any, seconds: float) -> Floats:
    """Return the state after some time by CVODES."""
    return np.array(exact(model, seconds)(x, u, [])).ravel()


def in_steps(model: Model, seconds: float, tolerance: float) -> Any:
    """Return a function (x, u) -> (state after some time, attempts that it took), the attempts without end."""
    tried = attempt(model, seconds, tolerance, 1)
    once = ca.Function(
        "attempt",
        [tried.x, tried.left, tried.length, model.u],
        [tried.x + ca.if_else(tried.taken, tried.after - tried.x, 0.0), tried.remaining, tried.following],
    )

    def carry(x: Any, u: Any) -> tuple[Floats, int]:
        left, length, attempts = 1.0, FIRST_SHARE, 0
        while left > 0.0:
            x, left, length = once(x, left, length, u)
            attempts += 1
            assert attempts < 500
        assert left == 0.0, "the lengths add up to the interval"
        return np.array(x).ravel(), attempts

    return carry


def driven(model: Model, x: Floats, samples: int) -> list[tuple[Floats, float, Floats]]:
    """Return (x, u, true x after 0.5 s) along a run with random inputs."""
    step, found = exact(model, 0.5), []
    for u in np.random.default_rng(1).uniform(-0.1, 0.3, samples):
        after = np.array(step(x, u, [])).ravel()
        found.append((x, float(u), after))
        x = after
    return found


def after(model: Model, x: Any, u: Any, steps: int, integrator: Integrator, seconds: float = 1.0) -> Floats:
    step = ca.Function("F", [model.x, model.u], [discretise(model, seconds, steps, integrator)])
    return np.array(step(x, u)).ravel()


@pytest.mark.parametrize(("integrator", "order"), [(Integrator.RUNGE_KUTTA, 4), (Integrator.ROSENBROCK, 3)])
def test_error_falls_with_the_order_of_the_method(integrator: Integrator, order: int) -> None:
    model, x, u = van_der_pol(), [1.0, 0.5], 0.3
    truth = true(model, x, u, 1.0)
    errors = [np.abs(after(model, x, u, steps, integrator) - truth).max() for steps in (16, 32, 64)]
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), order, atol=0.15)


def test_a_stiff_model_needs_the_method_for_it() -> None:
    model, x, u = pendulum(), [0.3, 0.0, 2.0], -1.0
    truth = true(model, x, u, 0.1)
    assert not np.abs(after(model, x, u, 4, Integrator.RUNGE_KUTTA, 0.1)).max() < 1e6, "unstable"
    found = after(model, x, u, 4, Integrator.ROSENBROCK, 0.1)
    np.testing.assert_allclose(found, truth, atol=2e-3)


def test_cvodes_and_scipy_agree() -> None:
    model = reactor()
    f = ca.Function("f", [model.x, model.u], [model.derivative])
    found = solve_ivp(lambda _, x: np.array(f(x, 0.2)).ravel(), (0.0, 0.5), [1.0, 0.2], "LSODA", rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(true(model, [1.0, 0.2], 0.2, 0.5), found.y[:, -1], rtol=1e-8)


def test_an_adaptive_step_goes_where_steps_of_equal_length_fail() -> None:
    model, points = reactor(), driven(reactor(), np.array([1.0, 0.0]), 120)
    assert max(after[1] for *_, after in points) > 1.2, "it ignites"
    carry = in_steps(model, 0.5, 1e-4)
    found = [(carry(x, u), after) for x, u, after in points]
    errors = [np.abs((x - after) / (1.0 + np.abs(after))).max() for (x, _), after in found]
    attempts = [each for (_, each), _ in found]
    assert max(errors) < 1e-4
    assert max(attempts) < 100
    assert np.mean(attempts) < 15
    step = ca.Function("F", [model.x, model.u], [rosenbrock(model, 0.5 / 100)]).mapaccum(100)
    equal = [np.array(step(x, np.full((1, 100), u)))[:, -1] for x, u, _ in points]
    assert not max(np.abs(x - after).max() for x, (_, _, after) in zip(equal, points, strict=True)) < 100.0


def test_what_merely_follows_is_better_carried_in_steps_of_equal_length() -> None:
    model, x, u = pendulum(), [0.3, 0.0, 2.0], -1.0
    truth, (found, attempts) = true(model, x, u, 0.1), in_steps(model, 0.1, 1e-4)(x, u)
    assert attempts > 20
    assert np.abs(after(model, x, u, 20, Integrator.ROSENBROCK, 0.1) - truth).max() < np.abs(found - truth).max() < 1e-4


def test_the_error_follows_the_tolerance() -> None:
    model, tolerances, worst = van_der_pol(5.0), 10.0 ** np.arange(-6, -1), []
    points = driven(model, np.array([2.0, 0.0]), 40)
    for tolerance in tolerances:
        carry = in_steps(model, 0.5, float(tolerance))
        worst.append(max(np.abs((carry(x, u)[0] - after) / (1.0 + np.abs(after))).max() for x, u, after in points))
    assert (np.array(worst) < tolerances).all()
    order = np.polyfit(np.log(tolerances), np.log(worst), 1)[0]
    assert order == pytest.approx(1.0, abs=0.15), "the estimate is of the error"


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

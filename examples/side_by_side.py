"""One problem declared for drawbar, CasADi with IPOPT, do-mpc and acados, and what a sample costs.

docs/side-by-side.md shows it. A car comes back to a line from 1.5 m beside it; what is not installed is left out.
Run: python examples/side_by_side.py
"""

import importlib.util
import platform
import time
from collections.abc import Callable

import casadi as ca
import numpy as np

from drawbar.geometry import Floats
from drawbar.optimal import Bound, ControlProblem, ControlSolver
from drawbar.vehicle.integrators import integrate
from drawbar.vehicle.model import declare, variables

HORIZON, SAMPLE_TIME, LIMIT, CHANGE = 20, 0.1, 0.3, 0.05  # samples, s, rad, rad per sample
Step = Callable[[Floats, float], float]


def equations(x, u, p):
    """Return the motion of a car at 2 m/s with a wheelbase of 1.5 m, and what is weighed."""
    return ca.vertcat(2.0 * ca.sin(x[1]), 2.0 * ca.tan(u) / 1.5), ca.vertcat(x, u)


CAR = declare(
    "car",
    states=variables(y="m", yaw="rad"),
    inputs=variables(steering="rad"),
    parameters=(),
    outputs=variables(y="m", yaw="rad", steering="rad"),
    equations=equations,
)
NEXT = ca.Function("next", [CAR.x, CAR.u], [integrate(CAR, SAMPLE_TIME)])


def with_drawbar(*, converged: bool) -> Step:
    """Return drawbar's: one step of the real-time iteration for each sample, or as many as it takes."""
    problem = ControlProblem(
        model=CAR,
        horizon=HORIZON,
        sample_time=SAMPLE_TIME,
        weights={"y": 1.0, "yaw": 1.0, "steering": 0.1},
        terminal_weights={"y": 5.0, "yaw": 5.0},
        bounds={"steering": Bound(lower=-LIMIT, upper=LIMIT)},
        change_weights={"steering": 0.5},
        change_bounds={"steering": Bound(lower=-CHANGE, upper=CHANGE)},
    )
    solver = ControlSolver(problem)
    solver.y[:] = 0.0
    solver.start()

    def step(state: Floats, before: float) -> float:
        solver.initial[:], solver.before[:] = state, before
        if converged:
            assert solver.solve().solved
        else:
            solver.feedback()
        steering = float(solver.u[0, 0])
        solver.advance()
        return steering

    return step


def with_casadi() -> Step:
    """Return CasADi's: Opti, and IPOPT from the last solution."""
    opti = ca.Opti()
    x, u = opti.variable(2, HORIZON + 1), opti.variable(1, HORIZON)
    first, before = opti.parameter(2), opti.parameter()
    change = u - ca.horzcat(before, u[:, :-1])
    opti.minimize(ca.sumsqr(x[:, :-1]) + 0.1 * ca.sumsqr(u) + 5.0 * ca.sumsqr(x[:, -1]) + 0.5 * ca.sumsqr(change))
    opti.subject_to(x[:, 0] == first)
    opti.subject_to(ca.vec(x[:, 1:]) == ca.vec(NEXT.map(HORIZON)(x[:, :-1], u)))
    opti.subject_to(opti.bounded(-LIMIT, u, LIMIT))
    opti.subject_to(opti.bounded(-CHANGE, change, CHANGE))
    opti.solver("ipopt", {"print_time": False, "expand": True}, {"print_level": 0, "sb": "yes", "tol": 1e-9})

    def step(state: Floats, previous: float) -> float:
        opti.set_value(first, state)
        opti.set_value(before, previous)
        solution = opti.solve()
        opti.set_initial(solution.value_variables())
        return float(solution.value(u[0, 0]))

    return step


def with_do_mpc() -> Step:
    """Return do-mpc's: bounds on changes need the input before as a state."""
    import do_mpc

    model = do_mpc.model.Model("discrete")
    y, yaw = model.set_variable("_x", "y"), model.set_variable("_x", "yaw")
    before, steering = model.set_variable("_x", "before"), model.set_variable("_u", "steering")
    after = NEXT(ca.vertcat(y, yaw), steering)
    model.set_rhs("y", after[0])
    model.set_rhs("yaw", after[1])
    model.set_rhs("before", steering)
    model.setup()
    mpc = do_mpc.controller.MPC(model)
    mpc.settings.n_horizon, mpc.settings.t_step, mpc.settings.store_full_solution = HORIZON, SAMPLE_TIME, False
    mpc.settings.supress_ipopt_output()
    mpc.settings.nlpsol_opts["ipopt.tol"] = 1e-9
    mpc.set_objective(mterm=5.0 * (y**2 + yaw**2), lterm=y**2 + yaw**2 + 0.1 * steering**2)
    mpc.set_rterm(steering=0.5)
    mpc.bounds["lower", "_u", "steering"], mpc.bounds["upper", "_u", "steering"] = -LIMIT, LIMIT
    mpc.set_nl_cons("rises", steering - before, ub=CHANGE)
    mpc.set_nl_cons("falls", before - steering, ub=CHANGE)
    mpc.setup()
    started = False

    def step(state: Floats, previous: float) -> float:
        nonlocal started
        whole = np.array([*state, previous])
        if not started:
            mpc.x0 = whole
            mpc.set_initial_guess()
            started = True
        return float(mpc.make_step(whole)[0, 0])

    return step


def with_acados() -> Step:
    """Return acados': the input before is a state, the change an output; SQP_RTI is one step for each sample."""
    from acados_template import AcadosModel, AcadosOcp, AcadosOcpSolver

    x, u, model, ocp = ca.SX.sym("x", 3), ca.SX.sym("u"), AcadosModel(), AcadosOcp()
    model.name, model.x, model.u = "car", x, u
    model.disc_dyn_expr = ca.vertcat(NEXT(x[:2], u), u)
    model.cost_y_expr, model.cost_y_expr_e = ca.vertcat(x[:2], u, u - x[2]), x[:2]
    model.con_h_expr_0 = model.con_h_expr = u - x[2]
    ocp.model, ocp.dims.N, ocp.solver_options.tf = model, HORIZON, HORIZON * SAMPLE_TIME
    ocp.cost.cost_type, ocp.cost.cost_type_e = "NONLINEAR_LS", "NONLINEAR_LS"
    ocp.cost.W, ocp.cost.W_e = np.diag([1.0, 1.0, 0.1, 0.5]), np.diag([5.0, 5.0])
    ocp.cost.yref, ocp.cost.yref_e = np.zeros(4), np.zeros(2)
    ocp.constraints.idxbu, ocp.constraints.x0 = np.array([0]), np.zeros(3)
    ocp.constraints.lbu, ocp.constraints.ubu = np.array([-LIMIT]), np.array([LIMIT])
    ocp.constraints.lh_0 = ocp.constraints.lh = np.array([-CHANGE])
    ocp.constraints.uh_0 = ocp.constraints.uh = np.array([CHANGE])
    ocp.solver_options.integrator_type, ocp.solver_options.nlp_solver_type = "DISCRETE", "SQP_RTI"
    solver = AcadosOcpSolver(ocp)
    return lambda state, before: float(solver.solve_for_x0(np.array([*state, before]))[0])


TOOLS: dict[str, tuple[str, Callable[[], Step]]] = {
    "drawbar, one iteration": ("drawbar", lambda: with_drawbar(converged=False)),
    "drawbar, to 1e-6": ("drawbar", lambda: with_drawbar(converged=True)),
    "CasADi, IPOPT": ("casadi", with_casadi),
    "do-mpc, IPOPT": ("do_mpc", with_do_mpc),
    "acados, one iteration": ("acados_template", with_acados),
}


def run(step: Step, samples: int = 60) -> tuple[Floats, Floats]:
    """Return the steering (samples,), rad, of a closed loop and how long each sample took, s."""
    state, before, steerings, times = np.array([1.5, 0.0]), 0.0, [], []
    for _ in range(samples):
        begin = time.perf_counter()
        before = step(state, before)
        times.append(time.perf_counter() - begin)
        steerings.append(before)
        state = NEXT(state, before).full().ravel()
    return np.array(steerings), np.array(times)


if __name__ == "__main__":
    print(f"{platform.machine()}, Python {platform.python_version()}, CasADi {ca.__version__}; ms a sample")
    print(f"{'tool':24} {'median':>8} {'longest':>9}   off IPOPT's steering by at most, rad")
    truth, _ = run(with_casadi())
    for name, (module, make) in TOOLS.items():
        if importlib.util.find_spec(module) is None:
            print(f"{name:24} not installed")
            continue
        steering, seconds = run(make())
        off = np.abs(steering - truth).max()
        print(f"{name:24} {1e3 * np.median(seconds):8.3f} {1e3 * seconds.max():9.3f}   {off:.1e}")

"""A crane finds out how its load sways, and sets it down close to a wall; docs/tutorial-constraints.md explains it.

Measured are the trolley and a gyroscope at the hook, whose bias and the rope's length are not known.
Run: python examples/crane.py
"""

import casadi as ca
import numpy as np

from drawbar.geometry import Floats
from drawbar.optimal import Bound, ControlProblem, ControlSolver, EstimationProblem, EstimationSolver
from drawbar.vehicle.integrators import integrate
from drawbar.vehicle.model import declare, variables

SAMPLE_TIME, HORIZON, WINDOW = 0.1, 50, 30  # s; samples
TARGET, WALL, GRAVITY = 8.0, 8.1, 9.81  # m, m, m/s²
LISTENED = 30  # samples at rest, in which the load's own swinging tells how long the rope is
TRUTH = np.array([5.0, 0.02])  # m, rad/s: rope and the gyroscope's bias, which the estimator has to find out
GUESS = np.array([0.0, 0.0, 0.0, 0.0, 4.0, 0.0])  # what it starts from
NOISE = {"position": 0.002, "gyro": 0.005, "acceleration": 1e-3}  # m, rad/s, m/s²
HELD = 0.06  # rad: largest sway


def equations(x, u, p):
    """Return a trolley that does the acceleration it is told, and a load that hangs from it."""
    (position, speed, sway, rate), (rope, bias) = ca.vertsplit(x), ca.vertsplit(p)
    swing = -(GRAVITY * ca.sin(sway) + u * ca.cos(sway)) / rope - 0.02 * rate
    load = position + rope * ca.sin(sway)
    return ca.vertcat(speed, u, rate, swing), ca.vertcat(position, speed, rate + bias, load, u)


CRANE = declare(
    "crane",
    states=variables(position="m", speed="m/s", sway="rad", rate="rad/s"),
    inputs=variables(acceleration="m/s²"),
    parameters=variables(rope="m", bias="rad/s"),
    outputs=variables(position="m", speed="m/s", gyro="rad/s", load="m", acceleration="m/s²"),
    equations=equations,
)
CONTROL = ControlProblem(
    model=CRANE,
    horizon=HORIZON,
    sample_time=SAMPLE_TIME,
    weights={"position": 0.1, "speed": 0.0, "gyro": 1.0, "load": 1.0, "acceleration": 1.0},
    terminal_weights={"position": 1.0, "speed": 1.0, "gyro": 10.0, "load": 10.0},
    bounds={
        "acceleration": Bound(lower=-0.5, upper=0.5),
        "speed": Bound(lower=-1.0, upper=1.0),
        "sway": Bound(lower=-HELD, upper=HELD, linear_penalty=1e3),
        "load": Bound(lower=-np.inf, upper=WALL, linear_penalty=1e3),
    },
    change_weights={"acceleration": 10.0},
    change_bounds={"acceleration": Bound(lower=-0.1, upper=0.1)},
)
DRIFT = {"position": 1e-4, "speed": 1e-3, "sway": 1e-4, "rate": 1e-3, "rope": 1e-3, "bias": 1e-5}
ESTIMATION = EstimationProblem(
    model=CRANE,
    horizon=WINDOW,
    sample_time=SAMPLE_TIME,
    weights={"speed": 0.0, "load": 0.0} | {name: deviation**-2 for name, deviation in NOISE.items()},
    prior_deviation={"position": 0.01, "speed": 0.01, "sway": 0.05, "rate": 0.05, "rope": 1.0, "bias": 0.05},
    process_deviation=DRIFT,
    bounds={"rope": Bound(lower=2.0, upper=10.0)},
)


def run(seconds: float, seed: int) -> Floats:
    """Return a row per sample: load (m), sway, its error (rad), rope's error (m), acceleration (m/s²)."""
    world = ca.Function("world", [CRANE.x, CRANE.u, CRANE.p], [integrate(CRANE, SAMPLE_TIME)])
    rng, state, rows = np.random.default_rng(seed), np.array([0.0, 0.0, 0.04, 0.0]), []
    estimator, controller = EstimationSolver(ESTIMATION, GUESS), ControlSolver(CONTROL)
    controller.y[:], controller.y[:, [0, 3]] = 0.0, TARGET
    push = 0.0
    for k in range(round(seconds / SAMPLE_TIME)):
        newest, noise = estimator.newest, rng.standard_normal(2)
        estimator.y[newest] = np.nan
        estimator.y[newest, 0] = state[0] + NOISE["position"] * noise[0]
        estimator.y[newest, 2] = state[3] + TRUTH[1] + NOISE["gyro"] * noise[1]
        estimator.feedback()
        estimate = estimator.x[newest].copy()

        controller.initial[:], controller.p[:], controller.y[:, 2] = estimate[:4], estimate[4:], estimate[5]
        if k == LISTENED:
            controller.start()
        if k >= LISTENED:
            controller.feedback()
            push = float(controller.u[0, 0])

        rows.append(
            [state[0] + TRUTH[0] * np.sin(state[2]), state[2], *(estimate[[2, 4]] - (state[2], TRUTH[0])), push]
        )
        state = world(state, push, TRUTH).full().ravel()
        estimator.y[newest, 4] = push
        estimator.advance()
        if k >= LISTENED:
            controller.advance()
    return np.array(rows)


if __name__ == "__main__":
    record, shown = run(seconds=30.0, seed=0), np.array([0, 10, 20, 30, 40, 60, 80, 100, 120, 150, 180, 299])
    table = np.column_stack([SAMPLE_TIME * shown, record[shown, 0], np.degrees(record[shown, 1:3]), record[shown, 3:]])
    print("time (s), load (m), sway (°), its error (°), rope's error (m), acceleration (m/s²)")
    print(np.array2string(table, precision=2, suppress_small=True))
    print(f"The load went to {record[:, 0].max():.3f} m at most; its bound is {WALL} m.")

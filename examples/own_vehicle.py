"""A vehicle of one's own, estimated and controlled with drawbar's solvers; docs/tutorial.md explains it.

A robot with a steered wheel and an askew compass drives a circle. Run: python examples/own_vehicle.py
"""

import math

import casadi as ca
import numpy as np

from drawbar.geometry import Floats, nearest_branch, wrap
from drawbar.optimal import Bound, ControlProblem, ControlSolver, EstimationProblem, EstimationSolver
from drawbar.vehicle.integrators import integrate
from drawbar.vehicle.model import Model, symbols, variables

SAMPLE_TIME, HORIZON, WINDOW = 0.1, 20, 20  # s; samples
WHEELBASE, RADIUS, LIMIT = 0.5, 5.0, 0.3  # m, m, rad
TRUTH = np.array([1.0, 0.12])  # m/s, rad: speed and askew compass, which the estimator has to find out
GUESS = np.array([6.5, 0.0, 1.3, 0.8, 0.0])  # m, m, rad, m/s, rad: what it starts from
DEVIATIONS = {"x": 0.03, "y": 0.03, "compass": 0.02, "speed": 0.05, "steering": 0.001}  # of the outputs: m, rad, m/s
STATES, INPUTS = variables(x="m", y="m", yaw="rad"), variables(steering="rad")
PARAMETERS = variables(speed="m/s", compass_offset="rad")
x, u, p = symbols(STATES), symbols(INPUTS), symbols(PARAMETERS)
ROBOT = Model(
    name="robot",
    states=STATES,
    inputs=INPUTS,
    parameters=PARAMETERS,
    outputs=variables(x="m", y="m", compass="rad", speed="m/s", steering="rad"),
    x=x,
    u=u,
    p=p,
    derivative=p[0] * ca.vertcat(ca.cos(x[2]), ca.sin(x[2]), ca.tan(u) / WHEELBASE),
    output=ca.vertcat(x[0], x[1], x[2] + p[1], p[0], u),
)
CONTROL = ControlProblem(
    model=ROBOT,
    horizon=HORIZON,
    sample_time=SAMPLE_TIME,
    weights={"x": 1.0, "y": 1.0, "compass": 0.0, "speed": 0.0, "steering": 0.5},
    terminal_weights={"x": 5.0, "y": 5.0, "compass": 0.0, "speed": 0.0},
    bounds={"steering": Bound(lower=-LIMIT, upper=LIMIT)},
)
ESTIMATION = EstimationProblem(
    model=ROBOT,
    horizon=WINDOW,
    sample_time=SAMPLE_TIME,
    weights={name: deviation**-2 for name, deviation in DEVIATIONS.items()},
    prior_deviation={"x": 0.1, "y": 0.1, "yaw": 0.3, "speed": 0.3, "compass_offset": 0.3},
    process_deviation={"x": 0.002, "y": 0.002, "yaw": 0.002, "speed": 0.005, "compass_offset": 1e-4},
    bounds={"compass_offset": Bound(lower=-0.3, upper=0.3)},
)


def circle(east: float, north: float, speed: float) -> Floats:
    """Return the reference (N+1, 2), m: the circle from the closest point on, at the robot's pace."""
    angles = math.atan2(north, east) + speed * SAMPLE_TIME / RADIUS * np.arange(HORIZON + 1)
    return RADIUS * np.column_stack([np.cos(angles), np.sin(angles)])


def run(seconds: float, seed: int) -> Floats:
    """Return a row per sample: distance from the circle (m), yaw error, offset error, steering (rad)."""
    world, rng = ca.Function("world", [x, u, p], [integrate(ROBOT, SAMPLE_TIME)]), np.random.default_rng(seed)
    state, rows = np.array([RADIUS + 1.5, 0.0, 0.5 * math.pi]), []
    estimator, controller = EstimationSolver(ESTIMATION, GUESS), ControlSolver(CONTROL)
    controller.initial[:], controller.p[:] = GUESS[:3], GUESS[3:]
    controller.start()
    for _ in range(round(seconds / SAMPLE_TIME)):
        newest, noise = estimator.newest, list(DEVIATIONS.values()) * rng.standard_normal(5)
        compass = nearest_branch(wrap(state[2] + TRUTH[1] + noise[2]), estimator.x[newest, 2])
        estimator.y[newest, :4] = *(state[:2] + noise[:2]), compass, TRUTH[0] + noise[3]
        estimator.feedback()
        east, north, yaw, speed, offset = estimator.x[newest].tolist()

        controller.initial[:], controller.p[:] = (east, north, yaw), (speed, offset)
        controller.y[:, :2], controller.y[:, 4] = circle(east, north, speed), math.atan(WHEELBASE / RADIUS)
        controller.feedback()
        steering = float(controller.u[0, 0])

        rows.append([math.hypot(*state[:2]) - RADIUS, yaw - state[2], offset - TRUTH[1], steering])
        state = world(state, steering, TRUTH).full().ravel()
        estimator.y[newest, 4] = steering
        estimator.advance()
        controller.advance()
    return np.array(rows)


if __name__ == "__main__":
    record, shown = run(seconds=60.0, seed=0), np.array([0, 5, 10, 20, 30, 40, 50, 100, 200, 400, 599])
    table = np.column_stack([SAMPLE_TIME * shown, 100.0 * record[shown, 0], np.degrees(record[shown, 1:])])
    print("time (s), distance (cm), yaw error (°), offset error (°), steering (°)")
    print(np.array2string(table, precision=2, suppress_small=True))
    held, distance = np.abs(record[:, 3]) > LIMIT - 1e-6, np.abs(record[100:, 0]).mean()
    print(f"{held.sum()} of {len(record)} samples on the bound; mean distance after 10 s: {100.0 * distance:.2f} cm.")

"""A vehicle of one's own, estimated and controlled with drawbar's solvers; docs/tutorial.md explains it.

A robot with a steered wheel drives a circle. It knows its position within 3 cm and its heading from a compass
that was mounted askew. Run: python examples/own_vehicle.py
"""

import math

import casadi as ca
import numpy as np

from drawbar.geometry import Floats, nearest_branch, wrap
from drawbar.optimal import Bound, ControlProblem, ControlSolver, EstimationProblem, EstimationSolver
from drawbar.vehicle.model import Model, integrate, symbols, variables

SAMPLE_TIME, HORIZON, WINDOW = 0.1, 20, 20  # s; samples
WHEELBASE, RADIUS, LIMIT = 0.5, 5.0, 0.3  # m, m, rad
TRUTH = np.array([1.0, 0.12])  # m/s, rad: speed and askew compass, which the estimator has to find out
GUESS = np.array([6.5, 0.0, 1.3, 0.8, 0.0])  # m, m, rad, m/s, rad: what it starts from
DEVIATIONS = np.array([0.03, 0.03, 0.02, 0.05, 0.001])  # of the outputs: m, m, rad, m/s, rad
ANGLES = ("yaw error", "offset error", "steering")


def robot() -> Model:
    """Return the kinematic bicycle with its sensors."""
    states, inputs = variables(x="m", y="m", yaw="rad"), variables(steering="rad")
    parameters = variables(speed="m/s", compass_offset="rad")
    x, u, p = symbols(states), symbols(inputs), symbols(parameters)
    yaw, speed, offset = x[2], p[0], p[1]
    return Model(
        name="robot",
        states=states,
        inputs=inputs,
        parameters=parameters,
        outputs=variables(x="m", y="m", compass="rad", speed="m/s", steering="rad"),
        x=x,
        u=u,
        p=p,
        derivative=speed * ca.vertcat(ca.cos(yaw), ca.sin(yaw), ca.tan(u) / WHEELBASE),
        output=ca.vertcat(x[0], x[1], yaw + offset, speed, u),
    )


MODEL = robot()
CONTROL = ControlProblem(
    model=MODEL,
    horizon=HORIZON,
    sample_time=SAMPLE_TIME,
    weights=(1.0, 1.0, 0.0, 0.0, 0.5),
    terminal_weights=(5.0, 5.0, 0.0, 0.0, 0.0),
    bounds={"steering": Bound(lower=-LIMIT, upper=LIMIT)},
)
ESTIMATION = EstimationProblem(
    model=MODEL,
    horizon=WINDOW,
    sample_time=SAMPLE_TIME,
    weights=tuple((DEVIATIONS**-2).tolist()),
    prior_deviation=(0.1, 0.1, 0.3, 0.3, 0.3),
    process_deviation=(0.002, 0.002, 0.002, 0.005, 1e-4),
    bounds={"compass_offset": Bound(lower=-0.3, upper=0.3)},
)


def circle(x: float, y: float, speed: float) -> Floats:
    """Return the reference (N+1, 2), m: the circle from the closest point on, at the robot's pace."""
    angles = math.atan2(y, x) + speed * SAMPLE_TIME / RADIUS * np.arange(HORIZON + 1)
    return RADIUS * np.column_stack([np.cos(angles), np.sin(angles)])


def run(seconds: float, seed: int) -> Floats:
    """Return a row per sample: distance from the circle (m), yaw error, offset error, steering (rad)."""
    world = ca.Function("world", [MODEL.x, MODEL.u, MODEL.p], [integrate(MODEL, SAMPLE_TIME)])
    state, rng, newest, rows = (
        np.array([RADIUS + 1.5, 0.0, 0.5 * math.pi]),
        np.random.default_rng(seed),
        0,
        [],
    )
    estimator, controller = EstimationSolver(ESTIMATION, GUESS), ControlSolver(CONTROL)
    controller.x[:], controller.p[:] = GUESS[:3], GUESS[3:]
    estimator.prepare()
    controller.prepare()
    for _ in range(round(seconds / SAMPLE_TIME)):
        noise = DEVIATIONS * rng.standard_normal(5)
        compass = nearest_branch(wrap(state[2] + TRUTH[1] + noise[2]), estimator.x[newest, 2])
        estimator.y[newest, :4] = *(state[:2] + noise[:2]), compass, TRUTH[0] + noise[3]
        estimator.feedback()
        x, y, yaw, speed, offset = estimator.x[newest].tolist()

        controller.initial[:], controller.p[:] = (x, y, yaw), (speed, offset)
        controller.y[:, :2] = circle(x, y, speed)
        controller.y[:, 4] = math.atan(WHEELBASE / RADIUS)
        controller.feedback()
        steering = float(controller.u[0, 0])

        rows.append([math.hypot(*state[:2]) - RADIUS, yaw - state[2], offset - TRUTH[1], steering])
        state = world(state, steering, TRUTH).full().ravel()
        estimator.y[newest, 4] = steering
        if newest == WINDOW:
            estimator.absorb()
            estimator.shift()
        newest = min(newest + 1, WINDOW)
        estimator.prepare()
        controller.shift()
        controller.prepare()
    return np.array(rows)


if __name__ == "__main__":
    record = run(seconds=60.0, seed=0)
    for k in (0, 5, 10, 20, 30, 40, 50, 100, 200, 400, 599):
        distance, *angles = record[k]
        shown = ", ".join(f"{name} {angle:5.1f}°" for name, angle in zip(ANGLES, np.degrees(angles), strict=True))
        print(f"{k * SAMPLE_TIME:4.1f} s: distance {100.0 * distance:6.1f} cm, {shown}")
    print(f"On the bound: {np.sum(np.abs(record[:, 3]) > LIMIT - 1e-6)} of {len(record)} samples.")
    print(f"Mean distance from the circle after 10 s: {100.0 * np.abs(record[100:, 0]).mean():.2f} cm.")

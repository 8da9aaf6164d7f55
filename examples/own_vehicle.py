"""A small vehicle of one's own, estimated and controlled with drawbar's solvers; docs/tutorial.md explains it.

A robot with a steered wheel drives a circle. It knows its position within 3 cm, and its heading from a compass
that was mounted a few degrees askew. Run: python examples/own_vehicle.py
"""

import math

import casadi as ca
import numpy as np

from drawbar.geometry import Floats, nearest_branch, wrap
from drawbar.optimal import Bound, ControlProblem, ControlSolver, EstimationProblem, EstimationSolver
from drawbar.vehicle.model import Model, integrate, symbols, variables

SAMPLE_TIME, HORIZON, WINDOW = 0.1, 20, 20  # s; samples
WHEELBASE, RADIUS, LIMIT = 0.5, 5.0, 0.3  # m, m, rad
TRUE_SPEED, TRUE_OFFSET = 1.0, 0.12  # m/s, rad: what the estimator has to find out
DEVIATIONS = np.array([0.03, 0.03, 0.02, 0.05, 1e-3])  # of the outputs: m, m, rad, m/s, rad


def robot() -> Model:
    """Return the kinematic bicycle with its sensors."""
    states = variables(x="m", y="m", yaw="rad")
    inputs = variables(steering="rad")
    parameters = variables(speed="m/s", compass_offset="rad")
    outputs = variables(x="m", y="m", compass="rad", speed="m/s", steering="rad")
    x, u, p = symbols(states), symbols(inputs), symbols(parameters)
    yaw, speed, offset = x[2], p[0], p[1]
    return Model(
        name="robot",
        states=states,
        inputs=inputs,
        parameters=parameters,
        outputs=outputs,
        x=x,
        u=u,
        p=p,
        derivative=speed * ca.vertcat(ca.cos(yaw), ca.sin(yaw), ca.tan(u) / WHEELBASE),
        output=ca.vertcat(x[0], x[1], yaw + offset, speed, u),
    )


def control_problem(model: Model) -> ControlProblem:
    """Weigh the distance to the reference and a little the steering, which is bounded."""
    return ControlProblem(
        model=model,
        horizon=HORIZON,
        sample_time=SAMPLE_TIME,
        weights=(1.0, 1.0, 0.0, 0.0, 0.5),
        terminal_weights=(5.0, 5.0, 0.0, 0.0, 0.0),
        bounds={"steering": Bound(lower=-LIMIT, upper=LIMIT)},
    )


def estimation_problem(model: Model) -> EstimationProblem:
    """Weigh each output by its sensor; states first, then parameters."""
    return EstimationProblem(
        model=model,
        horizon=WINDOW,
        sample_time=SAMPLE_TIME,
        weights=tuple((DEVIATIONS**-2).tolist()),
        prior_deviation=(0.1, 0.1, 0.3, 0.3, 0.3),
        process_deviation=(0.002, 0.002, 0.002, 0.005, 1e-4),
        bounds={"compass_offset": Bound(lower=-0.3, upper=0.3)},
    )


def circle(x: float, y: float, speed: float) -> Floats:
    """Return the reference positions (N+1, 2), m: the circle from the closest point on, at the robot's pace."""
    angles = math.atan2(y, x) + speed * SAMPLE_TIME / RADIUS * np.arange(HORIZON + 1)
    return RADIUS * np.column_stack([np.cos(angles), np.sin(angles)])


def measure(truth: Floats, expected_yaw: float, rng: np.random.Generator) -> Floats:
    """Return x, y, compass, speed (4,) with noise; a compass wraps, the estimator's yaw does not."""
    exact = np.array([*truth[:2], truth[2] + TRUE_OFFSET, TRUE_SPEED])
    reading = exact + DEVIATIONS[:4] * rng.standard_normal(4)
    reading[2] = nearest_branch(wrap(reading[2]), expected_yaw)
    return reading


def start() -> tuple[EstimationSolver, ControlSolver]:
    """Return both solvers, prepared for the first sample with what is known of a robot at rest."""
    model, guess = robot(), np.array([6.5, 0.0, 1.3, 0.8, 0.0])
    estimator, controller = (
        EstimationSolver(estimation_problem(model), guess),
        ControlSolver(control_problem(model)),
    )
    estimator.prepare()
    controller.x[:], controller.p[:] = guess[:3], guess[3:]
    controller.prepare()
    return estimator, controller


def advance(estimator: EstimationSolver, newest: int) -> int:
    """Make room for the next measurement and prepare; return its row in the window."""
    if newest == WINDOW:
        estimator.absorb()
        estimator.shift()
    estimator.prepare()
    return min(newest + 1, WINDOW)


def run(seconds: float, seed: int) -> Floats:
    """Return a row per sample: distance from the circle (m), yaw and offset error (rad), steering (rad)."""
    model, rng, newest = robot(), np.random.default_rng(seed), 0
    world = ca.Function("world", [model.x, model.u, model.p], [integrate(model, SAMPLE_TIME)])
    truth, rows = np.array([RADIUS + 1.5, 0.0, 0.5 * math.pi]), []
    estimator, controller = start()
    for _ in range(round(seconds / SAMPLE_TIME)):
        estimator.y[newest, :4] = measure(truth, estimator.x[newest, 2], rng)
        estimator.feedback()
        x, y, yaw, speed, offset = estimator.x[newest].tolist()

        controller.initial[:] = x, y, yaw
        controller.p[:] = speed, offset
        controller.y[:, :2] = circle(x, y, speed)
        controller.y[:, 4] = math.atan(WHEELBASE / RADIUS)
        controller.feedback()
        steering = float(controller.u[0, 0])

        rows.append([math.hypot(*truth[:2]) - RADIUS, yaw - truth[2], offset - TRUE_OFFSET, steering])
        truth = world(truth, steering, [TRUE_SPEED, TRUE_OFFSET]).full().ravel()
        estimator.y[newest, 4] = steering
        newest = advance(estimator, newest)
        controller.shift()
        controller.prepare()
    return np.array(rows)


if __name__ == "__main__":
    record = run(seconds=60.0, seed=0)
    print(" time    distance  yaw error  offset error  steering")
    for k in (0, 5, 10, 20, 30, 40, 50, 100, 200, 400, 599):
        distance, *angles = record[k].tolist()
        print(
            "{:4.1f} s {:8.1f} cm {:9.2f}° {:12.2f}° {:8.1f}°".format(
                k * SAMPLE_TIME, 100.0 * distance, *map(math.degrees, angles)
            )
        )
    held = np.abs(record[:, 3]) > LIMIT - 1e-6
    print(f"On the bound: {held.sum()} of {len(record)} samples.")
    print(f"Mean distance from the circle after 10 s: {100.0 * np.abs(record[100:, 0]).mean():.2f} cm.")

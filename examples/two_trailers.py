"""A car reverses two trailers to a line beside it; docs/tutorial-constraints.md explains it.

Reversing, each joint by itself would fold up. The car's front has to stay within its lane while it swings out.
Run: python examples/two_trailers.py
"""

import casadi as ca
import numpy as np

from drawbar.geometry import Floats
from drawbar.optimal import Bound, ControlProblem, ControlSolver
from drawbar.vehicle.integrators import integrate
from drawbar.vehicle.model import declare, variables

SAMPLE_TIME, HORIZON, SPEED = 0.2, 60, -1.0  # s; samples; m/s
WHEELBASE, FIRST, SECOND = 2.7, 3.0, 4.0  # m: car, trailers from joint to axle
STEERING, RATE, FOLDED = np.radians([35.0, 30.0, 40.0])  # rad, rad/s, rad
LANE = 2.0  # m, to the right of the line that is to be reached
START = np.array([0.0, -1.5, 0.0, 0.0, 0.0])


def equations(x, u, p):
    """Return the motion of the last axle, its yaw and both joints' angles; the joints sit on the axles before them."""
    _, north, yaw, first, second = ca.vertsplit(x)  # first: car against first trailer, second: trailers
    middle, slow = yaw + second, SPEED * ca.cos(first)
    turns = SPEED * ca.tan(u) / WHEELBASE, SPEED * ca.sin(first) / FIRST, slow * ca.sin(second) / SECOND
    back = slow * ca.cos(second)
    front = north + SECOND * ca.sin(yaw) + FIRST * ca.sin(middle) + WHEELBASE * ca.sin(middle + first)
    moved = (back * ca.cos(yaw), back * ca.sin(yaw), turns[2], turns[0] - turns[1], turns[1] - turns[2])
    return ca.vertcat(*moved), ca.vertcat(north, yaw, first, second, front, u)


ROAD_TRAIN = declare(
    "road_train",
    states=variables(east="m", north="m", yaw="rad", first="rad", second="rad"),
    inputs=variables(steering="rad"),
    parameters=(),
    outputs=variables(north="m", yaw="rad", first="rad", second="rad", front="m", steering="rad"),
    equations=equations,
)
FOLD = Bound(lower=-FOLDED, upper=FOLDED, linear_penalty=100.0)
CONTROL = ControlProblem(
    model=ROAD_TRAIN,
    horizon=HORIZON,
    sample_time=SAMPLE_TIME,
    weights={"north": 1.0, "yaw": 1.0, "first": 0.1, "second": 0.1, "front": 0.0, "steering": 0.01},
    terminal_weights={"north": 10.0, "yaw": 100.0, "first": 100.0, "second": 100.0, "front": 0.0},
    bounds={
        "steering": Bound(lower=-STEERING, upper=STEERING),
        "first": FOLD,
        "second": FOLD,
        "front": Bound(lower=-LANE, upper=np.inf, linear_penalty=100.0),
    },
    change_weights={"steering": 1.0},
    change_bounds={"steering": Bound(lower=-RATE * SAMPLE_TIME, upper=RATE * SAMPLE_TIME)},
)


def run(seconds: float) -> Floats:
    """Return a row per sample: last axle's east, north (m), joints (rad), front's north (m), steering (rad)."""
    world = ca.Function("world", [ROAD_TRAIN.x, ROAD_TRAIN.u], [integrate(ROAD_TRAIN, SAMPLE_TIME)])
    front = ca.Function("front", [ROAD_TRAIN.x], [ROAD_TRAIN.output[4]])
    controller, state, rows = ControlSolver(CONTROL), START, []
    controller.initial[:], controller.y[:] = state, 0.0
    controller.start()
    solution = controller.solve()
    print(f"first plan: {solution.steps} steps, largest residual {solution.residuals.largest:.0e}")
    for _ in range(round(seconds / SAMPLE_TIME)):
        controller.initial[:] = state
        controller.feedback()
        steering = float(controller.u[0, 0])
        rows.append([*state[:2], *state[3:], float(front(state)), steering])
        state = world(state, steering).full().ravel()
        controller.advance()
    return np.array(rows)


if __name__ == "__main__":
    record, shown = run(seconds=40.0), np.array([0, 5, 10, 20, 30, 40, 60, 80, 100, 150, 199])
    table = np.column_stack([SAMPLE_TIME * shown, record[shown, :2], np.degrees(record[shown, 2:4]), record[shown, 4]])
    print("time (s), east (m), north (m), first joint (°), second joint (°), front (m), steering (°)")
    print(np.array2string(np.column_stack([table, np.degrees(record[shown, 5])]), precision=2, suppress_small=True))

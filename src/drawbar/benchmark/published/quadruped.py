"""Forces of a quadruped's feet that carry its body along: the structure and the gaits of QUADCMPC1 to 4.

States are the body's position, attitude and their rates, then what friction leaves of each foot's last horizontal
force, so that cones are boxes; inputs are the forces of four feet. Forces cost nothing: with all feet on the ground
they are redundant. A foot in the air has equal bounds.
"""

from collections.abc import Iterator
from itertools import chain, repeat

import numpy as np

from drawbar.benchmark.published.tracking import Box, tracking_problem
from drawbar.geometry import Floats
from drawbar.optimal.stage_problem import StageProblem

_DIAGONALS = ((True, False, False, True), (False, True, True, False))
GAITS = (
    (((8, _DIAGONALS[0]), (8, _DIAGONALS[1]), (8, _DIAGONALS[0]), (8, _DIAGONALS[1])), 0.1),
    (((12, _DIAGONALS[0]), (12, _DIAGONALS[1])), 0.1),
    (((16, (True,) * 4),), 0.0),
    (((8, _DIAGONALS[0]), (8, _DIAGONALS[1])), 0.0),
)
"""samples with so many feet on the ground, and the speed that is asked for, m/s"""
PERIOD, MASS, GRAVITY, FRICTION, MOST_FORCE = 0.02, 2.5, 9.81, 0.9, 25.0
INERTIA = np.diag([0.031, 0.051, 0.07])
HEIGHT = 0.2
FEET = np.array([[0.19, 0.15, -HEIGHT], [0.19, -0.15, -HEIGHT], [-0.19, 0.15, -HEIGHT], [-0.19, -0.15, -HEIGHT]])
WEIGHTS = np.array([2.0, 2.0, 20.0, 0.25, 0.25, 10.0, 0.2, 0.2, 0.2, 0.0, 0.0, 0.3])
CONES = 16
"""each foot's four sides"""
_SIDES = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])


def problems() -> Iterator[StageProblem]:
    """Return the four problems."""
    for gait, speed in GAITS:
        yield _problem(list(chain.from_iterable(repeat(feet, count) for count, feet in gait)), speed)


def _turning(arm: Floats) -> Floats:
    """Return the matrix (3, 3) that makes a force at the arm its torque."""
    x, y, z = arm
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _dynamics(stages: int, speed: float) -> tuple[Floats, Floats]:
    """Return A (28, 28) and B (N, 28, 12); the body moves on from where its feet stand, a step of 16 samples long."""
    A, B = np.zeros((12 + CONES, 12 + CONES)), np.zeros((stages, 12 + CONES, 12))
    A[:12, :12] = np.eye(12) + PERIOD * np.eye(12, k=6)
    rows = np.hstack([-_SIDES, np.full((4, 1), FRICTION)])
    for foot, place in enumerate(FEET):
        own = slice(3 * foot, 3 * foot + 3)
        B[:, 6:9, own] = PERIOD / MASS * np.eye(3)
        for k in range(stages):
            moved = place - [speed * PERIOD * (k % 16 - 8), 0.0, 0.0]
            B[k, 9:12, own] = PERIOD * np.linalg.solve(INERTIA, _turning(moved))
        B[:, 12 + 4 * foot : 16 + 4 * foot, own] = rows
    return A, B


def _problem(contacts: list[tuple[bool, ...]], speed: float) -> StageProblem:
    stages = len(contacts)
    A, B = _dynamics(stages, speed)
    target = np.zeros((stages + 1, 12 + CONES))
    target[:, 0], target[:, 2], target[:, 6] = speed * PERIOD * np.arange(stages + 1), HEIGHT, speed
    initial = target[0] + np.concatenate([[0.0, 0.005, -0.004, 0.02, -0.01, 0.01], np.zeros(6 + CONES)])
    Q = np.zeros((stages + 1, 12 + CONES, 12 + CONES))
    Q[:, range(12), range(12)] = WEIGHTS
    boxes = []
    for k, feet in enumerate(contacts):
        for foot, down in enumerate(feet):
            limits = ((-np.inf, np.inf), (-np.inf, np.inf), (0.0, MOST_FORCE)) if down else ((0.0, 0.0),) * 3
            boxes += [Box.input(k, 3 * foot + axis, *limit) for axis, limit in enumerate(limits)]
            boxes += [Box.state(k + 1, 12 + 4 * foot + side, 0.0, np.inf) for side in range(4)]
    problem = tracking_problem(A, B, Q, np.zeros((12, 12)), target, initial, boxes)
    problem.c[:, 8] = -PERIOD * GRAVITY
    return problem

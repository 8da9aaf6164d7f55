"""Families of problems of the benchmark: three, made as in its generators and the papers behind them.

LIPMWALK: a biped's point mass at constant height, moved by jerk, whose zero-moment point stays in its footholds
(Wieber 2006; Caron et al. 2019). WHLIPBAL: a balancing pendulum on wheels (Caron et al. 2023). QUADCMPC: forces of a
quadruped's feet (Leziart 2022), of which the gaits and speeds are those published; the robot's numbers are our own.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from drawbar.benchmark.hostile.solvers import clarabel
from drawbar.benchmark.published import quadruped
from drawbar.benchmark.published.tracking import Box, tracking_problem
from drawbar.geometry import Floats
from drawbar.optimal.stage_problem import StageProblem

GRAVITY = 9.81
SAMPLES = 30
"""problems of a family that is sampled along a closed loop"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Published:
    """One problem of the benchmark."""

    name: str
    family: str
    problem: StageProblem


def families() -> Iterator[Published]:
    """Return all problems of all families."""
    for family, problems in (("LIPMWALK", walking()), ("WHLIPBAL", balancing()), ("QUADCMPC", quadruped.problems())):
        for number, problem in enumerate(problems):
            yield Published(name=f"{family}{number}", family=family, problem=problem)


def _first_input(problem: StageProblem) -> float:
    z = clarabel(problem).z
    assert z is not None
    return float(problem.split(z)[1][0, 0])


def walking() -> Iterator[StageProblem]:
    """Return the walk's problems: states are zero-moment point, velocity and acceleration, so that boxes hold it."""
    period, stages, height, half_foot, stride, support = 0.1, 16, 0.84, 0.0325, 0.18, 8
    point = np.array([[1.0, 0.0, -height / GRAVITY], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    back = np.linalg.inv(point)
    A = point @ np.array([[1.0, period, period**2 / 2], [0.0, 1.0, period], [0.0, 0.0, 1.0]]) @ back
    B = point @ np.array([[period**3 / 6], [period**2 / 2], [period]])
    frequency, foot, phase = np.sqrt(GRAVITY / height), stride / 2, 5
    x = point @ np.array([0.0, 0.5 * frequency * foot, -(frequency**2) * foot])
    for _ in range(SAMPLES):
        step = (phase + np.arange(stages + 1)) // support  # first sample of a step: both feet on the ground
        feet = np.where(step % 2 == 0, foot, -foot)
        one_foot = (phase + np.arange(stages + 1)) % support > 0
        boxes = [Box.state(k, 0, feet[k] - half_foot, feet[k] + half_foot) for k in range(1, stages) if one_foot[k]]
        target = np.zeros((stages + 1, 3))
        target[stages, 0] = feet[stages - 1]
        Q = np.zeros((stages + 1, 3, 3))
        Q[stages] = back.T @ back
        problem = tracking_problem(A, B, Q, 1e-3 * np.eye(1), target, x, boxes)
        yield problem
        x = A @ x + B[:, 0] * _first_input(problem)
        phase += 1
        if phase == support:
            phase, foot = 0, -foot


def balancing() -> Iterator[StageProblem]:
    """Return the pendulum's problems: states are ground position, pitch and their rates; input, ground acceleration."""
    period, stages, length, most, substeps = 0.02, 50, 0.58, 10.0, 15
    w = np.sqrt(GRAVITY / length)
    c, s = np.cosh(period * w), np.sinh(period * w)
    A = np.array([[1.0, 0.0, period, 0.0], [0.0, c, 0.0, s / w], [0.0, 0.0, 1.0, 0.0], [0.0, w * s, 0.0, c]])
    B = np.array([[period**2 / 2], [-(c - 1.0) / GRAVITY], [period], [-w * s / GRAVITY]])
    Q = np.repeat(np.eye(4)[None], stages + 1, axis=0)
    Q[stages] *= 10.0
    boxes = [Box.input(k, 0, -most, most) for k in range(stages)]
    x = np.zeros(4)
    for sample in range(SAMPLES):
        speed = 0.5 + np.cos(0.5 * sample * period)
        target = np.zeros((stages + 1, 4))
        target[:, 0], target[:, 2] = x[0] + np.arange(stages + 1) * period * speed, speed
        problem = tracking_problem(A, B, Q, 1e-3 * np.eye(1), target, x, boxes)
        yield problem
        x = _rolled(x, _first_input(problem), w, period / substeps, substeps)


def _rolled(x: Floats, push: float, w: float, step: float, steps: int) -> Floats:
    """Return the pendulum's state after steps of constant acceleration, its pitch not linearised."""
    for _ in range(steps):
        rate = np.array([push, w**2 * (np.sin(x[1]) - push / GRAVITY * np.cos(x[1]))])
        x = np.concatenate([x[:2] + step * (x[2:] + 0.5 * step * rate), x[2:] + step * rate])
    return x

"""Random starts beside the path that face away from it: a key of the configuration has one start for all seeds."""

import math
from dataclasses import replace

import numpy as np

from drawbar.config import StartSettings
from drawbar.guidance.path import Path
from drawbar.simulation import Simulation, build_machine

BESIDE = 3.0
"""largest distance from the path, m"""
TURNED = (math.pi / 3.0, math.pi)
"""between which the tractor is turned away, to either side, rad"""
AHEAD = 60.0
"""m of the path that are driven"""


def beside_a_straight(simulation: Simulation) -> None:
    """Start beside one of the straights."""
    _start_beside(simulation, ("straight",))


def beside_a_curve(simulation: Simulation) -> None:
    """Start beside one of the curves."""
    _start_beside(simulation, ("0.1", "0.125", "0.15"))


def _start_beside(simulation: Simulation, classes: tuple[str, ...]) -> None:
    """Start at a random pose beside a part of these classes, with all joints straight, and drive what lies ahead."""
    random = np.random.default_rng([simulation.seed, 1])  # another stream than the machine's
    simulation.path = _cut(simulation.path, classes, random)
    yaw = random.choice((-1.0, 1.0)) * random.uniform(*TURNED)
    start = StartSettings(left=random.uniform(-BESIDE, BESIDE), yaw=yaw)
    simulation.configuration = simulation.configuration.model_copy(update={"start": start})
    simulation.machine = build_machine(simulation.configuration, simulation.path, simulation.seed)
    simulation.autopilot.begin(simulation.path)


def _cut(path: Path, classes: tuple[str, ...], random: np.random.Generator) -> Path:
    """Return what lies ahead of a random node of these classes."""
    at = path.nodes[:-1, 0]
    beginnings = np.flatnonzero(np.isin(path.labels(at), classes) & (at <= path.length - AHEAD))
    first = int(random.choice(beginnings))
    last = int(np.searchsorted(path.nodes[:, 0], at[first] + AHEAD))
    nodes = np.ascontiguousarray(path.nodes[first : last + 1] - [at[first], 0.0, 0.0, 0.0])
    return replace(path, nodes=nodes, label_of_piece=path.label_of_piece[first:last])

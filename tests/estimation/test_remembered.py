"""Driving with what earlier drives found of the steerings: true, or not true any more.

`python tests/estimation/test_remembered.py` prints the table of
docs/theory/identification.md.
"""

import numpy as np

from drawbar.config import load_configuration
from drawbar.report.path_errors import project_track
from drawbar.simulation import Simulation

RATE = 0.4363
"""of the front wheels as stated, rad/s"""
CASES = {
    "half of the stated rate": (f"machine.actuators.tractor_rate={RATE / 2:.3f}", f"tractor.rate={RATE / 2:.3f}"),
    "a third": (f"machine.actuators.tractor_rate={RATE / 3:.3f}", f"tractor.rate={RATE / 3:.3f}"),
    "a quarter": (f"machine.actuators.tractor_rate={RATE / 4:.3f}", f"tractor.rate={RATE / 4:.3f}"),
    "dead time 0.4 s": ("machine.actuators.dead_time=0.4", "tractor.dead_time=0.4"),
}
"""what is true of the machine, and what is remembered of it"""
LINES = {2.0: ("speed=2.0", "path.radii=[8.0]"), 3.0: ("speed=3.0", "path.radii=[12.0]")}
SEEDS = range(6)


def farthest(*changes: str) -> float:
    """Return the largest distance of the tractor from the line, over all seeds, m."""
    return max(_farthest(seed, *changes) for seed in SEEDS)


def _farthest(seed: int, *changes: str) -> float:
    with Simulation(load_configuration("articulated", changes), seed) as simulation:
        places = [(step.truth.tractor.x, step.truth.tractor.y) for step in simulation.steps() if step.truth]
    x, y = np.transpose(places)
    return float(np.abs(project_track(simulation.path, x, y, 0.0).error).max())


def test_front_wheels_that_are_known_to_be_slow_keep_the_line_from_the_first_metre() -> None:
    slow, known = CASES["a third"]
    assert farthest(*LINES[2.0], slow) > 0.25
    assert farthest(*LINES[2.0], slow, f"actuation.remembered.{known}") < 0.2


def test_what_is_not_true_any_more_costs_no_more_than_it_would_if_it_were() -> None:
    _, stale = CASES["a third"]
    assert farthest(*LINES[2.0], f"actuation.remembered.{stale}") < 0.2


if __name__ == "__main__":
    for case, (true, memory) in CASES.items():
        remembered = f"actuation.remembered.{memory}"
        for speed, line in LINES.items():
            figures = [100.0 * farthest(*line, *more) for more in ([true], [true, remembered], [remembered])]
            print(f"| {case} | {speed:.0f} m/s | {'; '.join(f'{each:.0f}' for each in figures)} |")

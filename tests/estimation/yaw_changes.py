"""The largest change of two antennas' heading that is taken for one, by sound sensors in an experiment's variants.

`python tests/estimation/yaw_changes.py ground physics robustness` drives each variant of these experiments with two
antennas on the tractor, 3° askew, and a measured roll, and prints the largest change over seeds 0 and 1, degrees.
"""

import math
import sys
import tomllib
from contextlib import suppress
from pathlib import Path

from drawbar.config import load_configuration
from drawbar.simulation import RunAborted, Simulation

EXPERIMENTS = Path(__file__).parents[2] / "experiments"


def largest_change(changes: list[str], seed: int) -> float:
    """Return the largest change that was shown in a run, degrees."""
    configuration = load_configuration("articulated", changes)
    given = configuration.machine.attitude
    tractor = given.tractor.model_copy(update={"present": True})
    yaw = given.yaw.model_copy(update={"present": True, "bias": 0.05})
    attitude = given.model_copy(update={"tractor": tractor, "yaw": yaw})
    machine = configuration.machine.model_copy(update={"attitude": attitude})
    simulation = Simulation(configuration.model_copy(update={"machine": machine}), seed)
    change, largest = simulation.autopilot.library.components["alignment"].live.array("yaw.change"), 0.0
    with suppress(RunAborted):  # what the variant is about may end it
        for _ in simulation.steps():
            largest = max(largest, abs(float(change[0])))
    return math.degrees(largest)


def main() -> None:
    """Print the largest change of each variant."""
    for name in sys.argv[1:]:
        experiment = tomllib.loads((EXPERIMENTS / name / "experiment.toml").read_text("utf-8"))
        for variant in experiment["variants"]:
            changes = [*experiment.get("changes", []), *variant.get("changes", [])]
            print(f"{max(largest_change(changes, seed) for seed in (0, 1)):.2f}° {name}: {variant['name']}", flush=True)


if __name__ == "__main__":
    main()

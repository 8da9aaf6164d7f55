"""How far a hitch angle that is later than it tells takes the tractor from its line, uncorrected and corrected.

`python tests/estimation/late_hitch.py 0.2 3.0` drives figure-eights of 8 m with a latency of 0.2 s at 3 m/s, on the
simulated chain and in the physics, without and with a yaw-rate sensor, and prints the largest distance of three seeds,
cm; *: a run was stopped. docs/theory/identification.md has its table.
"""

import sys
from contextlib import suppress

import numpy as np

from drawbar.config import load_configuration
from drawbar.guidance.path import Path
from drawbar.report.path_errors import project_track
from drawbar.signals.record import StepRecord
from drawbar.simulation import RunAborted, Simulation

YAW_RATE = "machine.attitude={tractor={present=true},trailer={present=true}}"
MACHINES = {
    "chain": (),
    "chain, yaw-rate sensor": (YAW_RATE,),
    "physics": ("machine.kind=physics",),
    "physics, yaw-rate sensor": ("machine.kind=physics", YAW_RATE),
}


def furthest(changes: list[str], seed: int, *, corrected: bool) -> tuple[float, bool]:
    """Return the tractor's largest distance from the line, m, and whether the run was stopped."""
    simulation, records = Simulation(load_configuration("articulated", changes), seed), list[StepRecord]()
    latency = simulation.autopilot.library.components["alignment"].live.array("hitch.latency")
    with suppress(RunAborted):
        for record in simulation.steps():
            records.append(record)
            latency[0] *= corrected
        return _distance(simulation.path, records), False
    return _distance(simulation.path, records), True


def _distance(path: Path, records: list[StepRecord]) -> float:
    places = np.array([(each.truth.tractor.x, each.truth.tractor.y) for each in records if each.truth is not None])
    return float(np.nanmax(np.abs(project_track(path, places[:, 0], places[:, 1], 0.0).error)))


def main() -> None:
    """Print one line of each machine."""
    latency, speed = sys.argv[1:]
    late = f"machine.delays={{hitch_angle={{latency={latency}}},reported=false}}"
    for name, changes in MACHINES.items():
        told = []
        for corrected in (False, True):
            runs = [
                furthest(["path.radii=[8.0]", f"speed={speed}", late, *changes], seed, corrected=corrected)
                for seed in range(3)
            ]
            told.append(f"{100.0 * max(way for way, _ in runs):.0f}{'*' if any(ended for _, ended in runs) else ''}")
        print(f"{name}: {'; '.join(told)}", flush=True)


if __name__ == "__main__":
    main()

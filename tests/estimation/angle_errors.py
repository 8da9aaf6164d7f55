"""How far errors of hitch and joint that nothing tells take the tractor from its line, uncorrected and corrected.

`python tests/estimation/angle_errors.py 3.0 --late 0.2` drives figure-eights of 8 m at 3 m/s with a hitch angle that is
0.2 s late, `2.0 --hitch 0.8` at 2 m/s with a hitch sensor that shows 0.8 of its angle, `--joint` the same of the joint,
which is moved by what its sensor shows; on the simulated chain and in the physics, without and with a yaw-rate sensor.
Prints the largest distance of three seeds, cm; *: a run was stopped. docs/theory/identification.md has its tables.
"""

import argparse
import sys
from contextlib import suppress
from pathlib import Path as FilePath

import numpy as np

from drawbar.guidance.path import Path
from drawbar.report.path_errors import project_track
from drawbar.signals import StepRecord
from drawbar.simulation import RunAborted, Simulation

sys.path.insert(0, str(FilePath(__file__).parents[1] / "harness"))
from scaled_sensors import simulation

YAW_RATE = "machine.attitude={tractor={present=true},trailer={present=true}}"
MACHINES = {
    "chain": (),
    "chain, yaw-rate sensor": (YAW_RATE,),
    "physics": ("machine.kind=physics",),
    "physics, yaw-rate sensor": ("machine.kind=physics", YAW_RATE),
}


def furthest(run: Simulation, *, corrected: bool) -> tuple[float, bool]:
    """Return the tractor's largest distance from the line, m, and whether the run was stopped."""
    live, records = run.autopilot.library.components["alignment"].live, list[StepRecord]()
    with suppress(RunAborted):
        for record in run.steps():
            records.append(record)
            for name in ("angles.latency", "angles.scales"):
                live.array(name)[...] *= corrected
        return _distance(run.path, records), False
    return _distance(run.path, records), True


def _distance(path: Path, records: list[StepRecord]) -> float:
    places = np.array([(each.truth.tractor.x, each.truth.tractor.y) for each in records if each.truth is not None])
    return float(np.nanmax(np.abs(project_track(path, places[:, 0], places[:, 1], 0.0).error)))


def main() -> None:
    """Print one line of each machine."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("speed", type=float)
    parser.add_argument("--late", type=float, default=0.0)
    parser.add_argument("--hitch", type=float, default=1.0)
    parser.add_argument("--joint", type=float, default=1.0)
    asked = parser.parse_args()
    late = f"machine.delays={{hitch_angle={{latency={asked.late}}},reported=false}}"
    for name, machine in MACHINES.items():
        told, changes = [], ["path.radii=[8.0]", f"speed={asked.speed}", late, *machine]
        for corrected in (False, True):
            runs = [
                furthest(simulation(changes, seed, hitch=asked.hitch, joint=asked.joint), corrected=corrected)
                for seed in range(3)
            ]
            told.append(f"{100.0 * max(way for way, _ in runs):.0f}{'*' if any(ended for _, ended in runs) else ''}")
        print(f"{name}: {'; '.join(told)}", flush=True)


if __name__ == "__main__":
    main()

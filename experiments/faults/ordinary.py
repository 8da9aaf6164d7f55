"""What the detectors of wrong angles see in runs without a fault, as a share of their limits.

`python experiments/faults/ordinary.py 6` drives figure-eights in simulation on each ground at each speed with so many
seeds, and prints the largest share of each detector: mean residuals of hitch and joint (fault_exclusion.py), a reversed
hitch sensor (reversed_hitch_sensor.py), wheels and joint that lead to another hitch angle (contradicting_angles.py), a
tractor that turns other than its wheels are measured (turning_error.py), all of these together (contradiction.py), and
the difference of both side-slips (safety/hitch_watch.h). Nothing is excluded.
"""

import argparse
import itertools
import math

from drawbar.config import load_configuration
from drawbar.driving.fault_detection.contradiction import Shares
from drawbar.driving.fault_detection.fault_exclusion import FaultExclusion
from drawbar.simulation import RunAborted, Simulation

MASTS = "vehicle.masts={tractor={up=2.5},trailer={up=2.0}}"
ATTITUDE = "machine.attitude={tractor={present=true},trailer={present=true}}"
WRONG = "machine.lengths={wheelbase=1.1, hitch_length=1.1, drawbar_length=1.1, trailer_length=1.1}"
GROUNDS = {
    "flat": [],
    "uneven 4 cm": [MASTS, ATTITUDE, "machine.terrain.unevenness=0.04"],
    "uneven 3 cm, no attitude": [MASTS, "machine.terrain.unevenness=0.03"],
    "slope 5°": [MASTS, ATTITUDE, "machine.terrain.slope=0.0873"],
    "soft slope 5°": [MASTS, ATTITUDE, "machine.terrain={slope=0.0873,creep=0.36}"],
    "field": [MASTS, ATTITUDE, "machine.terrain={slope=0.0873,creep=0.36,unevenness=0.02}"],
    "soft slope 5°, all lengths 10 % wrong": [MASTS, ATTITUDE, "machine.terrain={slope=0.0873,creep=0.36}", WRONG],
}
RADII = {0.5: 8.0, 1.0: 8.0, 1.5: 8.0, 2.0: 8.0, 3.0: 12.0}
"""of the figure-eight at each speed, m"""
SIDE_SLIPS, SETTLED = math.radians(4.5), 10.0
"""difference of both bodies' side-slips that ends a run, rad, once that has gone on for so long, s (hitch_watch.h)"""
NAMES = (*Shares._fields, "together", "side-slips")


def shares(changes, seed):
    """Yield the shares at each step of a run, by name. Raises RunAborted: it does not come to its end."""
    configuration = load_configuration("articulated", changes)
    exclusion = FaultExclusion(configuration.sanity, configuration.vehicle, configuration.sample_time)
    for record in Simulation(configuration, seed=seed).steps():
        exclusion.update(record, engaged=False)
        apart = abs(record.estimate.tractor_crab - record.estimate.trailer_crab) / SIDE_SLIPS
        settled = record.measurement.time > SETTLED and math.isfinite(apart)
        together = {"together": exclusion.shares.together}
        yield exclusion.shares._asdict() | together | {"side-slips": apart if settled else 0.0}


def largest(ground, seeds):
    """Return the largest share of each detector in all runs on a ground."""
    found = dict.fromkeys(NAMES, 0.0)
    for (speed, radius), seed in itertools.product(RADII.items(), range(seeds)):
        try:
            for seen in shares([*GROUNDS[ground], f"speed={speed}", f"path.radii=[{radius}]"], seed):
                found = {name: max(share, seen[name]) for name, share in found.items()}
        except RunAborted as error:
            print(f"{ground}, {speed:g} m/s, seed {seed}: {error}")
    return found


def main():
    """Drive all of them and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("seeds", type=int)
    seeds = parser.parse_args().seeds
    print(f"{len(GROUNDS) * len(RADII) * seeds} runs")
    print(f"| | {' | '.join(NAMES)} |")
    for ground in GROUNDS:
        print(f"| {ground} | {' | '.join(f'{share:.2f}' for share in largest(ground, seeds).values())} |", flush=True)


if __name__ == "__main__":
    main()

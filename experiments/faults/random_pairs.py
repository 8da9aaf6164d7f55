"""Random pairs of this experiment's faults, the second up to four seconds after the first, at 1 and 2 m/s.

`python experiments/faults/random_pairs.py 150 --seed 2` prints those that go farthest from the line while drawbar
steers.
"""

import argparse
import random
import tomllib
from pathlib import Path

import numpy as np

from drawbar.config import load_configuration
from drawbar.experiment.alteration import find_alteration
from drawbar.experiment.trial import Trial
from drawbar.messages import SupervisorState

FOLDER = Path(__file__).parent
CASES = ("1 m/s, straight", "1 m/s, curve", "2 m/s, straight", "2 m/s, curve")
SOONEST, LATEST = 0.2, 4.0
"""of the second fault after the first, s"""
RELEASED = [SupervisorState.OVERRIDE, SupervisorState.FAULT, SupervisorState.ESTOP]
LATCHED = [*RELEASED, SupervisorState.STOPPED]
STEERS = [SupervisorState.ENGAGING, SupervisorState.ACTIVE, SupervisorState.DEGRADED, SupervisorState.STOPPING]


def begin_both(trial, first, second, later):
    """Let one fault begin at the trial's place, and the other later, s."""
    begins = []
    for name in (first, second):
        trial.begin = lambda: None
        find_alteration(FOLDER, name).apply(trial)
        begins.append(trial.begin)
    rehearsal, due = trial.rehearsal, []

    def begin():
        begins[0]()
        due.append(rehearsal.time + later)
        before = rehearsal.machine.advance

        def advance(now):
            if due and rehearsal.time >= due[0]:
                due.clear()
                begins[1]()
            return before(now)

        rehearsal.machine.advance = advance

    trial.begin = begin
    trial.watched += later


def driven(document, case, faults, later, seed):
    """Return how far it went while steered, cm, set points beyond the envelope, and whether it engaged again."""
    found = next(each for each in document["cases"] if each["name"] == case)
    trial = Trial(load_configuration(found["configuration"], [*document["changes"], *found["changes"]]), seed)
    find_alteration(FOLDER, found["alteration"]).apply(trial)
    begin_both(trial, *faults, later)
    trial.approach()
    trial.watch()
    state, speed = trial.column("state"), trial.column("speed")
    errors = np.abs([trial.column("tractor"), trial.column("trailer")]).max(axis=0)
    left = (trial.column("driving") == 0) | np.isin(state, RELEASED)
    stood = (speed < 0.05) & (np.cumsum(state != SupervisorState.ACTIVE) > 0)
    steered = (np.cumsum(left) == 0) & (np.cumsum(stood) == 0)
    latched = np.isin(state, LATCHED)
    again = bool((np.isin(state, STEERS) & (np.cumsum(latched) > 0)).any())
    return 100.0 * errors[steered].max(initial=0.0), int(trial.column("beyond")[-1]), again


def main():
    """Drive as many pairs as asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    document = tomllib.loads((FOLDER / "experiment.toml").read_text("utf-8"))
    everywhere = [each for each in document["variants"] if "alteration" in each and not each.get("only_named")]
    single = {each["name"]: each["alteration"] for each in everywhere}
    names = [name for name in single if not name.startswith(("two faults", "S29"))]  # S29 needs a place of its own
    rows, beyond, again = [], 0, 0
    for k in range(asked.count):
        chance = random.Random(asked.seed * 1_000_003 + k)
        pair = chance.sample(names, 2)
        case, later, seed = chance.choice(CASES), chance.uniform(SOONEST, LATEST), chance.randrange(10)
        far, outside, engaged = driven(document, case, [single[name] for name in pair], later, seed)
        rows.append((far, f"{case}, seed {seed}: {pair[0]}; after {later:.2f} s {pair[1]}"))
        beyond, again = beyond + outside, again + engaged
    for far, text in sorted(rows, reverse=True)[:10]:
        print(f"{far:5.0f} cm  {text}")
    farther = sum(far > 30.0 for far, _ in rows)
    print(f"{len(rows)} pairs: {farther} over 30 cm, {beyond} set points beyond the envelope, {again} engaged again")


if __name__ == "__main__":
    main()

"""Speed-up: how much faster short runs are on two cores than on one, `python -m drawbar.experiment.speed_up [RUNS]`.

The same runs are driven by clusters of one and of two processes, in turns: what else the machine does falls on both
alike. Starting the processes and compiling the solvers is not timed.
"""

import time
from argparse import ArgumentParser
from itertools import count
from statistics import median

from distributed import Client

from drawbar.config import load_configuration
from drawbar.experiment.cluster import call_all, open_cluster
from drawbar.experiment.task import Result, Task, run_task

RUNS = 60
_TURNS = 5
"""of both clusters; odd, for the median"""
_SEEDS = count()
"""each run has one of its own: a cluster remembers what it has computed"""


def speed_up(runs: int) -> tuple[float, float]:
    """Return the times of so many runs on one and on two processes, s: medians over the turns."""
    times: dict[int, list[float]] = {1: [], 2: []}
    with open_cluster(jobs=1) as one, open_cluster(jobs=2) as two:
        for client in (one, two):
            _driven(client, 4)  # loads the solvers in every process
        for _ in range(_TURNS):
            times[1].append(_driven(one, runs))
            times[2].append(_driven(two, runs))
    return median(times[1]), median(times[2])


def _driven(client: Client, runs: int) -> float:
    """Drive runs with seeds of their own; return how long it took, s."""
    text = load_configuration("articulated", ["path.radii=[10.0]"]).to_toml()
    tasks = {task.key: task for task in (Task(configuration=text, seed=next(_SEEDS)) for _ in range(runs))}
    start = time.perf_counter()
    outcomes = [outcome for _, outcome in call_all(client, run_task, tasks)]
    spent = time.perf_counter() - start
    assert all(isinstance(outcome, Result) for outcome in outcomes), outcomes
    return spent


def main() -> None:
    """Print the figures."""
    parser = ArgumentParser(prog="python -m drawbar.experiment.speed_up")
    parser.add_argument("runs", type=int, nargs="?", default=RUNS, help="of a figure-eight each, in every turn")
    runs = parser.parse_args().runs
    if runs < 1:
        parser.error(f"runs = {runs}: must be 1 or more")
    one, two = speed_up(runs)
    print(
        f"{runs} runs: {one:.2f} s on one process, {two:.2f} s on two: {one / two:.2f} times as fast, "
        f"medians of {_TURNS} turns"
    )


if __name__ == "__main__":
    main()

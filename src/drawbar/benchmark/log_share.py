"""Log share: what a log costs of a simulated run, `python -m drawbar.benchmark.log_share [STRETCHES]`, on Linux.

The same run is driven twice on one core, with its log and without, in turns of 200 steps: what else the machine does
falls on both alike. Times are the processor's own, so that waiting for it does not count.
"""

import os
import time
from argparse import ArgumentParser
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from drawbar.config import load_configuration
from drawbar.recording.log import LOG_NAME
from drawbar.recording.recorder import Recorder
from drawbar.signals import StepRecord
from drawbar.simulation import Simulation

STRETCHES = 200
_STEPS = 200
"""of a stretch"""
_EIGHT = 600
"""steps that a figure-eight takes at least"""


@dataclass(frozen=True, slots=True, kw_only=True)
class LogShare:
    """What a log costs of the run that it is of."""

    step: float
    """a step without the log, s: the median of all stretches"""
    log: float
    """what the log adds to a step, s: the median of all pairs of stretches"""
    bytes_per_step: float

    @property
    def share(self) -> float:
        """Of a run with its log."""
        return self.log / (self.step + self.log)


def log_share(stretches: int) -> LogShare:
    """Drive a shipped configuration in so many pairs of stretches."""
    radii = [10.0] * (1 + (stretches + 1) * _STEPS // _EIGHT)
    plain, logged = (Simulation(load_configuration("articulated", [f"path.radii={radii}"])) for _ in range(2))
    with TemporaryDirectory() as folder:
        file, pairs = Path(folder) / LOG_NAME, list[tuple[float, float]]()
        with ExitStack() as stack:
            recorder = stack.enter_context(Recorder(file, logged.header()))
            header = file.stat().st_size
            drives = (
                (stack.enter_context(plain).steps(), _ignore),
                (stack.enter_context(logged).steps(), recorder.write),
            )
            for drive in drives:  # fills windows and caches
                _driven(*drive)
            for number in range(stretches):
                first = number % 2
                pair = _driven(*drives[first]), _driven(*drives[1 - first])
                pairs.append((pair[first], pair[1 - first]))
        written = file.stat().st_size - header  # of the closed file: until then some steps wait in memory
    return LogShare(
        step=median(without for without, _ in pairs),
        log=median(with_log - without for without, with_log in pairs),
        bytes_per_step=written / ((1 + stretches) * _STEPS),
    )


def _ignore(record: StepRecord) -> None:
    """Do with a record what a run without a log does."""


def _driven(steps: Iterator[StepRecord], take: Callable[[StepRecord], None]) -> float:
    """Drive a stretch; return what a step of it took, s."""
    start = time.process_time()
    for record in islice(steps, _STEPS):
        take(record)
    return (time.process_time() - start) / _STEPS


def main() -> None:
    """Print the figures."""
    parser = ArgumentParser(prog="python -m drawbar.benchmark.log_share")
    parser.add_argument("stretches", type=int, nargs="?", default=STRETCHES, help=f"pairs of {_STEPS} steps")
    stretches = parser.parse_args().stretches
    if stretches < 1:
        parser.error(f"stretches = {stretches}: must be 1 or more")
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    cost = log_share(stretches)
    print(
        f"log: {1e6 * cost.log:.1f} µs of {1e6 * (cost.step + cost.log):.0f} a step, {100 * cost.share:.1f} % of the "
        f"run; {cost.bytes_per_step:.0f} bytes a step, {cost.bytes_per_step * 18_000 / 1e6:.1f} MB an hour at 5 Hz"
    )


if __name__ == "__main__":
    main()

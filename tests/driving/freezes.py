"""Holds controller and gate up for a short time: python tests/driving/freezes.py SECONDS ... [--times 8] [--seed 0].

Drives stand-ins in processes, in real time, over real sockets, and stops the controller, the gate and both together for
so long, each as often, at random instants, as a busy computer does. Prints after how many of these the steering was
released; a drive that was released is begun anew. It listens on the computer's loopback, which takes root.
"""

import argparse
import os
import random
import signal
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

from kills import QUICK, STARTING, Drive, NotSteeredError
from wire_delay import Wire

from drawbar.config import load_configuration
from drawbar.configurations import CONFIGURATION_NAME
from drawbar.driving.operator.front_end import FrontEnd
from drawbar.driving.processes.drive_processes import DriveProcesses
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.messages import SupervisorState

HELD = (("controller",), ("gate",), ("controller", "gate"))
LINE = [*QUICK, "path.straight_length=100.0"]
PATIENCE = 5.0
"""s, for a drive that steers to leave DEGRADED, in which it is for late steps"""
AFTER = 1.0
"""s, within which a process that was held up shows what came of it"""


@contextmanager
def driving(run: Path):
    """Begin a drive as a context; it steers."""
    configuration = with_stand_ins(load_configuration("articulated", LINE))
    devices = configuration.devices
    (run / CONFIGURATION_NAME).write_text(configuration.to_toml(), "utf-8")
    with DriveProcesses(configuration, run, stand_ins=True) as processes:
        wire = Wire((devices.tractor_board.destination[1], devices.trailer_board.destination[1]))
        drive = Drive(processes, FrontEnd(processes, demonstrates=True), wire)
        try:
            drive.watch(lambda: drive.state() is SupervisorState.ACTIVE or drive.front.is_over, STARTING)
            yield drive
        finally:
            drive.front.close()
            wire.close()


def held_up(drive: Drive, names: tuple[str, ...], seconds: float, chance: random.Random) -> bool:
    """Hold processes up at a random instant; return whether the steering was released for it."""
    drive.watch(lambda: False, chance.uniform(0.5, 1.5))
    if not drive.watch(lambda: drive.state() is SupervisorState.ACTIVE, PATIENCE):
        raise NotSteeredError(drive.state())
    held, start = [drive.processes.by_name[name] for name in names], time.monotonic_ns()
    before, usual = os.sched_getparam(0), os.sched_getscheduler(0)
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(os.sched_get_priority_max(os.SCHED_FIFO)))  # to be in time
    for each in held:
        each.send_signal(signal.SIGSTOP)
    time.sleep(seconds)
    for each in held:
        each.send_signal(signal.SIGCONT)
    os.sched_setscheduler(0, usual, before)
    drive.watch(lambda: False, AFTER)
    return drive.released(start) is not None


def released(seconds: float, times: int, chance: random.Random) -> tuple[dict[tuple[str, ...], int], int]:
    """Hold up as often as asked for; return how often that released the steering, and how many drives it took."""
    due, found, drives = list(HELD) * times, dict.fromkeys(HELD, 0), 0
    while due:
        drives += 1
        with tempfile.TemporaryDirectory(prefix="drawbar-freezes-") as folder, driving(Path(folder)) as drive:
            try:
                while due:
                    if held_up(drive, due[-1], seconds, chance):
                        found[due.pop()] += 1
                        break
                    due.pop()
            except NotSteeredError as error:
                print(f"begun anew: not steered, {error}", flush=True)
    return found, drives


def main() -> int:
    """Print a line for each length of time."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("seconds", type=float, nargs="+")
    parser.add_argument("--times", type=int, default=8)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    for seconds in given.seconds:
        found, drives = released(seconds, given.times, random.Random(given.seed))
        words = ", ".join(f"{' and '.join(names)} {count} of {given.times}" for names, count in found.items())
        print(f"{seconds:g} s: released {words}; {drives} drives; load {os.getloadavg()[0]:.1f}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""Kills and freezes the processes of whole drives at random instants: python tests/driving/kills.py [COUNT [SEED]].

Drives stand-ins in processes, in real time, over real sockets, and sends SIGKILL or SIGSTOP to controller, receivers or
recorder, each as often; listens on the computer's loopback to the datagrams to both boards, which takes root. What was
frozen continues a second after the boards were released (the recorder: after its silence was told), and is listened to
for two seconds more. Prints a table, and ends with 1 where a limit below was exceeded, something steered again or a log
was unreadable. A drive that was not steered when the signal was due is not counted.
"""

import itertools
import math
import os
import random
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from wire_delay import SetPoint, Wire

from drawbar.config import load_configuration
from drawbar.configurations import CONFIGURATION_NAME
from drawbar.driving.operator.front_end import FrontEnd
from drawbar.driving.processes.drive_processes import DriveProcesses
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.errors import DrawbarError
from drawbar.messages import SupervisorState
from drawbar.recording.log import LOG_NAME, read_log
from drawbar.safety.causes import Cause

PROCESSES, SIGNALS = ("controller", "receivers", "recorder"), (signal.SIGKILL, signal.SIGSTOP)
QUICK = ["safety.engage.fixed=1.0", "safety.engage.hold=0.1", "safety.engage.quiet=0.1", "path.radii=[8.0]"]
"""an operator who need not wait; every time-out of the drive itself is as it comes"""
PROMISED = {"controller": 0.2, "receivers": 12.0, "recorder": 1.5}
"""s, by which the boards are released, or the loss is told. The controller's is that of docs/safety.md; without
receivers the vehicle, which nobody stops here, is steered for `drive.stopping` more; the recorder's is its silence."""
STARTING, AFTER = 60.0, 2.0
LOST = 0.5
"""s, by which the last step of a readable log may be older than the kill: a step, and what it takes"""


@dataclass
class Outcome:
    """What came of one signal to one process."""

    process: str
    number: signal.Signals
    seconds: float = math.inf
    """until both boards were released; of the recorder until its silence was told"""
    stop: float = math.inf
    """s, until the gate asked for a stop, or had released"""
    again: int = 0
    """set points that steered after that"""
    readable: bool = False
    oldest: float = math.inf
    """s, from the last step in the log to the signal; 0 where steps came later"""

    @property
    def kept(self) -> bool:
        """Whether what is promised was so."""
        return self.seconds <= PROMISED[self.process] and not self.again and self.readable and self.oldest <= LOST


class NotSteeredError(Exception):
    """The drive did not come to steering, or no longer steered when the signal was due."""


@dataclass
class Drive:
    """A drive, its operator and the wire to its boards."""

    processes: DriveProcesses
    front: FrontEnd
    wire: Wire

    def watch(self, until: Callable[[], bool], longest: float) -> bool:
        """Take part in the drive until something holds; return whether it did within a time, s."""
        end = time.monotonic() + longest
        while not until():
            if time.monotonic() > end:
                return False
            self.front.wait(0.01)
        return True

    def state(self) -> SupervisorState | None:
        """Return the gate's newest state."""
        return self.front.state.state if self.front.state is not None else None

    def released(self, start: int) -> int | None:
        """Return when both boards had been released, ns; a board steers until it is told not to."""
        offs = [next((each.time for each in self._later(start) if each.port == port and not each.steers), None)
                for port in self.wire.ports]  # fmt: skip
        return max(each for each in offs if each is not None) if None not in offs else None

    def again(self, start: int) -> int:
        """Return how many set points steered after a time, ns."""
        return sum(each.steers for each in self._later(start))

    def _later(self, start: int) -> list[SetPoint]:
        return [each for each in self.wire.seen if each.time > start]

    def stops(self) -> bool:
        """Return whether the gate asks for a stop, or has released."""
        return self.front.state is not None and bool(self.front.state.stop or not self.front.state.steers)

    def tells_no_recording(self) -> bool:
        """Return whether the gate says that nothing is recorded."""
        return self.front.state is not None and Cause.NOT_RECORDING.value in self.front.state.refusals


def broken(outcome: Outcome, run: Path, chance: random.Random) -> None:
    """Drive, send the signal at a random instant, and fill in what came of it."""
    configuration = with_stand_ins(load_configuration("articulated", QUICK))
    devices = configuration.devices
    assert devices is not None
    assert devices.tractor_board is not None
    assert devices.trailer_board is not None
    (run / CONFIGURATION_NAME).write_text(configuration.to_toml(), "utf-8")
    with DriveProcesses(configuration, run, stand_ins=True) as processes:
        wire = Wire((devices.tractor_board.destination[1], devices.trailer_board.destination[1]))
        drive = Drive(processes, FrontEnd(processes, demonstrates=True), wire)
        try:
            start = _signalled(drive, outcome, chance)
        finally:
            drive.front.close()
            wire.close()
    with suppress(DrawbarError):
        times = read_log(run / LOG_NAME).wall_time
        outcome.readable, outcome.oldest = bool(len(times)), max(start - float(times[-1]), 0.0)


def _signalled(drive: Drive, outcome: Outcome, chance: random.Random) -> float:
    """Send the signal and watch what comes of it; return when it was sent, s since 1970."""
    steering = drive.watch(lambda: drive.state() is SupervisorState.ACTIVE or drive.front.is_over, STARTING)
    drive.watch(lambda: False, chance.uniform(0.2, 1.2))
    if not steering or drive.state() is not SupervisorState.ACTIVE:
        raise NotSteeredError(drive.state())
    process = drive.processes.by_name[outcome.process]
    wall, start = time.time(), time.monotonic_ns()
    process.send_signal(outcome.number)
    if outcome.process == "recorder":
        drive.watch(drive.tells_no_recording, 2.0 * PROMISED["recorder"])
        outcome.seconds = 1e-9 * (time.monotonic_ns() - start) if drive.tells_no_recording() else math.inf
        if drive.state() is not SupervisorState.ACTIVE:
            raise NotSteeredError(drive.state())
        return _resumed(drive, outcome, wall)
    if drive.watch(drive.stops, PROMISED[outcome.process]):
        outcome.stop = 1e-9 * (time.monotonic_ns() - start)
    drive.watch(lambda: drive.released(start) is not None, 1.5 * PROMISED[outcome.process])
    end = drive.released(start)
    outcome.seconds = 1e-9 * (end - start) if end is not None else math.inf
    drive.watch(lambda: False, 1.0)
    _resumed(drive, outcome, wall)
    outcome.again = drive.again(end) if end is not None else 0
    return wall


def _resumed(drive: Drive, outcome: Outcome, wall: float) -> float:
    """Let what was frozen continue, and watch what it does; return the time that was given."""
    if outcome.number is signal.SIGSTOP:
        drive.processes.by_name[outcome.process].send_signal(signal.SIGCONT)
    drive.watch(lambda: False, AFTER)
    return wall


def table(outcomes: list[Outcome]) -> None:
    """Print what came of all signals, for each process and each signal: least, median and largest times, s."""
    print(
        "| process | signal | drives | stop asked for, s | released, or told, s | steered again | logs | step older |"
    )
    for process, number in itertools.product(PROCESSES, SIGNALS):
        alike = [each for each in outcomes if each.process == process and each.number is number]
        if alike:
            again, logs = sum(each.again > 0 for each in alike), sum(each.readable for each in alike)
            times = [_spread([getattr(each, name) for each in alike]) for name in ("stop", "seconds")]
            oldest = max(each.oldest for each in alike)
            print(
                f"| {process} | {number.name} | {len(alike)} | {' | '.join(times)} | {again} | {logs} | {oldest:.2f} |"
            )


def _spread(seconds: list[float]) -> str:
    ordered = sorted(seconds)
    return f"{ordered[0]:.3f}, {ordered[len(ordered) // 2]:.3f}, {ordered[-1]:.3f}"


def main() -> int:
    """Break as many drives as are asked for."""
    count, seed = (int(each) for each in [*sys.argv[1:], *["12", "0"][len(sys.argv) - 1 :]])
    chance, outcomes, kinds = (
        random.Random(seed),
        list[Outcome](),
        itertools.cycle(itertools.product(PROCESSES, SIGNALS)),
    )
    left_out = 0
    while len(outcomes) < count:
        outcome = Outcome(*next(kinds))
        with tempfile.TemporaryDirectory(prefix="drawbar-kills-") as folder:
            try:
                broken(outcome, Path(folder), chance)
            except NotSteeredError as error:
                left_out += 1
                print(f"{outcome.process} {outcome.number.name}: not steered, {error}", flush=True)
                continue
        outcomes.append(outcome)
        print(f"{len(outcomes)}: {outcome}, {'kept' if outcome.kept else 'NOT KEPT'}", flush=True)
    table(outcomes)
    failed = sum(not each.kept for each in outcomes)
    print(f"{failed} of {count} not as promised; {left_out} more were not steered; load {os.getloadavg()[0]:.1f}")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())

"""Rehearsed runs that differ in their fault alone: the drive to its place is driven once, then copied for each.

The copies are forks of a process with one thread, started for that. The results are bit for bit those of each run
driven by itself, as it is where there is no fork (all but Linux).
"""

import gc
import os
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NoReturn

import msgspec

from drawbar.experiment.cluster import Failure
from drawbar.experiment.task import (
    Result,
    Task,
    approached_trial,
    decode_result,
    digest,
    encode_result,
    run_task,
    source_digest,
    watched_trial,
)
from drawbar.experiment.trial import Trial

TOGETHER = 24
"""runs that share a drive, so that progress shows every few seconds"""
Outcome = tuple[bytes, str]
"""an encoded result, or none and why"""


def grouped(tasks: Iterable[Task], together: int = TOGETHER) -> Mapping[str, Sequence[Task]]:
    """Return the tasks in groups for `run_tasks`, by a key each: those that share an approach, the others alone."""
    alike: dict[str, list[Task]] = {}
    for task in tasks:
        shares = task.rehearsed and sys.platform == "linux"
        alike.setdefault((replace(task, fault=None) if shares else task).key, []).append(task)
    groups = [each[first : first + together] for each in alike.values() for first in range(0, len(each), together)]
    return {digest(*(task.key for task in group)): group for group in groups}


def run_tasks(tasks: Sequence[Task]) -> Sequence[Result | Failure]:
    """Return what comes of the tasks of one group, in their order.

    Raises:
        DrawbarError: a configuration cannot be built.
        RuntimeError: the process that drives them together has ended too soon.
    """
    if len(tasks) == 1:
        return [run_task(tasks[0])]
    command = [sys.executable, "-m", "drawbar.experiment.shared_approach"]
    done = subprocess.run(command, input=msgspec.msgpack.encode(tasks), capture_output=True, check=False)
    if done.returncode:
        said = done.stderr.decode("utf-8", "replace").strip().splitlines()
        raise RuntimeError(said[-1] if said else f"the process of these runs ended with {done.returncode}")
    outcomes = msgspec.msgpack.decode(done.stdout, type=list[Outcome])
    return [decode_result(result) if result else Failure(reason=reason) for result, reason in outcomes]


def _outcomes(tasks: Sequence[Task]) -> Iterator[Outcome]:
    try:
        trial = approached_trial(tasks[0])
    except Exception as error:  # whatever ended one run alone
        yield from [(b"", Failure.of(error).reason)] * len(tasks)
        return
    source_digest()  # once for all copies
    gc.freeze()  # so that their memory stays shared
    for task in tasks:
        yield _in_a_copy(trial, task)


def _in_a_copy(trial: Trial, task: Task) -> Outcome:
    """Return what comes of a trial in a copy of this process, whose own trial stays where it is."""
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        _tell(writing, trial, task)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        told = pipe.read()
    _, status = os.waitpid(child, 0)
    if status:
        return b"", f"the process of this run ended with {os.waitstatus_to_exitcode(status)}"
    outcome: Outcome = msgspec.msgpack.decode(told, type=Outcome)
    return outcome


def _tell(pipe: int, trial: Trial, task: Task) -> NoReturn:
    """Write what comes of a trial to a pipe, and end this process."""
    status = 1
    try:
        with os.fdopen(pipe, "wb") as told:
            told.write(msgspec.msgpack.encode(_outcome(trial, task)))
        status = 0
    finally:
        os._exit(status)


def _outcome(trial: Trial, task: Task) -> Outcome:
    try:
        return encode_result(watched_trial(trial, task)), ""
    except Exception as error:  # as in call_all
        return b"", Failure.of(error).reason


def main() -> None:
    """Read tasks of one group from the standard input, and write their outcomes to the standard output."""
    results = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what an alteration prints is no result
    tasks = msgspec.msgpack.decode(sys.stdin.buffer.read(), type=list[Task])
    with results:
        results.write(msgspec.msgpack.encode([*_outcomes(tasks)]))


if __name__ == "__main__":
    main()

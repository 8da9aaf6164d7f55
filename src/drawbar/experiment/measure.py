"""Measuring an experiment: drive every run that has no result yet, and collect all of them."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from distributed import Client

from drawbar.experiment.cluster import Failure, call_all
from drawbar.experiment.experiment import Experiment
from drawbar.experiment.progress import RunsProgress
from drawbar.experiment.shared_approach import grouped, run_tasks
from drawbar.experiment.store import ResultStore
from drawbar.experiment.task import Result, Task, compile_solvers, digest, solver_sections, source_digest

RUNS_FOLDER = ".runs"
"""in the experiment's folder: finished runs, for the same command to continue from"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Runs:
    """The runs of one case."""

    results: Sequence[Result]
    """in the order of the seeds"""
    failures: Sequence[str]
    """why runs have no result: each reason once, with its seeds"""


def measure(client: Client, experiment: Experiment, seeds: int | None, progress: RunsProgress) -> Mapping[str, Runs]:
    """Return the runs of every case of an experiment."""
    at_once = 1 if experiment.settings.one_at_a_time else None
    return measure_cases(client, experiment.folder, experiment.tasks(seeds), progress, at_once=at_once)


def measure_cases(
    client: Client,
    folder: Path,
    cases: Mapping[str, Sequence[Task]],
    progress: RunsProgress,
    *,
    at_once: int | None = None,
) -> Mapping[str, Runs]:
    """Return the runs of every case; each result is on disk, in the folder, before the next one is waited for.

    A run that was given up (`metrics.finished` false) is a result; one that raised, or killed its workers, is
    a failure.
    """
    store = ResultStore(folder / RUNS_FOLDER)
    tasks = {task.key: task for tasks in cases.values() for task in tasks}
    results = {key: result for key, task in tasks.items() if (result := store.get(task))}
    missing = {key: task for key, task in tasks.items() if key not in results}
    failures: dict[str, str] = {}
    _compile(client, missing.values(), progress)
    progress.begin("runs", len(tasks), done=len(results))
    for task, outcome in _outcomes(client, grouped(missing.values()), at_once):
        reason = _refusal(outcome)
        if isinstance(outcome, Result) and not reason:
            results[task.key] = outcome
            store.put(task, outcome)
        else:
            failures[task.key] = reason
        progress.advance(reason)
    return {name: _runs(tasks, results, failures) for name, tasks in cases.items()}


def _outcomes(
    client: Client, groups: Mapping[str, Sequence[Task]], at_once: int | None
) -> Iterator[tuple[Task, Result | Failure]]:
    """Yield what came of every task, group by group as they are done."""
    for key, outcomes in call_all(client, run_tasks, groups, at_once=at_once):
        of_each = [outcomes] * len(groups[key]) if isinstance(outcomes, Failure) else outcomes
        yield from zip(groups[key], of_each, strict=True)


def _refusal(outcome: Result | Failure) -> str:
    """Return why an outcome is no result to be kept; empty for one that is."""
    if isinstance(outcome, Failure):
        return outcome.reason
    if outcome.source != source_digest():
        return "a worker has another version of drawbar's code; install the same on every machine of the cluster"
    return ""


def _compile(client: Client, tasks: Iterable[Task], progress: RunsProgress) -> None:
    """Compile what the runs will need; what cannot be built here fails, with the reason, in its runs."""
    needed: dict[str, str] = {}
    for configuration in {task.configuration for task in tasks}:
        needed.setdefault(solver_sections(configuration), configuration)
    progress.begin("solvers", len(needed))
    arguments = {digest(source_digest(), sections): configuration for sections, configuration in needed.items()}
    for _ in call_all(client, compile_solvers, arguments):
        progress.advance()


def _runs(tasks: Sequence[Task], results: Mapping[str, Result], failures: Mapping[str, str]) -> Runs:
    keys = [task.key for task in tasks]
    seeds: dict[str, list[str]] = {}
    for task in tasks:
        if task.key in failures:
            seeds.setdefault(failures[task.key], []).append(str(task.seed))
    return Runs(
        results=[results[key] for key in keys if key in results],
        failures=[f"seed {', '.join(each)}: {reason}" for reason, each in seeds.items()],
    )

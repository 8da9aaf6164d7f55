"""`drawbar tune`: search, drive what was found again with fresh seeds, and report."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from drawbar.config import TuningSettings
from drawbar.errors import DrawbarError
from drawbar.experiment.cluster import Failure, open_cluster
from drawbar.experiment.task import digest, source_digest
from drawbar.experiment.tuning.comparison import Candidate, Comparison
from drawbar.experiment.tuning.parameters import SearchSpace
from drawbar.experiment.tuning.report import Findings, terminal_table, verdict, write_findings
from drawbar.experiment.tuning.study import Trial, finished_trials, front, importances, open_study, search
from drawbar.experiment.tuning.trials import Driver

JOURNAL_NAME = "study.journal"


@dataclass(frozen=True, slots=True, kw_only=True)
class Budget:
    """How much is searched, and with what."""

    trials: int
    """in all; the configuration's own values are the first"""
    seed: int
    """of the search"""
    jobs: int | None
    """processes on this machine; None: one per core"""
    address: str
    """of a running Dask scheduler; empty: a cluster of this machine's own"""


def tune(console: Console, space: SearchSpace, folder: Path, budget: Budget) -> None:
    """Search, or continue with the search that lies in the folder, and leave the report there.

    Raises:
        DrawbarError: the folder cannot be written, the configuration cannot be driven as it is, no cluster.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise DrawbarError(f"{folder}: cannot be written ({error.strerror}); choose another --out folder.") from error
    study = open_study(folder / JOURNAL_NAME, study_name(space, budget.seed))
    with open_cluster(budget.address, budget.jobs) as client:
        driver = Driver(client=client, folder=folder, console=console, space=space)
        search(study, space.parameters, driver.scores, trials=budget.trials, seed=budget.seed)
        trials = finished_trials(study)[: budget.trials]
        comparison = _compare(driver, trials)
    findings = Findings(
        space=space, seed=budget.seed, trials=trials, comparison=comparison, importances=importances(study)
    )
    file = write_findings(folder, findings)
    console.print(terminal_table(findings))
    console.print(f"{verdict(findings)}\n\n{file}", soft_wrap=True)


def study_name(space: SearchSpace, seed: int) -> str:
    """Return what identifies a study: what a trial scores depends on nothing else."""
    tuning = TuningSettings(error=space.configuration.tuning.error, seeds=space.configuration.tuning.seeds)
    configuration = space.configuration.model_copy(update={"tuning": tuning}).to_toml()
    return (
        f"{space.configuration.name}-{digest(source_digest(), configuration, str(seed), *map(str, space.parameters))}"
    )


def _compare(driver: Driver, trials: Sequence[Trial]) -> Comparison:
    """Drive the front and the configuration's own values with fresh seeds."""
    tuning, best = driver.space.configuration.tuning, front(trials)
    chosen = {str(trial.number): trial for trial in (trials[0], *best)}
    seeds = range(tuning.seeds, tuning.seeds + tuning.fresh_seeds)
    driven = driver.drive("fresh seeds", {name: trial.values for name, trial in chosen.items()}, seeds)
    candidates = {
        name: Candidate(trial=chosen[name], fresh=fresh)
        for name, fresh in driven.items()
        if not isinstance(fresh, Failure)
    }
    return Comparison(own=candidates["0"], front=[candidates[str(trial.number)] for trial in best])

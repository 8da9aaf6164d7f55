"""Driving trials: every one with all seeds, on the cluster; what was driven once is not driven again."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from distributed import Client
from rich.console import Console

from drawbar.config import Configuration, TuningSettings
from drawbar.errors import DrawbarError
from drawbar.experiment.cluster import Failure
from drawbar.experiment.measure import Runs, measure_cases
from drawbar.experiment.progress import RunsProgress
from drawbar.experiment.task import Task, compile_solvers
from drawbar.experiment.tuning.parameters import SearchSpace, Values
from drawbar.experiment.tuning.study import Score
from drawbar.geometry import Floats
from drawbar.report.metrics import ALL, Metrics


@dataclass(frozen=True, slots=True, kw_only=True)
class Objectives:
    """What is made small, of n runs."""

    error: Floats
    """(n,) m"""
    effort: Floats
    """(n,) rad/s"""
    given_up: int
    """runs"""

    def score(self) -> Score:
        """Return the means over the runs."""
        unfinished = self.given_up / len(self.error)
        return Score(error=float(self.error.mean()), effort=float(self.effort.mean()), unfinished=unfinished)


@dataclass(frozen=True, slots=True, kw_only=True)
class Driver:
    """Drives trials and returns their scores."""

    client: Client
    folder: Path
    """where finished runs are kept"""
    console: Console
    space: SearchSpace

    def scores(self, batch: Sequence[tuple[int, Values]]) -> list[Score | Failure]:
        """Return the score of each numbered trial over the search's seeds, or why its values are impossible.

        Raises:
            DrawbarError: the configuration's own values are impossible; a run has no result for another reason.
        """
        numbers, seeds = [number for number, _ in batch], range(self.space.configuration.tuning.seeds)
        title = f"trials {numbers[0]} to {numbers[-1]}"
        outcomes = self.drive(title, {str(number): values for number, values in batch}, seeds)
        own = outcomes.get("0")
        if isinstance(own, Failure):
            raise DrawbarError(f"{self.space.source}: cannot be driven as it is: {own.reason}")
        return [
            outcome if isinstance(outcome, Failure) else outcome.score()
            for outcome in (outcomes[str(number)] for number in numbers)
        ]

    def drive(
        self, title: str, trials: Mapping[str, Values], seeds: Sequence[int]
    ) -> Mapping[str, Objectives | Failure]:
        """Return the objectives of each trial, by its name, over the seeds, or why its values are impossible.

        Raises:
            DrawbarError: a run has no result though its values are possible.
        """
        tuning = self.space.configuration.tuning
        configurations, refused = self._configurations(trials)
        cases = {
            name: [Task(configuration=configuration, seed=seed) for seed in seeds]
            for name, configuration in configurations.items()
        }
        with RunsProgress(self.console, f"{self.space.configuration.name}, {title}") as progress:
            measured = measure_cases(self.client, self.folder, cases, progress)
        for name, runs in measured.items():
            if runs.failures:
                refused[name] = _refusal(name, configurations[name], runs.failures[0])
        return {name: refused[name] if name in refused else objectives(measured[name], tuning) for name in trials}

    def _configurations(self, trials: Mapping[str, Values]) -> tuple[dict[str, str], dict[str, Failure]]:
        """Return the complete configuration of each trial whose values are allowed, and why the others' are not."""
        allowed, refused = {}, {}
        for name, values in trials.items():
            try:
                allowed[name] = _driven(self.space.with_values(values)).to_toml()
            except DrawbarError as error:
                refused[name] = Failure(reason=str(error))
        return allowed, refused


def objectives(runs: Runs, tuning: TuningSettings) -> Objectives:
    """Return what is made small, of all runs."""
    metrics = [result.metrics for result in runs.results]
    return Objectives(
        error=np.array([_error(each, tuning.error) for each in metrics]),
        effort=np.array([_effort(each) for each in metrics]),
        given_up=sum(not each.finished for each in metrics),
    )


def _error(metrics: Metrics, statistic: str) -> float:
    bodies = metrics.error_m
    tractor, trailer = (float(getattr(errors[ALL], statistic)) for errors in (bodies.tractor, bodies.trailer))
    return 0.5 * (tractor + trailer)


def _effort(metrics: Metrics) -> float:
    rate = metrics.steering_rate_mean_rad_s
    return 0.5 * (rate.tractor + rate.trailer)


def _driven(configuration: Configuration) -> Configuration:
    """Return what a run depends on: the same run serves whatever it is judged by."""
    return configuration.model_copy(update={"tuning": TuningSettings()})


def _refusal(name: str, configuration: str, reason: str) -> Failure:
    """Return why a configuration is impossible; where it is not, its run failed by chance, and that is an error."""
    try:
        compile_solvers(configuration)
    except DrawbarError as error:
        return Failure(reason=str(error))
    raise DrawbarError(f"trial {name}, {reason}. The same command continues from the runs that are finished.")

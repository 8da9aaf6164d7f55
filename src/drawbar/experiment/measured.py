"""Measured experiment, for its analysis: every run of every case, and the figures of each run."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NoReturn, TypeVar

from drawbar.errors import ConfigurationError
from drawbar.experiment.declaration import Expectation
from drawbar.experiment.experiment import FIGURE, Experiment, named_figures
from drawbar.experiment.measure import Runs
from drawbar.experiment.statistics import Statistic
from drawbar.misspelt import meant

_Value = TypeVar("_Value")
REPORT_NAME = "REPORT.md"
Figures = Mapping[str, float]
"""the figures of one run by name"""


class NotDrivenError(KeyError):
    """A case that was not chosen was asked for."""


class ByCase(dict[str, _Value]):
    """What is known of each case that was driven, by its name."""

    def __missing__(self, case: str) -> NoReturn:
        """Raise NotDrivenError."""
        raise NotDrivenError(case)


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """One expectation beside what came out."""

    case: str
    figure: str
    statistic: Statistic
    expected: Expectation

    @property
    def holds(self) -> bool:
        """Whether the mean, or the largest of all runs, is as expected."""
        return self.expected.holds(self.expected.judged(self.statistic))

    @property
    def found(self) -> str:
        """The mean and its interval, and the largest of all runs where that is judged."""
        largest = f", largest {self.statistic.largest:.2f}" if self.expected.in_every_run else ""
        return f"{self.statistic.text(2)}{largest}"


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredExperiment:
    """An experiment with its runs."""

    experiment: Experiment
    seeds: int
    """of the case that has most"""
    runs: ByCase[Runs]
    """by name of the case"""
    figures: ByCase[Sequence[Figures]]
    """by name of the case, one per seed; empty where a run has no result"""

    @property
    def cases(self) -> list[str]:
        """Names of the cases, in the order of experiment.toml."""
        return list(self.runs)

    @property
    def figure_names(self) -> list[str]:
        """Names of all figures, in the order of their first appearance."""
        return list(dict.fromkeys(name for runs in self.figures.values() for run in runs for name in run))

    @property
    def _expected(self) -> Mapping[str, Mapping[str, Expectation]]:
        """What is expected of the cases that were driven."""
        return {case: each for case, each in self.experiment.expected.items() if case in self.runs}

    def values(self, case: str, figure: str) -> list[float]:
        """Return a figure of a case, one value per seed; NaN where a run does not have it, or has no result."""
        return [run.get(figure, float("nan")) for run in self.figures[case]]

    def statistic(self, case: str, figure: str) -> Statistic:
        """Return a figure of a case over the seeds."""
        return Statistic.of(self.values(case, figure))

    def named_statistic(self, case: str, figure: str) -> Statistic:
        """Return a figure that experiment.toml names, of a case.

        Raises:
            ConfigurationError: runs have figures, but none of this name.
        """
        if self.figure_names and figure not in self.figure_names:
            raise ConfigurationError(
                f"{self.experiment.folder.name}: no figure {figure!r} of a case {case!r}; "
                f"figures: {', '.join(self.figure_names)}."
            )
        return self.statistic(case, figure)

    def finished(self, case: str) -> str:
        """Return how many runs of a case came to the end of the path, of how many."""
        return f"{sum(result.metrics.finished for result in self.runs[case].results)}/{len(self.figures[case])}"

    def means(self, case: str, figures: Sequence[str]) -> str:
        """Return the means of figures, as of tractor and trailer; empty for a case that was not driven."""
        if case not in self.runs:
            return ""
        return self.with_finished(case, " / ".join(f"{self.statistic(case, figure).mean:.1f}" for figure in figures))

    def with_finished(self, case: str, text: str) -> str:
        """Return a text about a case, with how many of its runs came to the end of the path where not all did."""
        finished = self.finished(case)
        return text if finished == f"{self.seeds}/{self.seeds}" else f"{text} ({finished})"

    def verdicts(self) -> list[Verdict]:
        """Return every expectation beside what came out."""
        return [
            Verdict(case=case, figure=figure, statistic=self.statistic(case, figure), expected=expected)
            for case, by_figure in self._expected.items()
            for figure, expected in by_figure.items()
        ]

    def unmeasured(self, text: str) -> list[str]:
        """Return the cases that a text names and that have no result: not chosen, left out, or failed."""
        named = dict.fromkeys(case for case, _ in named_figures(text))
        return [case for case in named if case not in self.runs or not self.runs[case].results]

    def filled_in(self, text: str) -> str:
        """Return a text with measured figures for {case|figure}; empty where one of its cases is unmeasured.

        Raises:
            ConfigurationError: a case that it names has no such figure.
        """
        return "" if self.unmeasured(text) else FIGURE.sub(self._filled_in, text)

    def left_out_texts(self) -> list[str]:
        """Return which of the texts for REPORT.md are left out, and which cases without a result they name."""
        texts = {name: getattr(self.experiment.settings, name) for name in ("learned", "why_missed")}
        return [
            f"`{name}` is left out of {REPORT_NAME}: no result of {', '.join(cases)}"
            for name, text in texts.items()
            if (cases := self.unmeasured(text))
        ]

    def _filled_in(self, place: re.Match[str]) -> str:
        return self.named_statistic(*place.groups()).text(2)

    def misses(self) -> list[str]:
        """Return what is not as expected: runs without a result, expected cases not driven to the end, figures."""
        failures = [f"{case}: {reason}" for case, runs in self.runs.items() for reason in runs.failures]
        lost = [
            f"{case}, seed {result.metrics.seed}: {result.metrics.outcome}"
            for case in self._expected
            for result in self.runs[case].results
            if not result.metrics.finished
        ]
        missed = [
            f"{verdict.case}: {verdict.figure} is {verdict.found}, expected {verdict.expected}"
            f"{self._no_such(verdict.figure)}"
            for verdict in self.verdicts()
            if not verdict.holds
        ]
        return [*failures, *lost, *missed]

    def _no_such(self, figure: str) -> str:
        """Return where runs have figures, but none of this name."""
        names = self.figure_names
        return f"; no run has this figure{meant(figure, names)}" if names and figure not in names else ""

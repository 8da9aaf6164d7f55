"""Declaration of an experiment: the content of its experiment.toml, cases, variants and what figures must be."""

import math
from collections.abc import Mapping
from typing import Annotated, Self

from pydantic import Field, model_validator

from drawbar.experiment.columns import unknown_columns
from drawbar.experiment.statistics import Statistic
from drawbar.settings import Positive, Settings

Texts = Annotated[tuple[str, ...], Field(strict=False)]


class Expectation(Settings):
    """What a figure must be: near a value, or within limits; in the figure's own unit. Its mean, or each run's."""

    value: float | None = None
    within: Positive | None = None
    """largest deviation from value, relative to it"""
    at_most: float | None = None
    at_least: float | None = None
    in_every_run: bool = False
    """the largest of all seeds must be at_most that, instead of their mean"""

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        near = (self.value is None, self.within is None)
        if near not in ((True, True), (False, False)) or near[0] == (self.at_most is None):
            raise ValueError("give either value and within, or at_most")
        if self.at_least is not None and not (self.at_most is not None and self.at_least < self.at_most):
            raise ValueError("at_least belongs to an at_most that is more; else give value and within")
        if self.in_every_run and (self.at_most is None or self.at_least is not None):
            raise ValueError("in_every_run belongs to an at_most alone")
        return self

    def judged(self, statistic: Statistic) -> float:
        """Return what of a figure's runs is judged."""
        return statistic.largest if self.in_every_run else statistic.mean

    def holds(self, mean: float) -> bool:
        """Return whether a mean, or the largest of all runs, meets it; NaN never does."""
        if self.value is not None and self.within is not None:
            return abs(mean - self.value) <= self.within * abs(self.value)
        least = -math.inf if self.at_least is None else self.at_least
        return self.at_most is not None and least <= mean <= self.at_most

    def __str__(self) -> str:
        if self.value is not None and self.within is not None:
            return f"{self.value:g} ± {100.0 * self.within:g} %"
        if self.at_least is not None:
            return f"{self.at_least:g} to {self.at_most:g}"
        return f"≤ {self.at_most:g}{' in every run' if self.in_every_run else ''}"


class Variant(Settings):
    """Changes under a name."""

    name: str
    changes: Texts = ()
    """texts KEY=VALUE, as for --set"""
    alteration: str = ""
    """function of the experiment's alterations that changes what no KEY=VALUE can; empty: none"""
    from_the_start: bool = False
    """where runs are rehearsed, the variant's alteration is applied before the run begins, not at the fault's place"""
    expected: Mapping[str, Expectation] = {}
    """by name of the figure: of it in every variant of the case, or of every case in the variant"""
    only_named: bool = False
    """of a variant: driven only in cases that name it among their variants"""


class Case(Variant):
    """A configuration under a name, with changes."""

    configuration: str = ""
    """shipped name, or a TOML file in the experiment's folder; empty: the case's own name"""
    variants: Texts = ()
    """names of those that it is driven in, or of selections of them; empty: all"""
    seeds: Annotated[int, Field(ge=1)] | None = None
    """runs of this case, with the seeds 0, 1, …; none: as the experiment declares"""
    needs: str = ""
    """file or folder, seen from where the command is run, without which the case is left out; empty: nothing"""


class ExperimentSettings(Settings):
    """The content of experiment.toml."""

    title: str
    learned: str = ""
    """one sentence for the report's first lines; {case|figure} stands for what was measured, else it is left out"""
    why_missed: str = ""
    """the reason why expected figures are missed, for the same place, likewise"""
    seeds: Annotated[int, Field(ge=1)] = 20
    """runs of each case, with the seeds 0, 1, …"""
    side_by_side: Texts = ()
    """figures that the report shows beside those of other experiments, for cases of the same name"""
    columns: Texts = ()
    """what is kept of a run step by step, see Task.columns"""
    rehearsed: bool = False
    """drive on stand-ins of all devices, see Task.rehearsed; alterations are functions of a Trial, and a variant's is
    its fault"""
    one_at_a_time: bool = False
    """for figures of time: no other run beside the one that is measured, and that one on a single core"""
    changes: Texts = ()
    """of all cases"""
    cases: Annotated[tuple[Case, ...], Field(strict=False, min_length=1)]
    variants: Annotated[tuple[Variant, ...], Field(strict=False)] = ()
    """each case is driven in every one, or in those that it names; empty: as it is"""
    selections: Mapping[str, Texts] = {}
    """names of variants, under a name by which several cases may name them all"""
    expected: Mapping[str, Mapping[str, Expectation]] = {}
    """by name of the case (`CASE: VARIANT` where there are variants), then by name of the figure"""

    def named_variants(self, case: Case) -> frozenset[str]:
        """Return the names of the variants that a case names, itself or by a selection; none: all."""
        return frozenset(name for each in case.variants for name in self.selections.get(each, (each,)))

    @model_validator(mode="after")
    def _variants_exist(self) -> Self:
        known = [variant.name for variant in self.variants]
        for case in self.cases:
            if strangers := sorted(self.named_variants(case) - set(known)):
                raise ValueError(
                    f"case {case.name!r} names no variant: {', '.join(strangers)}; "
                    f"variants: {', '.join([*known, *self.selections]) or 'none'}"
                )
        return self

    @model_validator(mode="after")
    def _columns_exist(self) -> Self:
        if unknown := unknown_columns(self.columns, rehearsed=self.rehearsed):
            there = (
                "watch.NAME, for runs are rehearsed"
                if self.rehearsed
                else ("a number of a StepRecord as in estimate.tractor.x, error.BODY, progress.BODY, deviation.NAME")
            )
            raise ValueError(f"columns has what no run has: {', '.join(unknown)}; a column is {there}")
        return self

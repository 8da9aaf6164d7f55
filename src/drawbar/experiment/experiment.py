"""An experiment: a folder with an experiment.toml that declares what is driven, how often, and what must come out."""

import math
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import product
from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, ValidationError, model_validator

from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError
from drawbar.experiment.alteration import Alteration, find_alteration
from drawbar.experiment.columns import unknown_columns
from drawbar.experiment.statistics import Statistic
from drawbar.experiment.task import Task
from drawbar.misspelt import meant
from drawbar.settings import Positive, Settings
from drawbar.wrong_values import explained

FILE_NAME = "experiment.toml"
FOLDER = Path("experiments")
FIGURE = re.compile(r"\{([^|{}]+)\|([^|{}]+)\}")
"""{case|figure} in a text: stands for what was measured"""
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
    """names of those that it is driven in; empty: all"""
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
    expected: Mapping[str, Mapping[str, Expectation]] = {}
    """by name of the case (`CASE: VARIANT` where there are variants), then by name of the figure"""

    @model_validator(mode="after")
    def _variants_exist(self) -> Self:
        known = [variant.name for variant in self.variants]
        for case in self.cases:
            if strangers := sorted(set(case.variants) - set(known)):
                raise ValueError(
                    f"case {case.name!r} names no variant: {', '.join(strangers)}; "
                    f"variants: {', '.join(known) or 'none'}"
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Experiment:
    """An experiment, read and checked."""

    folder: Path
    settings: ExperimentSettings
    configurations: Mapping[str, str]
    """complete TOML by name of the case (`CASE: VARIANT` where there are variants)"""
    alterations: Mapping[str, tuple[Alteration, ...]]
    """by name of the case; of a rehearsed one without its fault"""
    faults: Mapping[str, Alteration]
    """by name of the case: what the alteration of its variant is where runs are rehearsed"""
    expected: Mapping[str, Mapping[str, Expectation]]
    """by name of the case, then by name of the figure"""
    seeds: Mapping[str, int]
    """runs of a case, by its name"""
    left_out: Mapping[str, str]
    """why a case is not driven, by its name (without a variant)"""

    def with_cases(self, texts: Sequence[str]) -> Self:
        """Return it with those of its cases only whose names hold one of some texts; none: all.

        Raises:
            ConfigurationError: there are none; lists those that there are.
        """
        if not texts:
            return self
        chosen = {name: each for name, each in self.configurations.items() if any(text in name for text in texts)}
        if self.configurations and not chosen:
            raise ConfigurationError(
                f"{self.folder}: no case's name holds {' or '.join(texts)}; cases: {', '.join(self.configurations)}."
            )
        return replace(self, configurations=chosen)

    def tasks(self, seeds: int | None = None) -> dict[str, list[Task]]:
        """Return the runs of every case, with the seeds from 0 on: so many, or as many as the experiment declares."""
        columns, one_core = self.settings.columns, self.settings.one_at_a_time
        return {
            name: [
                Task(
                    configuration=configuration,
                    seed=seed,
                    columns=columns,
                    one_core=one_core,
                    rehearsed=self.settings.rehearsed,
                    alterations=self.alterations[name],
                    fault=self.faults.get(name),
                )
                for seed in range(seeds or self.seeds[name])
            ]
            for name, configuration in self.configurations.items()
        }


def find_experiments(name: str) -> list[Path]:
    """Return the folder of the experiment (its path, or its name in ./experiments), or of every one for `all`.

    Raises:
        ConfigurationError: there is no such experiment; lists those that there are.
    """
    known = sorted(file.parent for file in FOLDER.glob(f"*/{FILE_NAME}"))
    if name == "all" and known:
        return known
    for folder in (FOLDER / name, Path(name)):
        if (folder / FILE_NAME).is_file():
            return [folder if folder.name.strip(".") else folder.resolve()]  # `.` has no name of its own
    listed = ", ".join(folder.name for folder in known) or "none; run the command where drawbar's repository lies"
    near = meant(name, [folder.name for folder in known])
    raise ConfigurationError(
        f"{name}: is no experiment{near}, which is a folder with {FILE_NAME}. Give a folder, `all`, or one of "
        f"{FOLDER}/: {listed}."
    )


def load_experiment(folder: Path) -> Experiment:
    """Read an experiment with the configurations of all its cases.

    Raises:
        ConfigurationError: unreadable, unknown or impossible key, double name, a configuration that cannot be read, an
            expectation of no case.
    """
    file = folder / FILE_NAME
    settings = _settings(file)
    driven = _driven(folder, settings)
    if strangers := set(settings.expected) - set(driven):
        raise ConfigurationError(
            f"{file}: expected names no case: {', '.join(sorted(strangers))}; cases: {', '.join(driven)}."
        )
    named = [case for case, _ in named_figures(settings.learned + settings.why_missed)]
    if strangers := set(named) - set(driven):
        raise ConfigurationError(
            f"{file}: learned or why_missed names no case: {', '.join(sorted(strangers))}; cases: {', '.join(driven)}."
        )
    there = {name: each for name, each in driven.items() if not _missing(each[0])}
    return Experiment(
        folder=folder,
        settings=settings,
        configurations=_configurations(folder, settings, there),
        alterations={
            name: _alterations(folder, (case,) if _is_fault(settings, variant) else (case, variant))
            for name, (case, variant) in there.items()
        },
        faults={
            name: find_alteration(folder, variant.alteration)
            for name, (_, variant) in there.items()
            if _is_fault(settings, variant)
        },
        expected={
            name: figures
            for name, (case, variant) in driven.items()
            if (figures := {**case.expected, **variant.expected, **settings.expected.get(name, {})})
        },
        seeds={name: case.seeds or settings.seeds for name, (case, _) in there.items()},
        left_out={case.name: f"{case.needs} is not here" for case in settings.cases if _missing(case)},
    )


def named_figures(text: str) -> list[tuple[str, str]]:
    """Return the case and the name of every {case|figure} in a text."""
    return FIGURE.findall(text)


def _settings(file: Path) -> ExperimentSettings:
    """Return the content of an experiment's file; raise ConfigurationError where it is none, or a value is wrong."""
    try:
        data = tomllib.loads(file.read_text("utf-8"))
    except (OSError, ValueError) as error:
        raise ConfigurationError(f"{file}: cannot be read as an experiment ({error}).") from error
    try:
        return ExperimentSettings.model_validate(data)
    except ValidationError as error:
        raise ConfigurationError(explained(error, data, str(file), root="experiment")) from error


def _driven(folder: Path, settings: ExperimentSettings) -> dict[str, tuple[Case, Variant]]:
    """Return every case with every variant that it is driven in, by name."""
    driven: dict[str, tuple[Case, Variant]] = {}
    for case, variant in product(settings.cases, settings.variants or (Variant(name=""),)):
        if (case.variants or variant.only_named) and variant.name not in case.variants:
            continue
        name = f"{case.name}: {variant.name}" if variant.name else case.name
        if name in driven:
            raise ConfigurationError(f"{folder / FILE_NAME}: two cases are called {name!r}; rename one.")
        driven[name] = case, variant
    return driven


def _missing(case: Case) -> bool:
    return bool(case.needs) and not Path(case.needs).exists()


def _configurations(
    folder: Path, settings: ExperimentSettings, driven: Mapping[str, tuple[Case, Variant]]
) -> dict[str, str]:
    """Return the complete configuration of every case in its variant; what differs in alterations only is read once."""

    @cache
    def complete(source: str, changes: tuple[str, ...]) -> str:
        beside = folder / source
        return load_configuration(str(beside) if beside.is_file() else source, changes).to_toml()

    found: dict[str, str] = {}
    for name, (case, variant) in driven.items():
        try:
            changes = (*settings.changes, *case.changes, *variant.changes)
            found[name] = complete(case.configuration or case.name, changes)
        except ConfigurationError as error:
            named = "" if case.configuration else ", whose name is that of its configuration,"
            raise ConfigurationError(f"{folder / FILE_NAME}: case {name!r}{named} cannot be read: {error}") from error
    return found


def _is_fault(settings: ExperimentSettings, variant: Variant) -> bool:
    """Return whether a variant's alteration is applied at the fault's place."""
    return settings.rehearsed and bool(variant.alteration) and not variant.from_the_start


def _alterations(folder: Path, changed: Sequence[Variant]) -> tuple[Alteration, ...]:
    return tuple(find_alteration(folder, each.alteration) for each in changed if each.alteration)

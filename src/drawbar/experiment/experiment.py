"""An experiment, read from its folder: the configurations of all cases, and what each is driven with."""

import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import product
from pathlib import Path
from typing import Self

from pydantic import ValidationError

from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError
from drawbar.experiment.alteration import Alteration, find_alteration
from drawbar.experiment.declaration import Case, Expectation, ExperimentSettings, Variant
from drawbar.experiment.task import Task
from drawbar.misspelt import meant
from drawbar.wrong_values import explained

FILE_NAME = "experiment.toml"
FOLDER = Path("experiments")
FIGURE = re.compile(r"\{([^|{}]+)\|([^|{}]+)\}")
"""{case|figure} in a text: stands for what was measured"""


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
    _demand_cases(f"{file}: expected", settings.expected, driven)
    in_texts = [case for case, _ in named_figures(settings.learned + settings.why_missed)]
    _demand_cases(f"{file}: learned or why_missed", in_texts, driven)
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
        if (case.variants or variant.only_named) and variant.name not in settings.named_variants(case):
            continue
        name = f"{case.name}: {variant.name}" if variant.name else case.name
        if name in driven:
            raise ConfigurationError(f"{folder / FILE_NAME}: two cases are called {name!r}; rename one.")
        driven[name] = case, variant
    return driven


def _demand_cases(place: str, named: Iterable[str], driven: Iterable[str]) -> None:
    """Refuse names of cases that there are not, at a place that names them."""
    if strangers := set(named) - set(driven):
        raise ConfigurationError(f"{place} names no case: {', '.join(sorted(strangers))}; cases: {', '.join(driven)}.")


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

"""Report of a search: Markdown with CSV and pictures, and a table for the terminal."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Group, RenderableType

from drawbar.experiment.document import RESULTS_NAME
from drawbar.experiment.elements import Element, Picture, Table, Text
from drawbar.experiment.statistics import Statistic
from drawbar.experiment.tuning.comparison import Candidate, Comparison
from drawbar.experiment.tuning.parameters import SearchSpace, to_toml
from drawbar.experiment.tuning.pictures import draw_front, draw_parameters, picture_height
from drawbar.experiment.tuning.study import Score, Trial, front
from drawbar.experiment.writing import writing
from drawbar.report.tables import counted, number
from drawbar.terminal import FittedTable

_CM, _DEGREES = 100.0, math.degrees(1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Findings:
    """Everything in a report."""

    space: SearchSpace
    seed: int
    trials: Sequence[Trial]
    comparison: Comparison
    importances: Mapping[str, tuple[float, float]]
    """for error and effort, by key; empty after too few trials"""


def write_findings(folder: Path, findings: Findings) -> Path:
    """Write results.md with its tables (CSV) and pictures (SVG) into the folder; return the file."""
    elements = _elements(findings)
    for element in elements:
        element.write(folder)
    file = folder / RESULTS_NAME
    with writing(file):
        file.write_text("\n\n".join(["# Tuning", *(element.markdown() for element in elements)]) + "\n", "utf-8")
    return file


def terminal_table(findings: Findings) -> RenderableType:
    """Return the front as a table for the terminal."""
    keys = [parameter.key.replace(".", "\n.") for parameter in findings.space.parameters]
    rows = [
        (_name(one), [_cm(one.error), _degrees(one.effort), *_values(findings, one.trial)])
        for one in _own_first(findings.comparison)
    ]
    columns = [(name, "") for name in ("error, cm", "steering, °/s", *keys)]
    title = "the front on fresh seeds, mean ± 95 % interval"
    return Group(title, FittedTable("trial", columns, rows, title_width=len("trial")))


def verdict(findings: Findings) -> str:
    """Return how far the configuration's own values are from the best that was found."""
    comparison, picks = findings.comparison, findings.comparison.picks()
    own, better = comparison.own, comparison.better()
    said = [f"Own values: error {_cm(own.error)} cm, steering {_degrees(own.effort)} °/s (mean ± 95 % interval)."]
    if better:
        said.append(f"Better in one and no worse in the other: trials {', '.join(map(_name, better))}.")
    else:
        said.append("No trial of the front is better than they are.")
    for title, pick in picks.items():
        if pick is not own:
            error, effort = comparison.gain(pick)
            said.append(
                f"{title.capitalize()}: trial {pick.trial.number}, error {_cm(error)} cm "
                f"({_percent(error, own.error)}), steering {_degrees(effort)} °/s ({_percent(effort, own.effort)})."
            )
        else:
            said.append(f"{title.capitalize()}: the own values.")
    return "\n".join(said)


def _elements(findings: Findings) -> list[Element]:
    own, best = findings.comparison.own.trial, front(findings.trials)
    return [
        Text(text=_what_was_searched(findings)),
        _parameters(findings),
        Text(text="\n".join(f"- {line}" for line in verdict(findings).splitlines())),
        Table(
            name="front",
            caption="The front by the search's seeds (*search*), driven again with the fresh ones (*fresh*, mean ± "
            "95 % interval; *less own*: seed by seed): error in cm, steering in °/s.",
            header=_front_header(findings),
            rows=_front_rows(findings),
        ),
        Picture(
            name="front",
            caption="Error and steering of every trial, mean over the search's seeds, with the front and the "
            "configuration's own values.",
            draw=lambda figure: draw_front(figure, findings.trials, best, own),
        ),
        Picture(
            name="parameters",
            caption="The same trials over each parameter.",
            draw=lambda figure: draw_parameters(figure, findings.space.parameters, findings.trials, best, own),
            size=(8.0, picture_height(findings.space.parameters)),
        ),
        Text(text=_snippets(findings)),
    ]


def _what_was_searched(findings: Findings) -> str:
    space, tuning = findings.space, findings.space.configuration.tuning
    outcomes = [trial.outcome for trial in findings.trials]
    given_up = sum(isinstance(outcome, Score) and outcome.unfinished > 0.0 for outcome in outcomes)
    refused = sum(not isinstance(outcome, Score) for outcome in outcomes)
    changes = "".join(f" --set '{change}'" for change in space.changes)
    ranges = " ".join(map(str, space.parameters))
    return (
        f"Made by `drawbar tune {space.source}{changes} --parameters '{ranges}' --trials {len(outcomes)} --seed "
        f"{findings.seed}`. Each trial is driven with the seeds 0 to {tuning.seeds - 1}; its error is the "
        f"{tuning.error} distance from the path, its effort the mean steering rate, each the mean of both bodies. "
        f"{counted(given_up, 'trial')} {'was' if given_up == 1 else 'were'} given up before the end of the path, "
        f"{refused} had values that the configuration refuses. The front is driven again with the fresh seeds "
        f"{tuning.seeds} to {tuning.seeds + tuning.fresh_seeds - 1}."
    )


def _parameters(findings: Findings) -> Table:
    rows = [
        [
            parameter.key,
            f"{parameter.low:g} to {parameter.high:g}{', logarithmic' if parameter.log else ''}",
            f"{parameter.own:g}",
            *(f"{100.0 * share:.0f} %" for share in findings.importances.get(parameter.key, ())),
        ]
        for parameter in findings.space.parameters
    ]
    header = ["parameter", "searched", "own", *(("for error", "for effort") if findings.importances else ())]
    caption = "What was searched, and how much each decides whether a trial is among the best (PED-ANOVA)."
    return Table(name="parameters", caption=caption, header=header, rows=rows)


def _front_header(findings: Findings) -> list[str]:
    figures = ("error, search", "error, fresh", "less own", "steering, search", "steering, fresh", "less own")
    return ["trial", *(parameter.key for parameter in findings.space.parameters), *figures]


def _front_rows(findings: Findings) -> list[list[str]]:
    return [_front_row(findings, candidate) for candidate in _own_first(findings.comparison)]


def _own_first(comparison: Comparison) -> list[Candidate]:
    return [comparison.own, *(candidate for candidate in comparison.front if candidate.trial.number)]


def _front_row(findings: Findings, candidate: Candidate) -> list[str]:
    trial, (error, effort) = candidate.trial, findings.comparison.gain(candidate)
    searched = trial.outcome
    found = (searched.error, searched.effort) if isinstance(searched, Score) else (math.nan, math.nan)
    apart = (_cm(error), _degrees(effort)) if trial.number else ("", "")
    return [
        _name(candidate),
        *_values(findings, trial),
        *(f"{_CM * found[0]:.2f}", _cm(candidate.error), apart[0]),
        *(f"{_DEGREES * found[1]:.2f}", _degrees(candidate.effort), apart[1]),
    ]


def _snippets(findings: Findings) -> str:
    """Return what to paste, for each pick, with titles; the same pick only once."""
    titles: dict[int, list[str]] = {}
    picks = findings.comparison.picks()
    for title, candidate in picks.items():
        titles.setdefault(candidate.trial.number, []).append(title)
    by_number = {candidate.trial.number: candidate.trial for candidate in picks.values()}
    blocks = ["To paste into a configuration:"]
    for index, names in titles.items():
        title = f"{'; '.join(names).capitalize()} ({f'trial {index}' if index else 'the own values'}):"
        blocks.append(f"{title}\n\n```toml\n{to_toml(_rounded(by_number[index]))}```")
    return "\n\n".join(blocks)


def _rounded(trial: Trial) -> dict[str, float]:
    """Return the values with as many digits as a reader cares for."""
    return {key: float(f"{value:.4g}") if isinstance(value, float) else value for key, value in trial.values.items()}


def _values(findings: Findings, trial: Trial) -> list[str]:
    return [f"{trial.values[parameter.key]:.4g}" for parameter in findings.space.parameters]


def _name(candidate: Candidate) -> str:
    name = f"{candidate.trial.number}" if candidate.trial.number else "own"
    return name + (f" ({candidate.fresh.given_up} given up)" if candidate.fresh.given_up else "")


def _scaled(statistic: Statistic, scale: float, digits: int) -> str:
    return f"{number(scale * statistic.mean, digits)} ± {number(scale * statistic.half_width, digits)}"


def _cm(statistic: Statistic) -> str:
    return _scaled(statistic, _CM, 2)


def _degrees(statistic: Statistic) -> str:
    return _scaled(statistic, _DEGREES, 2)


def _percent(difference: Statistic, own: Statistic) -> str:
    return f"{100.0 * difference.mean / own.mean:+z.1f} %"

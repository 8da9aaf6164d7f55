"""Results as Markdown: one results.md per experiment, and REPORT.md, which sums up all of them."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from drawbar.benchmark.figures import machine
from drawbar.errors import StorageError
from drawbar.experiment.elements import Element, markdown_table
from drawbar.experiment.measured import REPORT_NAME, MeasuredExperiment
from drawbar.experiment.writing import writing
from drawbar.report.tables import counted

RESULTS_NAME = "results.md"
SUMMARY_NAME = "summary.json"
_UNTOLD = "The reason that is known names cases without a result."


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """An experiment's entry in REPORT.md."""

    title: str
    learned: str
    """empty: nothing to report"""
    why_missed: str
    cases: int
    seeds: int
    expected: int
    """figures that were expected"""
    missed: int
    """of them"""
    lost: int = 0
    """runs of the cases with expected figures that have no result or did not come to the end of the path"""
    side_by_side: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    """by names of case and figure: what is shown beside other experiments"""
    machine: Mapping[str, str]
    """on which the runs were made, without its compiler, whose name is a path of that machine"""


def write_results(measured: MeasuredExperiment, elements: Sequence[Element], folder: Path | None = None) -> None:
    """Write tables (CSV), pictures (SVG), results.md and the summary into a folder; None: the experiment's own."""
    own = measured.experiment.folder
    folder = folder or own
    for element in elements:
        element.write(folder)
    title = f"# {measured.experiment.settings.title}"
    origin = f"Made by `drawbar experiment {own.name}`{_compared(folder)}."
    text = "\n\n".join([title, origin, *_sections(measured, elements)])
    with writing(file := folder / RESULTS_NAME):
        file.write_text(f"{text}\n", "utf-8")
    content = msgspec.json.format(msgspec.json.encode(_summary(measured)), indent=2)
    with writing(file := folder / SUMMARY_NAME):
        file.write_bytes(content + b"\n")


def _compared(folder: Path) -> str:
    """Return where it is explained what is compared; empty where nothing is written."""
    return "; [README.md](README.md) says what is compared" if (folder / "README.md").is_file() else ""


def _summary(measured: MeasuredExperiment) -> Summary:
    settings, misses = measured.experiment.settings, measured.misses()
    missed = sum(not verdict.holds for verdict in measured.verdicts())
    return Summary(
        title=settings.title,
        learned=measured.filled_in(settings.learned),
        why_missed=(measured.filled_in(settings.why_missed) or _UNTOLD) if misses and settings.why_missed else "",
        cases=len(measured.cases),
        seeds=measured.seeds,
        expected=len(measured.verdicts()),
        missed=missed,
        lost=len(misses) - missed,
        side_by_side={
            case: {figure: measured.named_statistic(case, figure).text() for figure in settings.side_by_side}
            for case in measured.cases
            if settings.side_by_side
        },
        machine={name: text for name, text in machine().items() if name != "compiler"},
    )


def write_report(folder: Path) -> None:
    """Write REPORT.md of all experiments of a folder that have been driven.

    Raises:
        DrawbarError: it cannot be written, or the summary of an experiment cannot be read.
    """
    summaries = {file.parent.name: _read_summary(file) for file in sorted(folder.glob(f"*/{SUMMARY_NAME}"))}
    blocks = ["# Experiments", "Made by `drawbar experiment`, anew after each of them; do not edit."]
    blocks += [*_opening(summaries.values()), "## All experiments", _overview(summaries), _machines(summaries.values())]
    blocks += _side_by_side(summaries.values())
    with writing(file := folder / REPORT_NAME):
        file.write_text("\n\n".join(blocks) + "\n", "utf-8")


def _read_summary(file: Path) -> Summary:
    try:
        return msgspec.json.decode(file.read_bytes(), type=Summary)
    except (OSError, msgspec.MsgspecError) as error:
        raise StorageError(
            f"{file}: cannot be read as a summary ({error}), so {REPORT_NAME} is not written again; drive that "
            f"experiment again: drawbar experiment {file.parent}"
        ) from error


def _opening(summaries: Collection[Summary]) -> list[str]:
    """Return the first lines: what was learned, and what was missed and why."""
    lines = [f"- {each.learned}" for each in summaries if each.learned]
    for each in summaries:
        if each.missed or each.lost:
            lost = f", and {each.lost} of its runs did not come to the end" if each.lost else ""
            of = f"{each.missed} of {each.expected} expected figures of *{each.title}*{lost}"
            lines.append(f"- **Missed**: {of}. {each.why_missed or 'The reason is not known.'}")
    return ["## What was learned", "\n".join(lines)] if lines else []


def _overview(summaries: Mapping[str, Summary]) -> str:
    rows = [
        [
            f"[{each.title}]({name}/{RESULTS_NAME})",
            f"[what is compared]({name}/README.md)",
            f"{each.cases}",
            f"{each.seeds}",
            f"{each.expected}",
            f"**{each.missed}**" if each.missed else "0",
        ]
        for name, each in summaries.items()
    ]
    return markdown_table(["experiment", "", "cases", "seeds", "expected figures", "missed"], rows)


def _side_by_side(summaries: Iterable[Summary]) -> list[str]:
    """Return a table of the cases that several experiments have, each with the figures that it shows of them."""
    shown = [each for each in summaries if each.side_by_side]
    cases = (
        [case for case in shown[0].side_by_side if all(case in each.side_by_side for each in shown)] if shown else []
    )
    if len(shown) < 2 or not cases:
        return []
    rows = [[case, *(" / ".join(each.side_by_side[case].values()) for each in shown)] for case in cases]
    figures = " / ".join(shown[0].side_by_side[cases[0]])
    table = markdown_table(["", *(each.title for each in shown)], rows)
    return ["## The same cases side by side", f"{figures}, mean over the seeds ± 95 % interval.", table]


def _machines(summaries: Iterable[Summary]) -> str:
    """Return on what machine the runs were made, once for all experiments that share it."""
    titles: dict[str, list[str]] = {}
    for each in summaries:
        titles.setdefault(", ".join(f"{fact} {text}" for fact, text in each.machine.items()), []).append(each.title)
    return "\n".join(f"- Measured on {machine}: {', '.join(those)}." for machine, those in titles.items())


def _sections(measured: MeasuredExperiment, elements: Sequence[Element]) -> list[str]:
    results = [result for runs in measured.runs.values() for result in runs.results]
    given_up = sum(not result.metrics.finished for result in results)
    fewer = any(len(each) < measured.seeds for each in measured.figures.values())
    said = (
        f"{counted(len(measured.cases), 'case')} with the seeds 0 to {measured.seeds - 1}"
        f"{' at most' if fewer else ''}: {counted(len(results), 'run')}, {given_up} of them given up before the end "
        "of the path."
    )
    return [said, *_left_out(measured), *(element.markdown() for element in elements), *_judgement(measured)]


def _left_out(measured: MeasuredExperiment) -> list[str]:
    """Return which cases were not driven, and why, and which texts for REPORT.md name some without a result."""
    reasons = measured.experiment.left_out.items()
    not_driven = [f"Not driven: {'; '.join(f'{case} ({reason})' for case, reason in reasons)}."] if reasons else []
    return [*not_driven, *(f"{each}." for each in measured.left_out_texts())]


def _judgement(measured: MeasuredExperiment) -> list[str]:
    """Return the expected figures beside the measured ones, and everything that is missed."""
    rows = [
        [
            verdict.case,
            verdict.figure,
            verdict.found,
            str(verdict.expected),
            "yes" if verdict.holds else "**missed**",
        ]
        for verdict in measured.verdicts()
    ]
    table = markdown_table(["case", "figure", "mean", "expected", "held"], rows)
    missed = "\n".join(f"- {miss}" for miss in measured.misses())
    return [*(["**Expected figures**", table] if rows else []), *(["**Missed**", missed] if missed else [])]

"""Results as Markdown: one results.md per experiment, and REPORT.md of all of them."""

from collections.abc import Sequence
from pathlib import Path

from drawbar.benchmark.figures import machine
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.experiment.parts import Part, markdown_table

RESULTS_NAME = "results.md"
REPORT_NAME = "REPORT.md"


def write_results(measured: MeasuredExperiment, parts: Sequence[Part]) -> None:
    """Write tables (CSV), pictures (SVG) and results.md into the experiment's folder."""
    folder = measured.experiment.folder
    for part in parts:
        part.write(folder)
    title = f"# {measured.experiment.settings.title}"
    origin = f"Made by `drawbar experiment {folder.name}`; [README.md](README.md) says what is compared."
    text = "\n\n".join([title, origin, *_sections(measured, parts, "")])
    (folder / RESULTS_NAME).write_text(f"{text}\n", "utf-8")


def write_report(file: Path, outcomes: Sequence[tuple[MeasuredExperiment, Sequence[Part]]]) -> None:
    """Write the report of several experiments, whose folders lie beside it."""
    blocks = ["# Experiments", "Made by `drawbar experiment all`; do not edit."]
    blocks += [*_opening([measured for measured, _ in outcomes]), _machine_table(), _overview(outcomes)]
    for measured, parts in outcomes:
        prefix = f"{measured.experiment.folder.name}/"
        blocks += [
            f"## {measured.experiment.settings.title}",
            f"What is compared, and with what: [{prefix}README.md]({prefix}README.md).",
        ]
        blocks += _sections(measured, parts, prefix)
    file.write_text("\n\n".join(blocks) + "\n", "utf-8")


def _opening(experiments: Sequence[MeasuredExperiment]) -> list[str]:
    """Return the first lines: what was learned, and what was missed and why."""
    learned = [measured.told(measured.experiment.settings.learned) for measured in experiments]
    lines = [f"- {text}" for text in learned if text]
    for measured in experiments:
        if missed := len(measured.misses()):
            settings = measured.experiment.settings
            of = f"{missed} of {len(measured.verdicts())} expected figures of *{settings.title}*"
            reason = measured.told(settings.why_missed) or "The reason is not known."
            lines.append(f"- **Missed**: {of}. {reason}")
    return ["## What was learned", "\n".join(lines)] if lines else []


def _machine_table() -> str:
    facts = {name: text for name, text in machine().items() if name != "compiler"}  # it names a path of this machine
    return markdown_table(["measured on", ""], [list(fact) for fact in facts.items()])


def _overview(outcomes: Sequence[tuple[MeasuredExperiment, Sequence[Part]]]) -> str:
    rows = [
        [
            measured.experiment.folder.name,
            f"{len(measured.cases)}",
            f"{measured.seeds}",
            f"{len(measured.verdicts())}",
            f"**{len(measured.misses())}**" if measured.misses() else "0",
        ]
        for measured, _ in outcomes
    ]
    return markdown_table(["experiment", "cases", "seeds", "expected figures", "missed"], rows)


def _sections(measured: MeasuredExperiment, parts: Sequence[Part], prefix: str) -> list[str]:
    results = [result for runs in measured.runs.values() for result in runs.results]
    given_up = sum(not result.metrics.finished for result in results)
    fewer = any(len(each) < measured.seeds for each in measured.figures.values())
    said = (
        f"{len(measured.cases)} cases with the seeds 0 to {measured.seeds - 1}{' at most' if fewer else ''}: "
        f"{len(results)} runs, "
        f"{given_up} of them given up before the end of the path."
    )
    return [said, *_left_out(measured), *(part.markdown(prefix) for part in parts), *_judgement(measured)]


def _left_out(measured: MeasuredExperiment) -> list[str]:
    """Say which cases were not driven, and why."""
    reasons = measured.experiment.left_out.items()
    return [f"Not driven: {'; '.join(f'{case} ({reason})' for case, reason in reasons)}."] if reasons else []


def _judgement(measured: MeasuredExperiment) -> list[str]:
    """Return the expected figures beside the measured ones, and everything that is missed."""
    rows = [
        [
            verdict.case,
            verdict.figure,
            verdict.statistic.text(2),
            str(verdict.expected),
            "yes" if verdict.holds else "**missed**",
        ]
        for verdict in measured.verdicts()
    ]
    table = markdown_table(["case", "figure", "mean", "expected", "held"], rows)
    missed = "\n".join(f"- {miss}" for miss in measured.misses())
    return [*(["**Expected figures**", table] if rows else []), *(["**Missed**", missed] if missed else [])]

"""Console report of `drawbar tube`: what it prints."""

from collections.abc import Iterable, Mapping
from typing import Any

import tomli_w
from rich.console import Group, RenderableType
from rich.text import Text

from drawbar.control.settings import DECLARED_SECTIONS
from drawbar.control.tube.tube import SubsystemTube
from drawbar.report.tables import Row, counted
from drawbar.report.tube.recorded import CONFIDENCE, Finding, coverage
from drawbar.report.tube.tables import (
    FINDING_COLUMNS,
    SET_COLUMNS,
    bound_columns,
    bound_rows,
    finding_rows,
    law_text,
    set_rows,
    unbounded_text,
    undeclared_text,
)
from drawbar.terminal import FittedTable

_UNVIOLATED = {True: Text("None is violated.", "green"), False: Text("None is declared.")}
_COLOURS = {"tractor": "blue", "trailer": "yellow"}


def _table(title: str, columns: Iterable[str], rows: list[Row], width: int = 34) -> FittedTable:
    styled = [
        (name, [Text(cell, "bold red" if cell.startswith("nothing") else "") for cell in cells]) for name, cells in rows
    ]
    return FittedTable(title, [(name, "") for name in columns], styled, title_width=width, column_width=9)


def tube_text(body: str, tube: SubsystemTube, advice: Iterable[str], raised: str = "") -> RenderableType:
    """Return the tube of one body for the console, as wide as that is; `raised`: what counts as more than declared."""
    parts: list[RenderableType] = ["", Text(body, f"bold {_COLOURS[body]}"), law_text(tube)]
    if tube.invariant_set is not None:
        parts += ["", _table("set", SET_COLUMNS, set_rows(tube))]
        parts += ["", _table("bounds", bound_columns(tube), bound_rows(tube))]
    notes = [note for note in (raised, unbounded_text(tube), undeclared_text(tube)) if note]
    return Group(*parts, "", *notes, *(Text(text, "bold red") for text in advice))


def findings_text(body: str, findings: list[Finding]) -> RenderableType:
    """Return what logs show of the bounds of one body, for the console."""
    samples = min(len(finding.magnitudes) for finding in findings)
    declared = any(finding.declared for finding in findings)
    violated = [f"{finding.section}.{finding.name}" for finding in findings if finding.declared and finding.beyond]
    verdict = Text(f"Violated: {', '.join(violated)}", "bold red") if violated else _UNVIOLATED[declared]
    confidence = (
        f"{counted(samples, 'sample')}: the largest of them bounds {coverage(samples):.1%} of all samples like these "
        f"with {CONFIDENCE:.0%} confidence, were they independent (Wilks 1941)."
    )
    tables = [
        _table(section, FINDING_COLUMNS, finding_rows(rows), 20)
        for section in DECLARED_SECTIONS
        if (rows := [finding for finding in findings if finding.section == section])
    ]
    return Group("", Text(f"{body}, recorded", f"bold {_COLOURS[body]}"), *tables, verdict, confidence)


def proposal(findings: Mapping[str, list[Finding]]) -> str:
    """Return the recorded bounds of both bodies as TOML for a configuration."""
    tube: dict[str, Any] = {
        body: {
            section: {finding.name: finding.proposed for finding in of_body if finding.section == section}
            for section in DECLARED_SECTIONS
            if any(finding.section == section for finding in of_body)
        }
        for body, of_body in findings.items()
    }
    return tomli_w.dumps({"tube": tube})

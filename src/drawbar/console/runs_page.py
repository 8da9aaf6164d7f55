"""Runs page: earlier runs, newest first, each with its report."""

import time
from dataclasses import dataclass
from pathlib import Path

from nicegui import ui

from drawbar.console.catalogue import Words
from drawbar.console.link import Link
from drawbar.console.page_head import PageHead
from drawbar.console.visitors import Visitor

REPORT, CONFIGURATION = "report.html", "config.toml"
MOST = 200
"""runs that are listed"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """One folder of a run."""

    name: str
    time: float
    """of its last change, s since the epoch"""
    has_report: bool


def list_runs(folder: Path) -> list[Run]:
    """Return the runs in a folder, newest first."""
    try:
        found = [each for each in folder.iterdir() if each.is_dir() and (each / CONFIGURATION).is_file()]
    except OSError:
        return []
    runs = [Run(name=each.name, time=each.stat().st_mtime, has_report=(each / REPORT).is_file()) for each in found]
    return sorted(runs, key=lambda run: run.time, reverse=True)[:MOST]


def report_of(folder: Path, name: str) -> Path | None:
    """Return the report of a run by its name; None: there is none. Names are looked up, never joined to a path."""
    return next((folder / run.name / REPORT for run in list_runs(folder) if run.name == name and run.has_report), None)


class RunsPage:
    """The page of one browser."""

    def __init__(self, folder: Path, link: Link, visitor: Visitor, words: Words, *, login: bool) -> None:
        """Build the page."""
        self._head = PageHead(link, visitor, words, words("runs"), login=login)
        with ui.element("main").classes("page"):
            runs = list_runs(folder)
            if not runs:
                ui.label(words("no_runs", folder=str(folder)))
            for run in runs:
                _row(run, words)

    def refresh(self) -> None:
        """Show how the drive is."""
        self._head.refresh()


def _row(run: Run, words: Words) -> None:
    with ui.element("div").classes("run"):
        with ui.element("b"):
            ui.label(run.name)
        ui.label(time.strftime("%Y-%m-%d %H:%M", time.localtime(run.time)))
        if run.has_report:
            ui.link(words("open_report"), f"/report/{run.name}")
        else:
            ui.label(words("no_report"))

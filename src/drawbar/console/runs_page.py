"""Runs page: earlier runs, newest first: report, events, export, comparison of two, deleting."""

import asyncio
import shutil
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from urllib.parse import quote

from nicegui import ui

from drawbar.configurations import CONFIGURATION_NAME
from drawbar.console.audit import Audit
from drawbar.console.language.words import Words
from drawbar.console.link import Link
from drawbar.console.page_head import PageHead, tell
from drawbar.console.run_comparison import FIGURES, METRICS, read_metrics, value_of
from drawbar.console.run_events import run_events
from drawbar.console.visitors import Visitor
from drawbar.console.widgets import button, card
from drawbar.errors import DrawbarError
from drawbar.recording.log import LOG_NAME, read_log
from drawbar.recording.table import write_csv
from drawbar.recording.tracks import write_geojson

REPORT, MAP = "report.html", "map.svg"
MOST = 1000
"""runs that are known, the newest"""
_LISTED = 15
"""that are listed at first, and more by each touch of a button: each costs time while others drive"""
_WRITTEN = 60.0
"""after the last change of a run's files, until which it is not deleted, s"""
_KINDS = {"CSV": (".csv", write_csv), "GeoJSON": (".geojson", write_geojson)}


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """One folder of a run."""

    name: str
    time: float
    """of its last change, s since the epoch"""
    has_report: bool

    def address(self, kind: str) -> str:
        """Return where the console serves a file of it: its `report` or `map`."""
        return f"/{kind}/{quote(self.name, safe='')}"


def list_runs(folder: Path) -> list[Run]:
    """Return the runs in a folder, newest first."""
    runs: list[Run] = []
    with suppress(OSError):
        for each in folder.iterdir():
            with suppress(OSError):  # somebody else has just deleted it
                if each.is_dir() and (each / CONFIGURATION_NAME).is_file():
                    report = (each / REPORT).is_file()
                    runs.append(Run(name=each.name, time=each.stat().st_mtime, has_report=report))
    return sorted(runs, key=lambda run: run.time, reverse=True)[:MOST]


def file_of(folder: Path, name: str, file: str) -> Path | None:
    """Return a file of a run by its name; None: there is none. Names are looked up, never joined to a path."""
    found = (folder / run.name / file for run in list_runs(folder) if run.name == name)
    return next((path for path in found if path.is_file()), None)


class RunsPage:
    """The page of one browser."""

    def __init__(
        self, folder: Path, current: Path, link: Link, visitor: Visitor, words: Words, audit: Audit, *, login: bool
    ) -> None:
        """Build the page; current: folder of the run that is being recorded now."""
        self._folder, self._current, self._visitor, self._words, self._audit = folder, current, visitor, words, audit
        self._head = PageHead(link, visitor, words, words("runs"), login=login)
        with ui.element("div").classes("page wide"):
            self._comparison = ui.element("div")
            self._shown = ui.element("section").classes("card")
            self._shown.set_visibility(False)
            self._list = ui.element("div")
        self._listed = _LISTED
        self._show_all()

    def refresh(self) -> None:
        """Show how the drive is."""
        self._head.refresh()

    def _button(self, key: str, act: Callable[[], object], **values: str) -> ui.button:
        return button(self._words(key, **values), act)

    def _show_all(self) -> None:
        self._comparison.clear()
        with self._comparison:
            self._build_comparison()
        self._show_list()

    def _build_comparison(self) -> None:
        runs = list_runs(self._folder)[: self._listed]  # the same as are shown
        names = [run.name for run in runs if (self._folder / run.name / METRICS).is_file()]
        if len(names) < 2:
            return
        with card(self._words("compare_two")), ui.element("div").classes("line-up"):
            self._one = ui.select(names, value=names[1], label=self._words("run_a")).props("outlined").classes("whole")
            self._other = (
                ui.select(names, value=names[0], label=self._words("run_b")).props("outlined").classes("whole")
            )
            self._button("compare", self._compare)

    def _show_list(self) -> None:
        words = self._words
        self._list.clear()
        runs = list_runs(self._folder)
        with self._list:
            if not runs:
                ui.label(words("no_runs", folder=str(self._folder)))
            for run in runs[: self._listed]:
                with ui.element("div").classes("run"):
                    self._build_run(run)
            if len(runs) > self._listed:
                self._button("more_runs", self._show_more, count=str(len(runs) - self._listed))

    def _show_more(self) -> None:
        self._listed += _LISTED
        self._show_all()

    def _build_run(self, run: Run) -> None:
        words = self._words
        with ui.element("b"):
            ui.label(run.name)
        ui.label(time.strftime("%Y-%m-%d %H:%M", time.localtime(run.time)))
        if run.has_report:
            ui.link(words("open_report"), run.address("report"), new_tab=True)
            self._button("show_map", partial(self._show_map, run))
        else:
            ui.label(words("recorded_now" if self._is_current(run) else "no_report"))
        self._button("events", partial(self._show_events, run))
        for kind in _KINDS:
            self._button("export_as", partial(self._export, run, kind), kind=kind)
        if self._visitor.may_maintain and not self._is_current(run):
            self._button("delete", partial(self._ask_deletion, run))

    def _is_current(self, run: Run) -> bool:
        return (self._folder / run.name).resolve() == self._current.resolve()

    def _compare(self) -> None:
        words = self._words
        names = (self._one.value, self._other.value)
        known = [run.name for run in list_runs(self._folder)]
        found = {name: read_metrics(self._folder / name) or {} for name in names if name in known}
        if len(found) != len(set(names)):
            self._tell_gone()
            return
        self._begin(words("compare_two"))
        with self._shown, ui.element("div").classes("scroll"), ui.element("table").classes("figures-table"):
            _row("th", "", "A", "B", "B − A")
            for figure in FIGURES:
                one, other = (value_of(figure, found[name]) for name in names)
                name = f"{words(figure.text)}, {words(figure.body)}" if figure.body else words(figure.text)
                cells = [self._figure(value, figure.decimals) for value in (one, other)]
                more = self._figure(other - one, figure.decimals, sign="+")
                _row("td", f"{name} ({figure.unit})" if figure.unit else name, *cells, more)
        with self._shown:
            for letter, name in zip("AB", names, strict=True):
                ui.label(f"{letter}: {name}, {found[name].get('outcome', '')}").classes("note")

    def _figure(self, value: float, decimals: int, *, sign: str = "") -> str:
        """Return a figure; sign: "+" where one that is not negative has a sign, too."""
        return "–" if value != value else self._words.decimal(f"{value:{sign}z.{decimals}f}".replace("-", "−"))

    def _begin(self, title: str) -> None:
        """Clear the place where results are shown, and put a title there."""
        self._shown.clear()
        self._shown.set_visibility(True)
        with self._shown, ui.element("h2"):
            ui.label(title)

    def _tell_gone(self) -> None:
        """Show that a run is not there any more: somebody else has deleted it."""
        tell(self._words("run_gone"))
        self._shown.set_visibility(False)
        self._show_all()

    def _is_there(self, run: Run) -> bool:
        if (self._folder / run.name / CONFIGURATION_NAME).is_file():
            return True
        self._tell_gone()
        return False

    def _show_map(self, run: Run) -> None:
        if not self._is_there(run):
            return
        self._begin(f"{self._words('show_map')}: {run.name}")
        with self._shown:
            picture = ui.element("img").classes("run-map")
            picture.props["src"], picture.props["alt"] = run.address("map"), f"{self._words('show_map')}: {run.name}"

    async def _show_events(self, run: Run) -> None:
        if not self._is_there(run):
            return
        try:
            log, is_on = self._folder / run.name / LOG_NAME, self._is_current(run)
            events = await asyncio.to_thread(run_events, log, self._words, is_on=is_on)
        except DrawbarError as error:
            tell(self._words.message(error))
            return
        self._begin(f"{self._words('events')}: {run.name}")
        with self._shown:
            if not events:
                ui.label(self._words("no_events"))
            for event in events:
                ui.label(f"{time.strftime('%H:%M:%S', time.localtime(event.time))}  {event.text}").classes("event")

    async def _export(self, run: Run, kind: str) -> None:
        if not self._is_there(run):
            return
        suffix, write = _KINDS[kind]

        def content() -> bytes:
            with tempfile.TemporaryDirectory(prefix="drawbar-export-") as folder:
                target = Path(folder) / f"run{suffix}"
                write(read_log(self._folder / run.name / LOG_NAME), target)
                return target.read_bytes()

        try:
            ui.download.content(await asyncio.to_thread(content), f"{run.name}{suffix}")
        except (DrawbarError, OSError) as error:
            tell(self._words.message(error))

    def _ask_deletion(self, run: Run) -> None:
        """Show what would be deleted, and delete it when that is confirmed."""
        if not self._is_there(run):
            return
        self._begin(self._words("delete_really", name=run.name))
        with self._shown, ui.element("div").classes("line-up"):
            self._button("delete_now", lambda: self._delete(run))
            self._button("keep", lambda: self._shown.set_visibility(False))

    def _delete(self, run: Run) -> None:
        known = any(each.name == run.name for each in list_runs(self._folder))
        if not known or self._is_current(run) or not self._visitor.may_maintain:
            return
        newest = max((each.stat().st_mtime for each in (self._folder / run.name).iterdir()), default=0.0)
        if time.time() - newest < _WRITTEN:  # another drive may be on
            tell(self._words("still_written", name=run.name))
            return
        try:
            shutil.rmtree(self._folder / run.name)
        except OSError as error:
            tell(f"{run.name}: {self._words.message(error.strerror)}")
        else:
            self._audit.write(self._visitor, "DELETE_RUN", run=run.name)
        self._shown.set_visibility(False)
        self._show_all()


def _row(tag: str, *texts: str) -> None:
    with ui.element("tr"):
        for text in texts:
            with ui.element(tag):
                ui.label(text)

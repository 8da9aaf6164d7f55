"""Set-up page: the vehicle's numbers beside a drawing to scale, devices with rates and ages, versions."""

import math
import shlex
from functools import partial

from nicegui import ui

from drawbar.config import Configuration
from drawbar.console.audit import Audit
from drawbar.console.calibration_card import CalibrationCard
from drawbar.console.device_rates import DEVICES, missing
from drawbar.console.language.words import Words
from drawbar.console.link import Link
from drawbar.console.next_drive import NextDrive
from drawbar.console.page_head import PageHead, tell
from drawbar.console.set_up_values import GROUPS, SetUpValue
from drawbar.console.set_up_words import changes, flaws, shown_name
from drawbar.console.valve_card import ValveCard
from drawbar.console.vehicle_drawing import number_id, vehicle_drawing
from drawbar.console.versions import Version, read_version
from drawbar.console.visitors import Visitor
from drawbar.console.widgets import button, card, heading
from drawbar.errors import DrawbarError

_VERSIONS = 10
"""that are listed"""
_FRESH = 1.0
"""s; a device that was silent for longer is marked"""
_PERIOD = 500_000_000
"""between two looks at the devices, ns"""


class SetUpPage:
    """The page of one browser."""

    def __init__(
        self, next_drive: NextDrive, link: Link, visitor: Visitor, words: Words, audit: Audit, *, login: bool
    ) -> None:
        """Build the page."""
        self._next_drive, self._link, self._visitor, self._words, self._audit = next_drive, link, visitor, words, audit
        self._numbers: dict[SetUpValue, ui.number] = {}
        self._changed: Configuration | None = None
        self._due, self._fills = 0, False
        ui.add_head_html('<script src="/drawbar/plots.js"></script>')
        self._head = PageHead(link, visitor, words, words("setup"), login=login)
        with ui.element("div").classes("page wide"), ui.element("div").classes("columns set-up"):
            with ui.element("div"):
                with ui.element("section").classes("card"):
                    self._drawing = ui.html("", sanitize=False)
                    ui.label(words("drawing_help")).classes("note")
                self._build_devices()
            with ui.element("div").classes("numbers-column"):
                for title, values in GROUPS:
                    self._build_group(title, values)
                self._build_saving()
                self._versions = ui.element("section").classes("card")
                self._build_valve()
            if self._may_change:
                self._calibration = CalibrationCard(next_drive, link, words, self._take_found)
        self._reset()

    def refresh(self) -> None:
        """Show how drive and devices are."""
        self._head.refresh()
        self._save.set_enabled(self._may_save())
        if self._may_change:
            self._calibration.refresh()
        if self._valve is not None:
            self._valve.refresh()
        now = self._link.clock()
        if now < self._due:
            return
        self._due = now + _PERIOD
        for state in (each for each in self._link.devices.states(now) if each.name in self._devices):
            known = math.isfinite(state.age)
            good = known and (state.age <= _FRESH if math.isfinite(state.rate) else state.age <= 5.0)
            age = f"{self._words.number(state.age, 1)} s" if known else "–"
            rate = f"{self._words.number(state.rate, 0)} Hz" if math.isfinite(state.rate) else ""
            for label, text in zip(self._devices[state.name], ("✓" if good else "!", rate, age), strict=True):
                label.set_text(text)

    def _build_valve(self) -> None:
        """Build the card of a valve without a loop of its own, for those who may move it."""
        devices = self._next_drive.driven.devices
        self._valve: ValveCard | None = None
        if self._may_change and devices is not None and devices.bare_valve is not None:
            note = partial(self._audit.write, self._visitor, "PUSH")
            self._valve = ValveCard(self._next_drive, self._link, self._words, self._take_found, note)

    def _build_group(self, title: str, values: tuple[SetUpValue, ...]) -> None:
        with card(self._words(title)), ui.element("div").classes("numbers"):
            for value in values:
                number = ui.number(shown_name(value, self._words), suffix=value.unit.name, on_change=self._check)
                number.props(f"outlined debounce=300 for={number_id(value)}")
                number.set_enabled(self._may_change)
                self._numbers[value] = number

    @property
    def _may_change(self) -> bool:
        return self._visitor.may_maintain

    def _may_save(self) -> bool:
        return self._may_change and self._changed is not None and not self._link.is_engaged

    def _build_saving(self) -> None:
        words = self._words
        with card(words("changes")):
            self._said = ui.label().classes("note lines").props("aria-live=polite")
            self._flaw = ui.label().classes("flaw").props("role=alert")
            with ui.element("div").classes("line-up"):
                self._save = button(words("save_version"), self._keep, "action main")
                self._undo = button(words("undo"), self._reset)
            ui.label(words("saving_help" if self._may_change else "only_maintainer")).classes("note")

    def _build_devices(self) -> None:
        self._devices: dict[str, list[ui.label]] = {}
        with card(self._words("devices")), ui.element("table").classes("figures-table"):
            absent = missing(self._next_drive.driven.devices)
            for name in (each for each in (*DEVICES, "corrections") if each not in absent):
                with ui.element("tr"):
                    with ui.element("td"):
                        ui.label(self._words(name))
                    self._devices[name] = [_cell() for _ in range(3)]

    def _reset(self) -> None:
        """Show what was saved last."""
        self._fills = True  # each number that is filled in would be checked with all others
        for value, number in self._numbers.items():
            number.set_value(value.shown(self._next_drive.configuration))
        self._fills = False
        self._check()
        self._list_versions()

    def _check(self) -> None:
        """Validate what is shown, draw it, and show what is changed."""
        if self._fills:
            return
        before = self._next_drive.configuration
        self._changed, flaw, said = None, "", ""
        try:
            after = self._next_drive.changed(self._changes(before))
            self._drawing.set_content(vehicle_drawing(after.vehicle))
            different = changes(before, after, self._words)
            said = different or self._words("no_changes")
            self._changed = after if different else None
        except DrawbarError as error:
            flaw = flaws(str(error), self._words)
        self._said.set_text(said)
        self._flaw.set_text(flaw)
        self._save.set_enabled(self._may_save())
        self._undo.set_enabled(bool(self._changes(before)))

    def _changes(self, before: Configuration) -> list[str]:
        """Return KEY=VALUE of all numbers that are not shown as they were."""
        changes = []
        for value, number in self._numbers.items():
            shown = math.nan if number.value is None else float(number.value)
            if shown != value.shown(before):
                changes.append(value.change(shown))
        return changes

    def _keep(self) -> None:
        if self._changed is not None and self._may_change:
            self._save_version(self._changed)

    def _take_found(self, changes: list[str]) -> None:
        """Save what a calibration has found of a real machine."""
        if self._next_drive.configuration.devices is None:
            tell(self._words("only_stand_ins"))
            return
        try:
            self._save_version(self._next_drive.changed(changes))
        except DrawbarError as error:
            tell(flaws(str(error), self._words))

    def _save_version(self, changed: Configuration) -> None:
        try:
            file = self._next_drive.save(changed, engaged=lambda: self._link.is_engaged)
        except DrawbarError as error:
            tell(flaws(str(error), self._words))
            return
        self._audit.write(self._visitor, "SET_UP", file=str(file))
        tell(self._words("saved_for_next", file=shlex.quote(str(file))), good=True)
        self._reset()

    def _list_versions(self) -> None:
        words = self._words
        versions = self._next_drive.versions.all()[:_VERSIONS]
        self._versions.clear()
        self._versions.set_visibility(bool(versions))
        with self._versions:
            heading(words("versions"))
            for version in versions:
                with ui.element("div").classes("line-up"):
                    ui.label(f"{version.file.name} · {version.written}").classes("grow")
                    if self._may_change:
                        button(words("go_on_from"), partial(self._go_back, version))

    def _go_back(self, version: Version) -> None:
        try:
            self._next_drive.configuration = read_version(version)
        except DrawbarError as error:
            tell(flaws(str(error), self._words))
        self._reset()


def _cell() -> ui.label:
    with ui.element("td"):
        return ui.label("–")

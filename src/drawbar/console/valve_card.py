"""Valve card: pushes a valve or motor that has no loop of its own, shows it live, and shows what its loop needs."""

import asyncio
import math
import time
from collections.abc import Callable
from contextlib import closing

from nicegui import ui

from drawbar.console.calibration_widgets import StepList, changes_of, list_found
from drawbar.console.language.words import Words
from drawbar.console.link import Link
from drawbar.console.live_plot import Curve, LivePlot
from drawbar.console.next_drive import NextDrive
from drawbar.console.widgets import button, card
from drawbar.driving.preparation.hand_calibration import CalibrationResult
from drawbar.driving.preparation.push_calibration import (
    PATIENCE,
    PUSHES,
    STOPPED,
    PushCalibration,
    bare_valve_settings,
    open_bare_valve,
)
from drawbar.errors import DrawbarError
from drawbar.machine.calibration.valve import RUNS
from drawbar.machine.hardware.bare_valve import BareValve

_PREPARED = 5.0
"""after the first button, within which the second one moves, s"""
STEPS = (
    ("valve_roll", "M6 24 H40 M33 17 l8 7 l-8 7"),
    ("valve_band", "M4 42 V36 H9 V42 H14 V28 H19 V42 H24 V20 H29 V42 H34 V12 H39 V42 H44"),
    ("valve_rate", "M4 24 H9 V8 H17 V24 H22 V40 H30 V24 H35 V8 H43 V24"),
)
"""what is done: catalogue's key and its picture"""
_CURVES = ("plotted_wheels", "valve_drive")
"""names of the plots' curves, in the catalogue"""


class ValveCard:
    """Begins, shows and ends the pushes of the configuration's bare valve, and keeps what they have shown."""

    def __init__(
        self,
        next_drive: NextDrive,
        link: Link,
        words: Words,
        keep: Callable[[list[str]], None],
        note: Callable[[], None],
    ) -> None:
        """Build the card; keep: takes what is found, as KEY=VALUE; note: writes down that something is moved."""
        self._next_drive, self._link, self._words, self._keep_changes, self._note = next_drive, link, words, keep, note
        self._pushing: PushCalibration | None = None
        """what this page has begun, as long as it continues"""
        self._shown, self._prepared, self._changes = 0, -math.inf, list[str]()
        with card(words("valve")):
            ui.label(words("valve_help")).classes("note")
            self._steps = StepList(STEPS, words)
            with ui.element("div").classes("line-up"):
                self._prepare = button(words("valve_prepare"), self._ready)
                self._begin = button(words("valve_begin"), self._push, "action main")
                self._stop = button(words("valve_stop"), self._end, "action halt")
            self._said = ui.label().classes("note").props("role=status")
            self._plots = [LivePlot(words("plot_time"), "push-plot", self._attend) for _ in _CURVES]
            self._found = ui.element("div")
            self._keep = button(words("valve_keep"), self._save, "action main")
        for plot in self._plots:
            plot.set_visibility(False)
        self._show_buttons()

    def refresh(self) -> None:
        """Show what is being pushed."""
        self._show_buttons()
        if self._pushing is None:
            return
        self._count(self._pushing)
        if all(plot.may_draw for plot in self._plots):
            self._draw(self._pushing, anew=False)

    def _show_buttons(self) -> None:
        free = not self._link.is_engaged and self._link.pushing is None
        self._prepare.set_enabled(free)
        self._begin.set_enabled(free and time.monotonic() - self._prepared <= _PREPARED)
        self._stop.set_enabled(self._link.pushing is not None)
        self._keep.set_visibility(bool(self._changes))
        self._keep.set_enabled(free)

    def _ready(self) -> None:
        self._prepared = time.monotonic()
        self._show_buttons()

    async def _push(self) -> None:
        """Push in a thread, which must not hold up the pictures of those who drive."""
        link = self._link
        if link.is_engaged or link.pushing is not None or time.monotonic() - self._prepared > _PREPARED:
            return
        self._prepared = -math.inf
        self._changes = []
        self._found.clear()
        try:
            driven = self._next_drive.driven
            settings = bare_valve_settings(driven)
            valve = open_bare_valve(settings, driven.vehicle.wheelbase, link.motion)
        except DrawbarError as error:
            self._said.set_text(self._words.message(error))
            return
        self._pushing = link.pushing = pushing = PushCalibration(valve, settings, patience=PATIENCE)
        self._note()
        self._said.set_text(self._words("valve_moves"))
        for plot in self._plots:
            plot.set_visibility(True)
        self._draw(pushing, anew=True)
        try:
            found = await asyncio.to_thread(_run, pushing, valve)
        finally:
            pushing.end(STOPPED)  # where the console ends meanwhile; the thread continues until it is off
            link.pushing = self._pushing = None
        self._tell(pushing, found)

    def _tell(self, pushing: PushCalibration, found: list[CalibrationResult]) -> None:
        self._count(pushing)
        self._draw(pushing, anew=False)
        self._said.set_text(self._words.message(pushing.reason) if pushing.reason else self._words("valve_enter"))
        self._changes = changes_of(found)
        list_found(self._found, found, self._words)
        self._show_buttons()

    def _count(self, pushing: PushCalibration) -> None:
        pushes = pushing.rates.done if pushing.rates else 0
        self._steps.count([None, (pushing.bands.done, 2 * RUNS, ""), (pushes, 2 * PUSHES, "")])

    def _draw(self, pushing: PushCalibration, *, anew: bool) -> None:
        """Send the plots what is new, of every other report or so."""
        self._shown = 0 if anew else self._shown
        fresh = pushing.rows[self._shown :]
        self._shown += len(fresh)
        age = max(time.monotonic() - pushing.rows[self._shown - 1][0], 0.0) if self._shown else 0.0
        for index, (plot, key) in enumerate(zip(self._plots, _CURVES, strict=True)):
            rows = [[at, round((math.degrees(angle), 100.0 * drive)[index], 2)] for at, angle, drive in fresh[::2]]
            plot.draw(rows, age, [Curve(self._words(key), 3 * index, thin=False)] if anew else None)

    def _attend(self) -> None:
        if self._pushing is not None:
            self._pushing.attend()

    def _end(self) -> None:
        if self._link.pushing is not None:
            self._link.pushing.end(STOPPED)

    def _save(self) -> None:
        if self._changes:
            self._keep_changes(self._changes)


def _run(pushing: PushCalibration, valve: BareValve) -> list[CalibrationResult]:
    with closing(valve):
        return pushing.run()

"""Calibration card: what to drive by hand, how far that is done, and what it shows (docs/calibration.md)."""

import asyncio
import json
from collections.abc import Callable
from typing import Any

import numpy as np
from nicegui import ui

from drawbar.console.hand_log import driven
from drawbar.console.link import Link
from drawbar.console.words import Words
from drawbar.console.workshop import Workshop
from drawbar.driving.calibrating import Found, calibrate
from drawbar.driving.hand_drive import HandDrive
from drawbar.errors import ConfigurationError, DrawbarError

_PERIOD = 1_000_000_000
"""between two pictures, ns"""
_POINTS = 800
"""of the track that are drawn, at most"""
_SPAN = 20.0
"""least length of the plot's axes, m"""
_LINE = {"width": 3, "color": "#0072b2"}
_PICTURE = """<svg viewBox="0 0 300 96" class="to-drive" aria-hidden="true">
<path d="M10 40 H170 M165 35 l6 5 l-6 5 M170 52 H10 M15 47 l-6 5 l6 5"/>
<circle cx="222" cy="24" r="20"/><circle cx="222" cy="72" r="20"/><circle cx="268" cy="24" r="14"/>
<circle cx="268" cy="72" r="14"/><text x="64" y="30">1, 4: 30 m</text><text x="216" y="29">2</text>
<text x="216" y="77">3</text></svg>"""


class CalibrationCard:
    """Begins and ends a drive by hand, and keeps what it has shown as a new version."""

    def __init__(self, workshop: Workshop, link: Link, words: Words, keep: Callable[[list[str]], None]) -> None:
        """Build the card; keep: takes what is found, as KEY=VALUE."""
        self._workshop, self._link, self._words, self._keep_changes = workshop, link, words, keep
        self._changes: list[str] = []
        self._due, self._works = 0, False
        with ui.element("section").classes("card"):
            with ui.element("h2"):
                ui.label(words("calibrate"))
            ui.html(_PICTURE, sanitize=False)
            ui.label(words("calibrate_help")).classes("note")
            with ui.element("div").classes("line-up"):
                self._begin = self._button("calibrate_begin", self._start)
                self._evaluate = self._button("calibrate_evaluate", self._find)
                self._keep = self._button("calibrate_keep", self._save).classes("main")
            self._said = ui.label().classes("note").props("role=status")
            self._track = ui.echart(_options()).classes("track-plot")
            self._found = ui.element("div")
        self._track.set_visibility(False)
        self._show_buttons()

    def refresh(self) -> None:
        """Show what has been driven."""
        self._show_buttons()
        log, now = self._link.hand_log, self._link.clock()
        if not log.is_on or now < self._due or self._works:
            return
        self._due = now + _PERIOD
        drive = log.drive()
        if drive is None:
            return
        done = driven(drive)
        self._said.set_text(
            self._words("calibrate_driven", straight=f"{done.straight:.0f}", left=done.left, right=done.right)
        )
        self._draw(drive)

    def _button(self, key: str, act: Callable[[], Any]) -> ui.button:
        button = ui.button(self._words(key), on_click=act, color=None)
        return button.props("no-caps unelevated").classes("action")

    def _show_buttons(self) -> None:
        log, free = self._link.hand_log, not self._link.is_engaged and not self._works
        self._begin.set_enabled(free and not log.is_on)
        self._evaluate.set_enabled(free and log.is_on)
        self._keep.set_enabled(free and bool(self._changes))

    def _start(self) -> None:
        if self._link.is_engaged:
            return
        self._link.hand_log.begin()
        self._changes = []
        self._found.clear()
        self._said.set_text(self._words("calibrate_drive"))
        self._show_buttons()

    def _draw(self, drive: HandDrive) -> None:
        self._track.set_visibility(True)
        every = max(1, len(drive.x) // _POINTS)
        known = np.isfinite(drive.x + drive.y)
        points = np.round(np.column_stack([drive.x[known], drive.y[known]])[::every], 2)
        if not len(points):
            return
        line = {"type": "line", "data": points.tolist(), "showSymbol": False, "lineStyle": _LINE}
        middle = 0.5 * (points.max(axis=0) + points.min(axis=0))
        half = 0.5 * max(float(np.ptp(points, axis=0).max()), _SPAN)
        axes = [{"min": round(each - half), "max": round(each + half)} for each in middle.tolist()]
        self._track.run_chart_method(":setOption", "plotLook(0)")
        self._track.run_chart_method("setOption", {"xAxis": axes[0], "yAxis": axes[1], "series": [line]})

    async def _find(self) -> None:
        """Evaluate in a thread, which must not hold up the pictures of those who drive."""
        log = self._link.hand_log
        drive = log.drive()
        log.end()
        self._works = True
        self._said.set_text(self._words("planning"))
        try:
            if drive is None or self._workshop.driven.devices is None:
                raise ConfigurationError(self._words("calibrate_nothing"))
            found = await asyncio.to_thread(lambda: list(calibrate(self._workshop.driven, drive)))
        except DrawbarError as error:
            self._said.set_text(self._words.message(error))
            return
        finally:
            self._works = False
        self._changes = [f"{key}={json.dumps(value)}" for each in found for key, value in each.sets.items()]
        self._said.set_text(self._words("calibrate_found", count=sum(bool(each.sets) for each in found)))
        self._list(found)
        self._show_buttons()

    def _list(self, found: list[Found]) -> None:
        self._found.clear()
        with self._found:
            for each in found:
                ui.label(_line(each, self._words)).classes("good" if each.sets else "flaw")

    def _save(self) -> None:
        if self._changes:
            self._keep_changes(self._changes)


def _line(found: Found, words: Words) -> str:
    value, name = found.value, words.message(found.name)
    if not found.sets:
        return f"✖ {name}: {'; '.join(map(words.message, value.refusals))}"
    numbers = f"{value.value:.4g} ± {value.deviation:.2g}"
    return f"✓ {name}: {words.decimal(numbers)} {words.message(value.unit)}"


def _options() -> dict[str, Any]:
    axis = {"type": "value", "scale": True}
    return {
        "animation": False,
        "grid": {"left": 8, "right": 16, "top": 16, "bottom": 16, "containLabel": True},
        "xAxis": {**axis, "name": "m"},
        "yAxis": {**axis, "name": "m"},
        "series": [],
    }

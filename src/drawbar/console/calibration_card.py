"""Calibration card: what to drive by hand, how far that is done, and what it shows (docs/calibration.md)."""

import asyncio
import math
from collections.abc import Callable

import numpy as np
from nicegui import ui

from drawbar.config import Configuration
from drawbar.console.calibration_widgets import CURVE, StepList, changes_of, list_found, plot_options
from drawbar.console.hand_log import Driven
from drawbar.console.language.words import Words
from drawbar.console.link import Link
from drawbar.console.live_plot import Curve, LivePlot
from drawbar.console.next_drive import NextDrive
from drawbar.console.widgets import button, card
from drawbar.driving.preparation.dead_bands import dead_bands
from drawbar.driving.preparation.hand_calibration import CalibrationResult, calibrate
from drawbar.driving.preparation.hand_drive import HandDrive
from drawbar.driving.preparation.steering_memory import steering_memory
from drawbar.errors import ConfigurationError, DrawbarError
from drawbar.machine.calibration.mounting import BACK
from drawbar.messages import GateState
from drawbar.signals import Measurement, StepRecord

_PERIOD = 1_000_000_000
"""between two pictures, ns"""
_POINTS = 800
"""of the track that are drawn, at most"""
_SPAN = 20.0
"""least length of the plot's axes, m"""
_WHEEL = "M24 6 a18 18 0 1 0 0.1 0 M6 24 H42 M24 24 V42"
_AHEAD = "M6 24 H40 M33 17 l8 7 l-8 7"
STEPS: tuple[tuple[str, str, Callable[[Driven], tuple[float, float, str]]], ...] = (
    ("calibrate_straight", _AHEAD, lambda done: (done.straight, 30.0, "m")),
    ("calibrate_left", "M30 42 A17 17 0 1 0 13 25 M7 33 l6 -9 l8 7", lambda done: (done.left, 3.0, "")),
    ("calibrate_right", "M18 42 A17 17 0 1 1 35 25 M41 33 l-6 -9 l-8 7", lambda done: (done.right, 3.0, "")),
    (
        "calibrate_back",
        "M6 17 H40 M33 10 l8 7 l-8 7 M42 33 H8 M15 26 l-8 7 l8 7",
        lambda done: (done.back, BACK, "s"),
    ),
    (
        "calibrate_curves",
        "M4 24 C10 4 16 4 22 24 S36 44 42 24 M35 27 l7 -4 l4 7",
        lambda done: (done.curves, 90.0, "s"),
    ),
    ("calibrate_steered", _WHEEL, lambda done: (done.steered, 120.0, "s")),
)
"""what to drive: catalogue's key, its picture, and how much of it counts so far, of how much, in which unit"""
_ANGLES = {
    "plotted_wheels": "tractor_steering",
    "plotted_joint": "trailer_steering",
    "plotted_hitch": "hitch_angle",
}
"""that are plotted: name in the catalogue, and of the measurement"""


class CalibrationCard:
    """Begins and ends a drive by hand, and keeps what it has shown as a new version."""

    def __init__(self, next_drive: NextDrive, link: Link, words: Words, keep: Callable[[list[str]], None]) -> None:
        """Build the card; keep: takes what is found, as KEY=VALUE."""
        self._next_drive, self._link, self._words, self._keep_changes = next_drive, link, words, keep
        self._changes: list[str] = []
        self._due, self._works, self._version = 0, False, 0
        with card(words("calibrate")):
            ui.label(words("calibrate_help")).classes("note")
            self._steps = StepList([(key, picture) for key, picture, _ in STEPS], words)
            with ui.element("div").classes("line-up"):
                self._begin = button(words("calibrate_begin"), self._start)
                self._evaluate = button(words("calibrate_evaluate"), self._find)
                self._keep = button(words("calibrate_keep"), self._save, "action main")
            self._said = ui.label().classes("note").props("role=status")
            self._track = ui.echart(plot_options("m", "m")).classes("track-plot")
            self._angles = LivePlot(words("plot_time"), "angle-plot")
            self._found = ui.element("div")
        self._track.set_visibility(False)
        self._angles.set_visibility(False)
        self._show_buttons()

    def refresh(self) -> None:
        """Show what has been driven."""
        self._show_buttons()
        log, now = self._link.hand_log, self._link.clock()
        if log.is_on and self._link.steps and self._angles.may_draw:
            self._draw_angles()
        if not log.is_on or now < self._due or self._works:
            return
        self._due = now + _PERIOD
        self._count(log.driven())
        if (drive := log.drive()) is not None:
            self._draw(drive)

    def _count(self, done: Driven | None) -> None:
        """Show how much of each step has been driven; None: nothing."""
        self._steps.count([measure(done) if done else None for _, _, measure in STEPS])

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
        self._count(None)
        self._said.set_text(self._words("calibrate_drive"))
        self._show_buttons()

    def _draw(self, drive: HandDrive) -> None:
        self._track.set_visibility(True)
        every = max(1, len(drive.x) // _POINTS)
        known = np.isfinite(drive.x + drive.y)
        points = np.round(np.column_stack([drive.x[known], drive.y[known]])[::every], 2)
        if not len(points):
            return
        middle = 0.5 * (points.max(axis=0) + points.min(axis=0))
        half = 0.5 * max(float(np.ptp(points, axis=0).max()), _SPAN)
        axes = [{"min": round(each - half), "max": round(each + half)} for each in middle.tolist()]
        self._track.run_chart_method(":setOption", "plotLook(1)")
        self._track.run_chart_method(
            "setOption", {"xAxis": axes[0], "yAxis": axes[1], "series": [CURVE | {"data": points.tolist()}]}
        )

    def _draw_angles(self) -> None:
        """Send the measured angles that are new, degrees."""
        steps, fresh = list(self._link.steps), self._link.version - self._version
        anew = self._version == 0
        self._version = self._link.version
        curves = [Curve(self._words(key), index, thin=False) for index, key in enumerate(_ANGLES)]
        if anew:
            self._angles.set_visibility(True)
        rows = [_angles(step.record.measurement) for step in (steps if anew else steps[len(steps) - fresh :])]
        self._angles.draw(rows, self._link.step_age, curves if anew else None)

    async def _find(self) -> None:
        """Evaluate in a thread, which must not hold up the pictures of those who drive."""
        log = self._link.hand_log
        drive = log.drive()
        log.end()
        self._works = True
        self._said.set_text(self._words("planning"))
        try:
            if self._next_drive.driven.devices is None or (drive is None and not log.steered):
                raise ConfigurationError(self._words("calibrate_nothing"))
            found = await asyncio.to_thread(_evaluated, self._next_drive.driven, drive, log.steered, log.records)
        except DrawbarError as error:
            self._said.set_text(self._words.message(error))
            return
        finally:
            self._works = False
        self._changes = changes_of(found)
        self._said.set_text(self._words("calibrate_found", count=sum(each.value.accepted for each in found)))
        list_found(self._found, found, self._words)
        self._show_buttons()

    def _save(self) -> None:
        if self._changes:
            self._keep_changes(self._changes)


def _evaluated(
    driven: Configuration, drive: HandDrive | None, steered: list[GateState], records: list[StepRecord]
) -> list[CalibrationResult]:
    """Return what a drive by hand shows, and what was steered shows of the steerings, as `drawbar calibrate` does."""
    by_hand = calibrate(driven, drive) if drive is not None else ()
    return [*by_hand, *dead_bands(steered), *(steering_memory(driven, records) if steered else ())]


def _angles(measurement: Measurement) -> list[float | None]:
    """Return time (s) and angles (degrees) as a plot takes them; None: it is missing."""
    angles = [math.degrees(getattr(measurement, name)) for name in _ANGLES.values()]
    return [round(measurement.time, 3), *(round(each, 2) if math.isfinite(each) else None for each in angles)]

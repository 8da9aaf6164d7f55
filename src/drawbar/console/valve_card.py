"""Valve card: how to push a valve or motor that has no loop of its own, what it did, and what its loop must know."""

import asyncio
import math

import numpy as np
from nicegui import events, ui

from drawbar.console.calibration_parts import CURVE, StepList, list_found, plot_options
from drawbar.console.guard import LARGEST_UPLOAD
from drawbar.console.page_head import tell
from drawbar.console.push_record import SIDES, PushFile
from drawbar.console.words import Words
from drawbar.driving.calibrating import Found
from drawbar.errors import DrawbarError
from drawbar.machine.hardware.valve_calibration import RUNS

_POINTS = 3000
"""of a plot, at most"""
STEPS = (
    ("valve_band", "M4 42 V36 H9 V42 H14 V28 H19 V42 H24 V20 H29 V42 H34 V12 H39 V42 H44"),
    ("valve_rate", "M4 24 H9 V8 H17 V24 H22 V40 H30 V24 H35 V8 H43 V24"),
    ("valve_write", "M8 6 H40 V42 H8 Z M8 15 H40 M8 24 H40 M8 33 H40 M19 6 V42 M30 6 V42"),
)
"""what to do: catalogue's key and its picture"""
_CURVES = ("valve_angle", "valve_drive")
"""names of the plots' axes, in the catalogue"""


class ValveCard:
    """Takes the record of pushes, draws it, and says what it shows; it moves nothing and changes nothing."""

    def __init__(self, words: Words) -> None:
        """Build the card."""
        self._words = words
        with ui.element("section").classes("card"):
            with ui.element("h2"):
                ui.label(words("valve"))
            ui.label(words("valve_help")).classes("note")
            self._steps = StepList(STEPS, words)
            ui.upload(
                label=words("valve_file"),
                on_upload=self._take,
                on_rejected=lambda: tell(words("too_large", size=LARGEST_UPLOAD >> 20)),
                auto_upload=True,
                max_file_size=LARGEST_UPLOAD,
            ).props("accept=.csv")
            self._plots = [ui.echart(plot_options("s", words(key))).classes("push-plot") for key in _CURVES]
            self._found = ui.element("div")
            self._said = ui.label().classes("note").props("role=status")
        for plot in self._plots:
            plot.set_visibility(False)

    async def _take(self, event: events.UploadEventArguments) -> None:
        """Evaluate a record in a thread, which must not hold up the pictures of those who drive."""
        data = await event.file.read()
        try:
            record, found = await asyncio.to_thread(_evaluated, data, event.file.name)
        except DrawbarError as error:
            tell(self._words.message(error))
            return
        done = [min(len(each[side]) for side in SIDES) for each in (record.runs, record.pushes)]
        self._steps.count([*((count, RUNS, "") for count in done), None])
        self._draw(record)
        list_found(self._found, found, self._words)
        self._said.set_text(self._words("valve_enter"))

    def _draw(self, record: PushFile) -> None:
        every = math.ceil(len(record.times) / _POINTS)
        times = record.times - record.times[0]
        for plot, values in zip(self._plots, (np.degrees(record.angles), 100.0 * record.drives), strict=True):
            if not plot.visible:
                plot.set_visibility(True)
                ui.run_javascript(f"keepLook({plot.id})")
            points = np.round(np.column_stack([times, values])[::every], 2).tolist()
            plot.run_chart_method(":setOption", "plotLook(1)")
            plot.run_chart_method("setOption", {"series": [CURVE | {"data": points}]})


def _evaluated(data: bytes, name: str) -> tuple[PushFile, list[Found]]:
    record = PushFile.of(data, name)
    return record, list(record.found())

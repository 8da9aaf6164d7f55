"""Calibration widgets: steps with pictures and how far each is done, plots, and what was found."""

import json
from collections.abc import Iterable, Sequence
from typing import Any

from nicegui import ui

from drawbar.console.language.words import Words
from drawbar.driving.preparation.hand_calibration import CalibrationResult

_PICTURE = '<svg viewBox="0 0 48 48" class="to-drive" aria-hidden="true"><path d="{}"/></svg>'

CURVE = {"type": "line", "showSymbol": False, "lineStyle": {"width": 3}}
"""the curve of a plot, without its data"""


class StepList:
    """What to do, step by step, each with a picture and how much of it counts so far."""

    def __init__(self, steps: Sequence[tuple[str, str]], words: Words) -> None:
        """Build the list; steps: catalogue's key and the path of the picture (SVG, 48 by 48)."""
        self._counts: list[ui.label] = []
        with ui.element("ol").classes("to-do"):
            for key, picture in steps:
                with ui.element("li"):
                    ui.html(_PICTURE.format(picture), sanitize=False)
                    ui.label(words(key)).classes("grow")
                    self._counts.append(ui.label().classes("count"))

    def count(self, done: Sequence[tuple[float, float, str] | None]) -> None:
        """Show of each step how much counts, of how much, in which unit; None: nothing to count."""
        for label, each in zip(self._counts, done, strict=True):
            if each is None:
                label.set_text("")
                continue
            much, enough, unit = each
            text = f"{min(much, 9999.0):.0f} / {enough:.0f} {unit}".strip()
            label.set_text(f"✓ {text}" if much >= enough else text)


def changes_of(found: Iterable[CalibrationResult]) -> list[str]:
    """Return what was found as KEY=VALUE."""
    return [f"{key}={json.dumps(value)}" for each in found for key, value in each.sets.items()]


def list_found(place: ui.element, found: Iterable[CalibrationResult], words: Words) -> None:
    """Show in a place what was found, and why not the rest."""
    place.clear()
    with place:
        for each in found:
            ui.label(_line(each, words)).classes("good" if each.value.accepted else "flaw")


def plot_options(x: str, y: str) -> dict[str, Any]:
    """Return the options of a plot of one curve, which comes later; x, y: names of its axes."""
    axis = {"type": "value", "scale": True}
    return {
        "animation": False,
        "grid": {"left": 8, "right": 28, "top": 16, "bottom": 16, "containLabel": True},
        "xAxis": {**axis, "name": x},
        "yAxis": {**axis, "name": y, "nameTextStyle": {"align": "left"}},
        "series": [],
    }


def _line(found: CalibrationResult, words: Words) -> str:
    value, name = found.value, words.message(found.name)
    if not value.accepted:
        return f"✖ {name}: {'; '.join(map(words.message, value.refusals))}"
    return f"✓ {name}: {words.decimal(value.text)} {words.message(value.unit)}"

"""Field map: draws a field, its lines, the chosen one and what was smoothed of it; a line is chosen by touching it."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from nicegui.element import Element
from nicegui.events import GenericEventArguments


class FieldMap(Element, component=Path(__file__).parent / "static" / "field_map.js"):
    """The browser's drawing of a field; points are east and north, m."""

    def __init__(self, texts: dict[str, str], on_choose: Callable[[str], None]) -> None:
        """Take the texts, and what hears the name of a line that was touched."""
        super().__init__()
        self._props["texts"] = texts
        self.show({"boundary": [], "lines": [], "chosen": [], "driven": [], "aside": []})
        self._on_choose = on_choose
        self.on("choose", self._choose)

    def show(self, scene: dict[str, Any]) -> None:
        """Draw a field: boundary, lines, the chosen pass, what will be driven, and where that is aside."""
        self._props["drawn"] = json.dumps(scene)  # a list would be watched by NiceGUI, point by point
        self.update()

    def place(self, place: list[float | None] | None, track: list[list[float]]) -> None:
        """Draw where the tractor is (east, north, yaw), and the curve that is being recorded."""
        self.run_method("move", place, track)

    def _choose(self, event: GenericEventArguments) -> None:
        if isinstance(event.args, str):
            self._on_choose(event.args)

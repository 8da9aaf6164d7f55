"""Field map: draws a field, its lines, the chosen one and what was smoothed of it; a line is chosen by touching it."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from nicegui.element import Element
from nicegui.events import GenericEventArguments

from drawbar.console.flow_control import FlowControl


class FieldMap(Element, component=Path(__file__).parent / "static" / "field_map.js"):
    """The browser's drawing of a field; points are east and north, m."""

    def __init__(self, texts: dict[str, str], on_choose: Callable[[str], None]) -> None:
        """Take the texts, and the listener for the name of a line that was touched."""
        super().__init__()
        self._props["texts"] = texts
        self.show_field({"boundary": [], "lines": []})
        self._on_choose, self._flow = on_choose, FlowControl()
        self.on("choose", self._choose)
        self.on("moved", self._flow.drawn, args=[])

    def show_field(self, field: dict[str, Any]) -> None:
        """Draw a field, its boundary and its lines, and nothing planned on it."""
        self._props["field"] = json.dumps(field)  # a list would be watched by NiceGUI, point by point
        self.update()

    def show_plan(self, plan: dict[str, Any]) -> None:
        """Draw the chosen pass, what will be driven, and where these deviate."""
        self.run_method("showPlan", plan)

    @property
    def may_draw(self) -> bool:
        """Whether another place may be sent."""
        return self._flow.may_send

    def place(self, place: list[float | None] | None, track: list[list[float]] | None) -> None:
        """Draw where the tractor is (east, north, yaw), and the curve that is being recorded; None: as before."""
        self._flow.send()
        self.run_method("move", place, track)

    def _choose(self, event: GenericEventArguments) -> None:
        if isinstance(event.args, str):
            self._on_choose(event.args)

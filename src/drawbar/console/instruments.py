"""Instruments: figures, light bars and map, drawn by the browser from one picture at a time.

The browser acknowledges each picture (event `drawn`).
"""

import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from nicegui import ui
from nicegui.element import Element
from nicegui.events import GenericEventArguments

from drawbar.console.flow_control import FlowControl


class Instruments(Element, component=Path(__file__).parent / "static" / "instruments.js"):
    """The browser's drawing of a drive."""

    def __init__(
        self,
        standing: dict[str, Any],
        texts: dict[str, str],
        on_drawn: Callable[[object], None],
        may_leave: Callable[[], bool],
    ) -> None:
        """Take what does not move, and the texts.

        Args:
            standing: what does not move (drawing.py).
            texts: by their keys in the catalogue.
            on_drawn: called with the state of the gate that the browser has drawn.
            may_leave: called where Back is pressed; returns whether the page may be left.
        """
        super().__init__()
        self._props["standing"] = json.dumps(standing)  # a list would be watched by NiceGUI, point by point
        self._props["texts"] = texts
        self._on_drawn, self._may_leave = on_drawn, may_leave
        self._flow = FlowControl()
        self.on("drawn", self._drawn)
        self.on("back", self._go_back, args=[])

    @property
    def may_draw(self) -> bool:
        """Whether another picture may be sent."""
        return self._flow.may_send

    def show_lines(self, lines: dict[str, Any]) -> None:
        """Draw other lines from now on."""
        self.run_method("showLines", lines)

    def draw(self, picture: dict[str, Any]) -> None:
        """Send a picture."""
        self._flow.send()
        self.run_method("draw", picture | {"sent": time.monotonic_ns() // 1_000_000})

    def _drawn(self, event: GenericEventArguments) -> None:
        self._flow.drawn()
        self._on_drawn(event.args)

    def _go_back(self) -> None:
        if self._may_leave():
            ui.run_javascript("history.back()")
        else:
            self.run_method("hold")

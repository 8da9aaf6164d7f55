"""Live plot: curves over the last minute that slide with time, ten times a second.

The browser keeps the steps, and is sent only those that are new (plots.js). It acknowledges each picture.
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from nicegui import ui

from drawbar.console.flow_control import FlowControl

SPAN = 60
"""s"""
_SHAPES = ("solid", "dashed", "dotted")


@dataclass(frozen=True, slots=True)
class Curve:
    """How one column is drawn."""

    name: str
    """as people read it; curves of one name are shown and hidden together"""
    index: int
    """of its signal; it chooses colour (plots.js) and dashes"""
    thin: bool


class LivePlot:
    """The plot of one page."""

    def __init__(self, time: str, look: str = "plot", drawn: Callable[[], None] = lambda: None) -> None:
        """Build it, without curves.

        Args:
            time: what its horizontal axis is called.
            look: its class in console.css.
            drawn: called when a browser has drawn a picture.
        """
        self._flow, self._tell = FlowControl(), drawn
        self._chart = ui.echart(_options(time)).classes(look)
        self._chart.on("plotted", self._drawn, args=[])
        self.set_visibility = self._chart.set_visibility

    def _drawn(self) -> None:
        self._flow.drawn()
        self._tell()

    @property
    def may_draw(self) -> bool:
        """Whether another picture may be sent."""
        return self._flow.may_send

    def draw(self, rows: Sequence[Sequence[float | None]], age: float, curves: Sequence[Curve] | None = None) -> None:
        """Send what is new.

        Args:
            rows: of new steps, the time (s) and a value for each curve; None: it is missing.
            age: of the newest step that was ever sent, s.
            curves: to draw from now on, with these rows alone; None: the same as before.
        """
        picture: dict[str, Any] = {"rows": rows, "age": round(age, 3)}
        if curves is not None:
            picture |= {"lines": [_line(number, curve) for number, curve in enumerate(curves)]}
        self._flow.send()
        ui.run_javascript(f"plotSteps({self._chart.id}, {json.dumps(picture)})")


def _line(number: int, curve: Curve) -> dict[str, Any]:
    return {
        "type": "line",
        "id": number,
        "name": curve.name,
        "showSymbol": False,
        "animation": False,
        "colour": curve.index,
        "lineStyle": {"width": 1 if curve.thin else 2.5, "type": _SHAPES[curve.index % len(_SHAPES)]},
    }


def _options(time: str) -> dict[str, Any]:
    axis = {"axisLabel": {"fontSize": 14}}
    return {
        "animation": False,
        "legend": {"top": 0, "textStyle": {"fontSize": 14}, "type": "plain"},
        "tooltip": {"trigger": "axis"},
        "grid": {"left": 8, "right": 16, "top": 64, "bottom": 34, "containLabel": True},
        "xAxis": {
            "type": "value",
            "name": time,
            "nameLocation": "middle",
            "nameGap": 26,
            "min": -SPAN,
            "max": 0,
            **axis,
        },
        "yAxis": {"type": "value", "scale": True, **axis},
        "series": [],
    }

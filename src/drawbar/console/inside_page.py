"""Look inside: live plots of any signal of the control steps."""

import json
from typing import Any

from nicegui import ui

from drawbar.console.link import Link
from drawbar.console.page_head import PageHead
from drawbar.console.signal_history import PRESETS, all_names, band, series
from drawbar.console.visitors import Visitor
from drawbar.console.words import Words

_PERIOD = 100_000_000
"""between two pictures, ns"""
_STEPS = 300
"""that are drawn; a minute at 5 Hz"""
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b8860b", "#8c6bb1")
_SHAPES = ("solid", "dashed", "dotted")


class InsidePage:
    """The page of one browser."""

    def __init__(self, link: Link, visitor: Visitor, words: Words, *, login: bool) -> None:
        """Build the page."""
        self._link, self._words = link, words
        self._due, self._version, self._stands = 0, -1, False
        ui.add_head_html('<script src="/drawbar/plot_look.js"></script>')
        self._head = PageHead(link, visitor, words, words("inside"), login=login)
        with ui.element("div").classes("page wide"), ui.element("section").classes("card"):
            with ui.element("div").classes("line-up"):
                presets = {key: words(key) for key in PRESETS}
                self._preset = ui.select(presets, value="plot_errors", label=words("plot"), on_change=self._choose)
                self._preset.props("outlined")
                self._names = ui.select([], label=words("signals"), multiple=True, on_change=self._restart)
                self._names.props("outlined use-chips use-input input-debounce=0").classes("whole")
                self._pause = ui.button(words("pause"), on_click=self._toggle, color=None)
                self._pause.props("no-caps unelevated").classes("action")
            self._chart = ui.echart(_options()).classes("plot")
            self._said = ui.label(words("no_steps")).classes("note")
        self._choose()

    def refresh(self) -> None:
        """Draw what is new."""
        self._head.refresh()
        now = self._link.clock()
        if self._stands or now < self._due or self._version == self._link.version:
            return
        if self._version < 0:
            self._offer()
        self._due, self._version = now + _PERIOD, self._link.version
        self._draw()

    def _draw(self) -> None:
        steps = list(self._link.steps)[-_STEPS:]
        self._said.set_visibility(not steps)
        drawn = [
            _line(index, name, points, thin=thin)
            for index, name in enumerate(self._names.value)
            for thin, points in ((False, series(steps, name)), *((True, each) for each in band(steps, name)))
        ]
        options = f"{{...plotLook({len(self._names.value)}), series: {json.dumps(drawn)}}}"
        self._chart.run_chart_method(":setOption", options, "{replaceMerge: ['series']}")

    def _offer(self) -> None:
        """Offer all signals that there are now."""
        chosen = self._names.value
        self._names.set_options(sorted({*all_names(list(self._link.steps)), *chosen}), value=chosen)

    def _choose(self) -> None:
        names = list(PRESETS[self._preset.value])
        self._names.set_options(sorted({*self._names.options, *names}), value=names)
        self._restart()

    def _restart(self) -> None:
        self._draw()

    def _toggle(self) -> None:
        self._stands = not self._stands
        self._pause.set_text(self._words("go_on" if self._stands else "pause"))


def _line(index: int, name: str, points: list[Any], *, thin: bool) -> dict[str, Any]:
    colour, shape = _COLOURS[index % len(_COLOURS)], _SHAPES[index % len(_SHAPES)]
    return {
        "type": "line",
        "name": name,
        "data": points,
        "showSymbol": False,
        "animation": False,
        "lineStyle": {"width": 1 if thin else 2.5, "color": colour, "type": shape},
        "itemStyle": {"color": colour},
    }


def _options() -> dict[str, Any]:
    axis = {"axisLabel": {"fontSize": 14}}
    return {
        "animation": False,
        "legend": {"top": 0, "textStyle": {"fontSize": 14}, "type": "plain"},
        "tooltip": {"trigger": "axis"},
        "grid": {"left": 8, "right": 16, "top": 64, "bottom": 34, "containLabel": True},
        "xAxis": {
            "type": "value",
            "name": "s",
            "nameLocation": "middle",
            "nameGap": 26,
            "min": "dataMin",
            "max": 0,
            "axisLabel": {**axis["axisLabel"], "showMinLabel": False},
        },
        "yAxis": {"type": "value", "scale": True, **axis},
        "series": [],
    }

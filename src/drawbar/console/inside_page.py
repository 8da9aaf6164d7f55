"""Inside page: live plots of any signal of the control steps."""

from nicegui import ui

from drawbar.console.language.words import Words
from drawbar.console.link import Link
from drawbar.console.live_plot import Curve, LivePlot
from drawbar.console.page_head import PageHead
from drawbar.console.signal_history import PRESETS, Column, all_names, columns, row
from drawbar.console.visitors import Visitor
from drawbar.console.widgets import button

_OPTION = """
<q-item v-bind="props.itemProps"><q-item-section>
  <q-item-label>{{ props.opt.label.split("\\n")[0] }}</q-item-label>
  <q-item-label caption class="raw">{{ props.opt.label.split("\\n")[1] }}</q-item-label>
</q-item-section></q-item>
"""
"""a signal in the list: its words, and under them its name in logs"""
_CHOSEN = """
<q-chip removable :tabindex="props.tabindex" @remove="props.removeAtIndex(props.index)">
  {{ props.opt.label.split("\\n")[0] }}
</q-chip>
"""


class InsidePage:
    """The page of one browser."""

    def __init__(self, link: Link, visitor: Visitor, words: Words, *, login: bool) -> None:
        """Build the page."""
        self._link, self._words = link, words
        self._columns: list[Column] | None = None
        """that the browser draws now; None: it is to restart"""
        self._version, self._stands = 0, False
        ui.add_head_html('<script src="/drawbar/plots.js"></script>')
        self._head = PageHead(link, visitor, words, words("inside"), login=login)
        with ui.element("div").classes("page wide"), ui.element("section").classes("card"):
            with ui.element("div").classes("line-up"):
                presets = {key: words(key) for key in PRESETS}
                self._preset = ui.select(presets, value="plot_errors", label=words("plot"), on_change=self._choose)
                self._preset.props("outlined")
                self._names = ui.select({}, label=words("signals"), multiple=True, on_change=self._restart)
                self._names.props("outlined use-chips use-input input-debounce=0").classes("whole")
                self._names.add_slot("option", _OPTION)
                self._names.add_slot("selected-item", _CHOSEN)
                self._pause = button(words("pause"), self._toggle)
            self._plot = LivePlot(words("plot_time"))
            self._said = ui.label(words("no_steps")).classes("note")
        self._choose()

    def refresh(self) -> None:
        """Draw what is new, and slide what is there."""
        self._head.refresh()
        if self._stands or not self._link.steps or not self._plot.may_draw:
            return
        if self._said.visible:
            self._said.set_visibility(False)
            self._offer(self._names.value)
        self._draw()

    def _draw(self) -> None:
        steps = list(self._link.steps)
        wanted = columns(steps, self._names.value)
        curves = None
        if wanted != self._columns:
            self._columns = wanted
            names = self._names.value
            curves = [
                Curve(self._words.signal(each.name), names.index(each.name), thin=bool(each.deviations))
                for each in wanted
            ]
        else:
            fresh = self._link.version - self._version
            steps = steps[-fresh:] if fresh else []
        self._version = self._link.version
        self._plot.draw([row(step, wanted) for step in steps], self._link.step_age, curves)

    def _offer(self, chosen: list[str]) -> None:
        """Offer all signals that there are now, and those that are chosen."""
        names = {*all_names(list(self._link.steps)), *chosen}
        texts = {name: f"{self._words.signal(name)}\n{name}" for name in names}
        self._names.set_options(dict(sorted(texts.items(), key=lambda each: each[1].lower())), value=chosen)

    def _choose(self) -> None:
        self._offer(list(PRESETS[self._preset.value]))
        self._restart()

    def _restart(self) -> None:
        """Draw what is chosen now, also where the plot stands."""
        self._columns = None
        if self._link.steps:
            self._draw()

    def _toggle(self) -> None:
        self._stands = not self._stands
        self._pause.set_text(self._words("go_on" if self._stands else "pause"))

"""Adjusting: the part of the drive page that moves the line, changes the set speed and chooses the next line."""

from collections.abc import Callable

from nicegui import ui

from drawbar.console.language.words import Words
from drawbar.console.link import Link
from drawbar.console.view import Dashboard, drives_chosen_line, set_speed_text, shift_text
from drawbar.console.widgets import button
from drawbar.driving.operator.requests import changed_speed
from drawbar.messages import Action

NUDGE = 0.02
"""m"""
SPEED_STEP = 0.1 / 3.6 * 2
"""0.2 km/h, in m/s"""

_PATIENCE = 1_000_000_000
"""until a line that was chosen must be driven, ns"""

Ask = Callable[[Action, float], None]


class Adjusting:
    """Two rows of buttons, each with what it changes between them; a small screen folds them while nothing steers."""

    def __init__(
        self,
        link: Link,
        words: Words,
        ask: Ask,
        *,
        speed: float,
        working_width: float,
        nearest_pass: Callable[[], int | None],
    ) -> None:
        """Build the rows.

        Args:
            link: to the drive.
            words: texts.
            ask: hands what is asked for, and its value, to the gate.
            speed: at which is driven where the operator wishes none, m/s.
            working_width: between parallel lines, m; 0: there is only one.
            nearest_pass: returns the pass that is nearest to the tractor; None: it is not known.
        """
        self._nearest_pass = nearest_pass
        self._link, self._words, self._ask = link, words, ask
        self._otherwise, self._width = speed, working_width
        self._followed = link.clock()  # when the chosen line was driven last
        self._is_open = False
        self._fold = button(words("unfold"), self._toggle, "fold plain").props("aria-expanded=false")
        with ui.element("div").classes("adjust needs-sight") as self._fine:
            self._button("◀", "nudge_left", lambda: self._nudge(NUDGE))
            self._shift = self._reading("line_shift")
            self._button("▶", "nudge_right", lambda: self._nudge(-NUDGE))
            self._button("−", "slower", lambda: self._change_speed(-SPEED_STEP))
            self._speed = self._reading("set_speed")
            self._button("+", "faster", lambda: self._change_speed(SPEED_STEP))
        with ui.element("div").classes("passes needs-sight") as self._passes:
            self._button("◀◀", "pass_left", lambda: self._change_pass(1))
            self._pass = self._reading("pass_number")
            self._button("▶▶", "pass_right", lambda: self._change_pass(-1))
            self._button(words("pass_nearest"), "pass_nearest_help", self._take_nearest).classes("nearest")

    def show(self, shown: Dashboard) -> None:
        """Show what may be changed now."""
        self._fine.set_visibility(shown.may_adjust)
        self._passes.set_visibility(shown.may_choose_line and self._width > 0.0)
        self._fold.set_visibility(shown.may_choose_line and (self._fine.visible or self._passes.visible))
        self._show_fold()

    def refresh(self) -> None:
        """Show how everything is now."""
        gate, controller, now = self._link.gate, self._link.controller, self._link.clock()
        self._speed.set_text(set_speed_text(gate, self._words, self._otherwise))
        self._shift.set_text(shift_text(gate, left=self._left))
        if gate is None or controller is None:
            return
        if drives_chosen_line(gate, controller, self._width):
            self._followed = now
        failed = self._words("not_drivable") if now - self._followed > _PATIENCE else ""
        self._pass.set_text(f"{gate.line} {failed}".strip())

    def _toggle(self) -> None:
        self._is_open = not self._is_open
        self._show_fold()

    @property
    def folded(self) -> bool:
        """Whether small screens hide the rows (console.css)."""
        return bool(self._fold.visible) and not self._is_open

    def _show_fold(self) -> None:
        """Let small screens fold the rows while there is a button to unfold them."""
        folded = self.folded
        for row in (self._fine, self._passes):
            row.classes(add="folded" if folded else "", remove="" if folded else "folded")
        self._fold.set_text(self._words("unfold" if folded else "fold"))
        self._fold.props(f"aria-expanded={str(not folded).lower()}")

    @property
    def _left(self) -> int:
        """Which way the driver's left is, seen in the configured line's direction: 1 left, -1 right."""
        controller = self._link.controller
        return -1 if controller is not None and controller.against else 1

    def _nudge(self, distance: float) -> None:
        self._ask(Action.NUDGE, self._left * distance)

    def _change_pass(self, count: int) -> None:
        if self._link.gate is not None:
            self._ask(Action.LINE, float(self._link.gate.line + self._left * count))

    def _take_nearest(self) -> None:
        nearest = self._nearest_pass()
        if nearest is not None:
            self._ask(Action.LINE, float(nearest))

    def _change_speed(self, change: float) -> None:
        if self._link.gate is not None:
            self._ask(Action.SET_SPEED, changed_speed(self._link.gate, change, self._otherwise))

    def _reading(self, key: str) -> ui.label:
        with ui.element("div").classes("reading"):
            with ui.element("small"):
                ui.label(self._words(key))
            return ui.label("–").classes("value")

    def _button(self, sign: str, key: str, act: Callable[[], None]) -> ui.button:
        return button(sign, act, "first").mark(key).props(f'aria-label="{self._words(key)}"')

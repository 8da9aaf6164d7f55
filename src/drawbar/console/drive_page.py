"""Drive page: what one needs to drive, on one screen. Built of the dashboard, the instruments and the controls."""

from collections.abc import Callable, Hashable
from typing import Any

from nicegui import ui

from drawbar.console.adjusting import Adjusting
from drawbar.console.debouncer import Debouncer
from drawbar.console.drawing import Lines, Moving, moving_by_hand
from drawbar.console.instruments import Instruments
from drawbar.console.language.words import Words
from drawbar.console.link import Link
from drawbar.console.menu import menu
from drawbar.console.view import Dashboard, dashboard, display_name, picture
from drawbar.console.visitors import Visitor
from drawbar.console.widgets import button, heading
from drawbar.messages import Action
from drawbar.safety.causes import Cause
from drawbar.safety.operator_requests import ALWAYS

_TEXTS = ("old", "map", "zoom_in", "zoom_out", "whole")


class DrivePage:
    """The page of one browser."""

    def __init__(
        self, link: Link, visitor: Visitor, words: Words, standing: dict[str, Any], lines: Lines, *, login: bool
    ) -> None:
        """Build the page; standing, lines: what does not move by itself (drawing.py); login: visitors may log out."""
        self._link, self._visitor, self._words, self._lines = link, visitor, words, lines
        self._speed, self._working_width = float(standing["speed"]), float(standing["workingWidth"])
        self._offset, self._lost = 0.0, False
        self._shown: Dashboard | None = None
        self._debouncer = Debouncer()
        self._refusal_count = link.session(visitor).refusal_count
        with ui.element("div").classes("cockpit"):
            self._build_bar(login=login)
            if link.controller is not None:
                self._offset = link.controller.line_offset
            scene = standing | {"trail": list(link.trail), "lines": lines(self._offset)}
            texts = {key: words(key) for key in _TEXTS}
            self._instruments = Instruments(scene, texts, lambda seen: link.drawn(visitor, seen), self._may_leave)
            with ui.element("div").classes("side"):
                self._why = ui.element("section").classes(
                    "why"
                )  # a small screen shows all of it while it has the focus
                self._why.props(f'tabindex=0 aria-label="{words("why_not")}" aria-live=polite')
                with ui.element("footer").classes("controls"):
                    self._build_controls()
        self.refresh()

    def refresh(self) -> None:
        """Show what is so now; to be called ten times a second. Only what has changed is sent."""
        link, words = self._link, self._words
        session, gate, now = link.session(self._visitor), link.gate, link.clock()
        mine = gate is not None and gate.lease == session.number
        shown = dashboard(
            gate,
            words,
            stale=link.is_stale,
            mine=mine,
            holder=link.holder(),
            drives=self._visitor.may_drive,
            speed=link.speed,
            controller=link.controller,
            corrections=link.corrections_failure,
        )
        if shown != self._shown:
            self._show(shown)
        self._debouncer.show(self._places(shown), now)
        self._show_wishes(mine=mine, driving=gate is not None and bool(gate.steers))
        if session.refusal_count != self._refusal_count and session.refusal is not None:
            self._refusal_count = session.refusal_count
            cause, advice = words.cause(session.refusal)
            self._notify(words("refused", cause=cause, advice=advice))
        if session.unanswered(now):
            self._notify(words("no_answer"))
        self._announce_lost_record()
        if self._instruments.may_draw:
            self._adjusting.refresh()
            self._show_lines()
            place = self._moving()
            seen = picture(gate, link.controller, place, words, stale=link.is_stale, satellites=link.satellites)
            self._instruments.draw(seen)

    def _moving(self) -> Moving | None:
        """Return where both bodies are: by the estimate, where there is none by the receivers."""
        link, place = self._link, self._link.surveyor.shown
        if link.moving is not None or place is None or link.fixes is None:
            return link.moving
        return moving_by_hand(place, link.fixes, link.vehicle)

    def _nearest_pass(self) -> int | None:
        """Return the pass that is nearest to the tractor; None: where that is is not known."""
        place = self._moving()
        return self._lines.nearest_pass(*place.tractor) if place is not None else None

    def _announce_lost_record(self) -> None:
        """Show, once, that nothing is recorded any more: steering continues, and the list of warnings may be long."""
        gate = self._link.gate
        lost = gate is not None and bool(gate.steers) and Cause.NOT_RECORDING.value in gate.refusals
        if lost and not self._lost:
            self._notify(". ".join(self._words.cause(Cause.NOT_RECORDING)))
        self._lost = lost

    def _show_lines(self) -> None:
        """Draw the line that is driven and its neighbours, where that is another one than before."""
        controller = self._link.controller
        if controller is not None and controller.line_offset != self._offset:
            self._offset = controller.line_offset
            self._instruments.show_lines(self._lines(self._offset))

    def _notify(self, text: str) -> None:
        ui.notify(text, type="warning", position="top", timeout=6000, multi_line=True)

    def _build_bar(self, *, login: bool) -> None:
        self._bar = ui.element("header").classes("bar")
        with self._bar:
            self._symbol = ui.label().classes("symbol").props("aria-hidden=true")
            with ui.element("div").classes("words").props("role=status"):
                self._word = ui.label().classes("word").props("role=heading aria-level=1")
                self._detail = ui.label().classes("detail")
            menu(self._words, login=login, may_leave=self._may_leave)

    def _build_controls(self) -> None:
        words, ask = self._words, self._ask
        self._brake = ui.label(words("stop_vehicle")).classes("brake wide").props("role=alert")
        with ui.element("div").classes("lease"):
            self._lease = ui.label()
            self._wish = self._button("ask_control", self._wish_control, "plain")
            self._wished = ui.label()
            self._give = self._button("give_control", ask(Action.RELEASE), "plain")
        self._adjusting = Adjusting(
            self._link,
            words,
            self._send,
            speed=self._speed,
            working_width=self._working_width,
            nearest_pass=self._nearest_pass,
        )
        self._arm = self._button("arm", ask(Action.ARM), "first needs-sight")
        self._engage = self._button("engage", ask(Action.ENGAGE), "second needs-sight")
        self._acknowledge = self._button("acknowledge", ask(Action.ACKNOWLEDGE), "first wide needs-sight")
        with ui.element("div").classes("stops"):
            self._button("stop", ask(Action.STOP), "stop")
            self._button("emergency", ask(Action.EMERGENCY), "emergency")
            self._button("release", ask(Action.RELEASE), "release")

    def _button(self, key: str, act: Callable[[], None], classes: str) -> ui.button:
        return button(self._words(key), act, classes)

    def _ask(self, action: Action) -> Callable[[], None]:
        return lambda: self._send(action)

    def _send(self, action: Action, value: float = 0.0) -> None:
        now = self._link.clock()
        if action not in ALWAYS and not self._debouncer.counts(action, now):
            return
        session = self._link.session(self._visitor)
        before = session.refusal_count
        if self._link.ask(self._visitor, action, value):
            self._debouncer.ask(action, now)
        elif session.refusal_count == before:
            self._notify(self._words("too_often"))

    def _places(self, shown: Dashboard) -> dict[Action, Hashable]:
        """Return what the place of each action's button depends on: it stands above those that come and go below."""
        row = (shown.may_acknowledge, shown.steers)
        rows = (*row, self._adjusting.folded, shown.may_choose_line)
        fine = (*rows, shown.may_adjust)
        return {
            Action.ARM: row,
            Action.ACKNOWLEDGE: row,
            Action.LINE: rows,
            Action.NUDGE: fine,
            Action.SET_SPEED: fine,
        }

    def _may_leave(self) -> bool:
        """Return whether the vehicle is not steered under this visitor's eyes; show where it is."""
        gate = self._link.gate
        mine = gate is not None and gate.lease == self._link.session(self._visitor).number
        steered = mine and self._link.is_engaged and not self._link.is_stale
        if steered:
            self._notify(self._words("stay"))
        return not steered

    def _wish_control(self) -> None:
        self._link.wish(self._visitor)
        self._notify(self._words("asked_control"))

    def _show(self, shown: Dashboard) -> None:
        self._shown = shown
        self._bar.classes(replace=f"bar tone-{shown.tone}")
        self._symbol.set_text(shown.symbol)
        self._word.set_text(shown.word)
        self._detail.set_text(shown.detail)
        self._brake.set_visibility(shown.brake)
        self._lease.set_text(shown.lease)
        self._wish.set_visibility(shown.may_wish)
        self._arm.set_enabled(shown.may_arm)
        self._engage.set_enabled(shown.may_engage)
        for each in (self._arm, self._engage):
            each.set_visibility(not shown.may_acknowledge and not shown.steers)
        self._acknowledge.set_visibility(shown.may_acknowledge)
        self._adjusting.show(shown)
        self._why.set_visibility(bool(shown.reasons))
        self._why.clear()
        with self._why:
            _list(shown)

    def _show_wishes(self, *, mine: bool, driving: bool) -> None:
        names = [display_name(each.name, self._words) for each in self._link.wishes.values()] if mine else []
        text = self._words("wishes_control", name=", ".join(names)) if names else ""
        if text and driving:
            text += ". " + self._words("stop_first")
        self._wished.set_text(text)
        self._wished.set_visibility(bool(text))
        self._give.set_visibility(bool(names) and not driving)


def _list(shown: Dashboard) -> None:
    """Build the list of reasons."""
    heading(shown.heading)
    with ui.element("ol"):
        for sentence, advice in shown.reasons:
            with ui.element("li"):
                with ui.element("b"):
                    ui.label(sentence)
                with ui.element("span"):
                    ui.label(advice)

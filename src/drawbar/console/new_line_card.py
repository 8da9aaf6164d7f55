"""Card of new lines: A and B, A and a heading, or a curve that is recorded while the tractor is driven by hand."""

import math
from collections.abc import Callable

import numpy as np
from nicegui import ui

from drawbar.console.language.words import Words
from drawbar.console.link import Link
from drawbar.console.page_head import tell
from drawbar.console.widgets import button, card
from drawbar.errors import DrawbarError
from drawbar.fields.lines import from_a_and_b, from_a_and_heading
from drawbar.fields.track import Track
from drawbar.geometry import Floats

_COMPASS = 360.0


class NewLineCard:
    """Makes lines where the tractor is."""

    def __init__(self, link: Link, words: Words, keep: Callable[[str, Floats], None]) -> None:
        """Build the card; `keep` takes a new line's name and points, (n, 2) m of the drive's frame."""
        self._surveyor, self._words, self._keep = link.surveyor, words, keep
        with card(words("new_line")):
            self._name = ui.input(words("name_of_line")).props("outlined maxlength=100")
            with ui.element("div").classes("line-up"):
                self._button("set_a", self._set_a)
                self._b = self._button("set_b", self._set_b)
            with ui.element("div").classes("line-up"):
                self._heading = ui.number(words("heading"), suffix="°", min=0, max=_COMPASS, format="%.1f")
                self._heading.props("outlined")
                self._along = self._button("a_and_heading", self._set_heading)
            with ui.element("div").classes("line-up"):
                self._record = self._button("record_curve", self._begin)
                self._end = self._button("end_curve", self._finish)
                self._drop = self._button("drop_curve", self._forget)
            self._said = ui.label().classes("note").props("aria-live=polite")
        self.refresh()

    def refresh(self) -> None:
        """Show what can be done now."""
        surveyor, words = self._surveyor, self._words
        track, known = surveyor.track, surveyor.place is not None
        self._b.set_enabled(surveyor.a is not None)
        self._along.set_enabled(surveyor.a is not None)
        self._record.set_visibility(track is None)
        for each in (self._end, self._drop):
            each.set_visibility(track is not None)
        texts = [] if known else [words("no_yaw" if surveyor.is_fixed else "no_position")]
        if track is not None:
            texts.append(words("recording_points", count=len(track.points)))
            texts += [words("recording_full")] if track.is_full else []
        elif surveyor.a is not None:
            texts.append(words("a_is_set"))
        self._said.set_text(" · ".join(texts))

    def _button(self, key: str, act: Callable[[], None]) -> ui.button:
        def guarded() -> None:
            try:
                act()
            except DrawbarError as error:
                tell(self._words.message(error))
            self.refresh()

        return button(self._words(key), guarded)

    def _called(self, otherwise: str) -> str:
        return (self._name.value or "").strip() or otherwise

    def _set_a(self) -> None:
        self._surveyor.a = self._surveyor.here()

    def _set_b(self) -> None:
        line = from_a_and_b(np.array(self._surveyor.a), np.array(self._surveyor.here()))
        self._made(line)

    def _set_heading(self) -> None:
        given = self._heading.value
        self._made(from_a_and_heading(np.array(self._surveyor.a), math.radians(math.nan if given is None else given)))

    def _made(self, line: Floats) -> None:
        east, north = line[1] - line[0]
        compass = math.degrees(math.atan2(east, north)) % _COMPASS
        self._keep(self._called(f"AB {compass:.1f}°"), line)
        self._surveyor.a = None

    def _begin(self) -> None:
        self._surveyor.here()
        self._surveyor.track = Track()

    def _finish(self) -> None:
        track = self._surveyor.track
        if track is not None:
            self._keep(self._called(self._words("curve")), track.line())
            self._surveyor.track = None

    def _forget(self) -> None:
        self._surveyor.track = None

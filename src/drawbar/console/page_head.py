"""Head of every page but the drive page: its title, the state of the drive, STOP, and the menu."""

from nicegui import ui

from drawbar.console.language.words import Words
from drawbar.console.link import Link
from drawbar.console.menu import menu
from drawbar.console.view import dashboard
from drawbar.console.visitors import Visitor
from drawbar.console.widgets import button
from drawbar.messages import Action


class PageHead:
    """A bar that shows how the drive is, and stops it; everybody may."""

    def __init__(self, link: Link, visitor: Visitor, words: Words, title: str, *, login: bool) -> None:
        """Build the bar."""
        self._link, self._visitor, self._words = link, visitor, words
        with ui.element("header").classes("bar page-bar") as self._bar:
            with ui.element("div").classes("words"):
                ui.label(title).classes("word").props("role=heading aria-level=1")
                self._state = ui.label().classes("detail").props("role=status")
            button(words("stop"), self._stop, "bar-stop")
            menu(words, login=login)
        self.refresh()

    def refresh(self) -> None:
        """Show the state that is so now."""
        link = self._link
        shown = dashboard(
            link.gate,
            self._words,
            stale=link.is_stale,
            mine=False,
            holder=None,
            drives=False,
            speed=link.speed,
            controller=link.controller,
        )
        self._state.set_text(f"{shown.symbol} {shown.word}")
        self._bar.classes(replace=f"bar page-bar tone-{shown.tone}")

    def _stop(self) -> None:
        self._link.ask(self._visitor, Action.STOP)


def tell(text: str, *, good: bool = False) -> None:
    """Show a message for some seconds."""
    ui.notify(text, type="positive" if good else "warning", position="top", timeout=8000, multi_line=True)

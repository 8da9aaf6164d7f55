"""Widgets that several pages have: buttons and cards."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from nicegui import ui


def button(text: str, act: Callable[[], Any], look: str = "action") -> ui.button:
    """Return a button; look: its classes in the style sheet."""
    return ui.button(text, on_click=act, color=None).props("no-caps unelevated").classes(look)


@contextmanager
def card(title: str) -> Iterator[None]:
    """Put what is built within the context into a card, below its title."""
    with ui.element("section").classes("card"):
        heading(title)
        yield


def heading(text: str) -> None:
    """Add the heading of a section."""
    with ui.element("h2"):
        ui.label(text)

"""Menu: the pages, language, light or dark, sound; the same on every page."""

import json
from collections.abc import Callable

from nicegui import ui

from drawbar.console.language.words import Words

ADDRESSES = {"drive": "/", "fields": "/fields", "setup": "/setup", "runs": "/runs", "inside": "/inside"}
"""of the pages, by the catalogue's key of their names"""
_LOOKS = {"dark": True, "light": False}
"""by what a browser remembers (menu.js)"""


def menu(words: Words, *, login: bool, may_leave: Callable[[], bool] = lambda: True) -> None:
    """Build the button and its menu.

    Args:
        words: texts.
        login: visitors have logged in, and may log out.
        may_leave: returns whether the page may be left, and shows where not.
    """
    request = ui.context.client.request
    ui.dark_mode(_LOOKS.get(request.cookies.get("drawbar-look", "") if request is not None else ""))
    states = ", ".join(json.dumps(words(key)) for key in ("sound_on", "sound_off"))

    def leave(address: str) -> None:
        if may_leave():
            ui.navigate.to(address)

    with ui.button(icon="menu", color=None).props(f'flat round aria-label="{words("menu")}"'), ui.menu():
        for key, address in ADDRESSES.items():
            ui.menu_item(words(key), lambda address=address: leave(address)).mark(key)
        ui.separator()
        ui.menu_item(words("look"), lambda: ui.run_javascript("toggleLook()"))
        ui.menu_item(words("sound"), lambda: ui.run_javascript(f"toggleSound({states})"))
        other, here = "en" if words.language == "de" else "de", request.url.path if request is not None else ""
        ui.menu_item(words("language"), lambda: leave(f"/language/{other}?page={here}"))
        if login:
            ui.menu_item(words("logout"), lambda: leave("/logout"))

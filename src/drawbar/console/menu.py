"""Menu: the pages, language, light or dark, sound; the same on every page."""

import json

from nicegui import ui

from drawbar.console.words import Words

_PAGES = (("drive", "/"), ("fields", "/fields"), ("setup", "/setup"), ("runs", "/runs"), ("inside", "/inside"))
_LOOKS = {"dark": True, "light": False}
"""by what a browser remembers (menu.js)"""


def menu(words: Words, *, login: bool) -> None:
    """Build the button and its menu; login: there is somebody to log out."""
    request = ui.context.client.request
    ui.dark_mode(_LOOKS.get(request.cookies.get("drawbar-look", "") if request is not None else ""))
    told = ", ".join(json.dumps(words(key)) for key in ("sound_on", "sound_off"))
    with ui.button(icon="menu", color=None).props(f'flat round aria-label="{words("menu")}"'), ui.menu():
        for key, address in _PAGES:
            ui.menu_item(words(key), lambda address=address: ui.navigate.to(address))
        ui.separator()
        ui.menu_item(words("look"), lambda: ui.run_javascript("toggleLook()"))
        ui.menu_item(words("sound"), lambda: ui.run_javascript(f"toggleSound({told})"))
        other = "en" if words.language == "de" else "de"
        ui.menu_item(words("language"), lambda: ui.navigate.to(f"/language/{other}"))
        if login:
            ui.menu_item(words("logout"), lambda: ui.navigate.to("/logout"))

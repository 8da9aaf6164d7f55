"""Menu: the pages, language, light or dark, sound; the same on every page."""

from nicegui import ui

from drawbar.console.words import Words

_PAGES = (("drive", "/"), ("fields", "/fields"), ("setup", "/setup"), ("runs", "/runs"), ("inside", "/inside"))
_SOUND = "document.body.dataset.sound = document.body.dataset.sound === 'off' ? 'on' : 'off'"


def menu(words: Words, *, login: bool) -> None:
    """Build the button and its menu; login: there is somebody to log out."""
    look = ui.dark_mode(None)
    with ui.button(icon="menu", color=None).props(f'flat round aria-label="{words("menu")}"'), ui.menu():
        for key, address in _PAGES:
            ui.menu_item(words(key), lambda address=address: ui.navigate.to(address))
        ui.separator()
        ui.menu_item(words("look"), lambda: look.set_value(not look.value))
        ui.menu_item(words("sound"), lambda: ui.run_javascript(_SOUND))
        other = "en" if words.language == "de" else "de"
        ui.menu_item(words("language"), lambda: ui.navigate.to(f"/language/{other}"))
        if login:
            ui.menu_item(words("logout"), lambda: ui.navigate.to("/logout"))

"""Screenshots: drives stand-ins through the console in Chromium and takes a picture of each page, for docs and review.

`python -m drawbar.console.screenshots ADDRESS FOLDER [FIELD]` while `drawbar drive --console --port …` is on; FIELD is
a file that the fields page imports, such as a .zip of examples/field. Needs playwright and a Chromium of the
distribution.
"""

import shutil
import sys
import time
from argparse import ArgumentParser
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Locator, Page

PHONE, TABLET, DESKTOP = {"width": 360, "height": 740}, {"width": 1280, "height": 800}, {"width": 1920, "height": 1080}
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
WAIT = 90_000
"""ms"""
_AGAIN = 10_000
"""after which something is pressed again, ms"""


def chromium_path() -> str | None:
    """Return the program of a Chromium that is installed; None: there is none."""
    return next((path for name in BROWSERS if (path := shutil.which(name))), None)


def main() -> int:
    """Take all pictures."""
    from playwright.sync_api import sync_playwright

    parser = ArgumentParser(prog="python -m drawbar.console.screenshots", description=main.__doc__)
    parser.add_argument("address", help="of the console, http://…")
    parser.add_argument("folder", type=Path, help="for the pictures")
    parser.add_argument("field", nargs="?", help="file that the fields page imports")
    given = parser.parse_args()
    address, folder, fields = f"{given.address.rstrip('/')}/", given.folder, [given.field] if given.field else []
    program = chromium_path()
    if program is None:
        print(f"screenshots need one of: {', '.join(BROWSERS)}", file=sys.stderr)
        return 2
    folder.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        _take_drive(_page(browser, "en"), address, folder)
        for language in ("en", "de"):
            _take_others(_page(browser, language), address, folder, fields, language)
        browser.close()
    return 0


def _page(browser: "Browser", language: str) -> "Page":
    """Return a page of somebody who reads a language; numbers in inputs follow the browser's own."""
    return browser.new_page(viewport=TABLET, color_scheme="light", locale=language)  # type: ignore[arg-type]


def _take_drive(page: "Page", address: str, folder: Path) -> None:
    """Engage and stop on the drive page."""
    page.goto(address, timeout=WAIT)

    _see(page, "Not ready")
    _shoot(page, folder, "not-ready")
    press_until(page, word(page, "Emergency stop"), "EMERGENCY")
    _shoot(page, folder, "emergency")
    press_until(page, word(page, "Ready"), "Acknowledge")
    press_until(page, word(page, "Steering"), "1 Prepare", "2 Engage")
    page.wait_for_timeout(8000)
    _shoot(page, folder, "steering")
    press_until(page, word(page, "Stopped"), "STOP")
    page.goto(address + "language/de", timeout=WAIT)
    _see(page, "Angehalten")
    _shoot(page, folder, "stopped-german")


def _take_others(page: "Page", address: str, folder: Path, fields: list[str], language: str) -> None:
    """Open all other pages."""
    page.goto(f"{address}language/{language}", timeout=WAIT)
    page.goto(address + "fields", timeout=WAIT)
    page.locator(".word").wait_for(timeout=WAIT)
    if fields:
        page.locator("input[type=file]").set_input_files(fields)
        page.locator(".field-map .driven[points*=',']").wait_for(state="attached", timeout=WAIT)
        page.wait_for_timeout(9000)  # until the message has gone
    ending = "" if language == "en" else "-german"
    _shoot(page, folder, "fields" + ending, whole=True)
    for name in ("setup", "inside", "runs"):
        page.goto(address + name, timeout=WAIT)
        page.locator(".word").wait_for(timeout=WAIT)
        page.wait_for_timeout(3000)
        _shoot(page, folder, name + ending, whole=True)


def word(page: "Page", text: str) -> "Locator":
    """Return the word for the state of the drive, where it is this one."""
    return page.locator(".word").get_by_text(text, exact=True)


def _see(page: "Page", text: str) -> None:
    word(page, text).wait_for(timeout=WAIT)


def press_until(page: "Page", seen: "Locator", *names: str, wait: float = WAIT) -> None:
    """Press buttons one after the other, and again where that was refused, until something is seen.

    On a busy computer pictures are late, and what was seen too long ago is no ground to ask for anything.

    Args:
        page: with the buttons.
        seen: what is waited for.
        names: of the buttons.
        wait: longest, ms.

    Raises:
        TimeoutError: it is not seen; names what is.
    """
    from playwright.sync_api import TimeoutError as Late

    end = time.monotonic() + 1e-3 * wait
    while not seen.first.is_visible():
        if time.monotonic() > end:
            raise TimeoutError(page.locator("body").inner_text())
        for name in names:
            with suppress(Late):  # it may be gone or disabled by now
                page.get_by_role("button", name=name, exact=True).click(timeout=_AGAIN / len(names))
        with suppress(Late):
            seen.first.wait_for(timeout=_AGAIN)


def _shoot(page: "Page", folder: Path, name: str, *, whole: bool = False) -> None:
    """Take a page as phone, tablet and desktop show it, light and dark; whole: also with all that one scrolls to."""
    for look in ("dark", "light"):
        for device, size in (("phone", PHONE), ("tablet", TABLET), ("desktop", DESKTOP)):
            page.emulate_media(color_scheme=look)
            page.set_viewport_size(size)  # type: ignore[arg-type]
            page.wait_for_timeout(500)
            page.screenshot(path=str(folder / f"{name}-{device}-{look}.png"))
            if whole:
                page.screenshot(path=str(folder / f"{name}-{device}-{look}-whole.png"), full_page=True)


if __name__ == "__main__":
    sys.exit(main())

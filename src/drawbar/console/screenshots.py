"""Screenshots: drives stand-ins through the console in Chromium and takes a picture of each page, for docs and review.

`python -m drawbar.console.screenshots ADDRESS FOLDER` while `drawbar drive --console --port …` is on. Needs playwright
and a Chromium of the distribution.
"""

import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

PHONE, TABLET = {"width": 360, "height": 740}, {"width": 1280, "height": 800}
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
WAIT = 90_000
"""ms"""


def chromium_path() -> str | None:
    """Return the program of a Chromium that is installed; None: there is none."""
    return next((path for name in BROWSERS if (path := shutil.which(name))), None)


def main() -> int:
    """Take all pictures."""
    from playwright.sync_api import sync_playwright

    address, folder = sys.argv[1], Path(sys.argv[2])
    program = chromium_path()
    if program is None:
        print(f"screenshots need one of: {', '.join(BROWSERS)}", file=sys.stderr)
        return 2
    folder.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        _take(browser, address, folder)
        browser.close()
    return 0


def _take(browser: "Browser", address: str, folder: Path) -> None:
    operator = browser.new_page(viewport=TABLET, color_scheme="light", locale="en-GB")  # type: ignore[arg-type]
    operator.goto(address, timeout=WAIT)
    _see(operator, "Not ready")
    _all(browser, address, folder, "not-ready", operator)
    operator.get_by_role("button", name="EMERGENCY").click()
    _see(operator, "Emergency stop")
    _all(browser, address, folder, "emergency", operator)
    operator.get_by_role("button", name="Acknowledge").click()
    _see(operator, "Ready", exact=True)
    _all(browser, address, folder, "ready", operator)
    operator.get_by_role("button", name="1 Prepare").click()
    operator.get_by_role("button", name="2 Engage").click()
    _see(operator, "Steering")
    operator.wait_for_timeout(12_000)
    _all(browser, address, folder, "steering", operator)
    operator.get_by_role("button", name="STOP", exact=True).click()
    _see(operator, "Stopped")
    _all(browser, address, folder, "stopped", operator)
    _all(browser, address + "runs", folder, "runs", None)


def _see(page: "Page", word: str, *, exact: bool = False) -> None:
    page.locator(".word").get_by_text(word, exact=exact).wait_for(timeout=WAIT)


def _all(browser: "Browser", address: str, folder: Path, name: str, operator: "Page | None") -> None:
    """Take a page on phone and tablet, light and dark; the phone in the dark speaks German.

    The tablet in the light is the operator's own page; the others are opened in the same browser, and so are the same
    operator, but for the dark ones, which belong to a second.
    """
    for device, size in (("phone", PHONE), ("tablet", TABLET)):
        for look in ("light", "dark"):
            path = str(folder / f"{name}-{device}-{look}.png")
            if operator is not None and (device, look) == ("tablet", "light"):
                operator.wait_for_timeout(700)
                operator.screenshot(path=path)
                continue
            locale = "de-DE" if (device, look) == ("phone", "dark") else "en-GB"
            page = browser.new_page(viewport=size, color_scheme=look, locale=locale, device_scale_factor=2)  # type: ignore[arg-type]
            if operator is not None and look == "light":
                page.context.add_cookies(operator.context.cookies())  # type: ignore[arg-type]
            page.goto(address, timeout=WAIT)
            page.wait_for_timeout(2500)
            page.screenshot(path=path)
            page.context.close()


if __name__ == "__main__":
    sys.exit(main())

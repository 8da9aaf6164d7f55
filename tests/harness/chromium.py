"""A Chromium of the distribution for tests of pages, which are skipped where it or playwright is missing."""

from contextlib import contextmanager

import pytest

from drawbar.console.screenshots import chromium_path

LONGEST = 300.0
"""time until it is open, or a page is loaded or drawn, on a busy machine, s"""


@contextmanager
def open_chromium():
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    program = chromium_path()
    if program is None:
        pytest.skip("no Chromium is installed")
    with playwright.sync_playwright() as playing:
        browser = playing.chromium.launch(
            executable_path=program, args=["--no-sandbox", "--disable-gpu"], timeout=1e3 * LONGEST
        )
        yield browser
        browser.close()

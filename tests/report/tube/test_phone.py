"""The page of the tubes on a phone, in a real browser: nothing is cut off, and the page stays where it is."""

import io

import pytest
from chromium import LONGEST, open_chromium
from rich.console import Console

from drawbar.config import load_configuration
from drawbar.report.tube.command import show_tubes

PHONE = {"width": 360, "height": 740}
READABLE = "Array.from(document.querySelectorAll('svg text'), each => each.getBoundingClientRect().height)"


@pytest.fixture
def phone(tmp_path):
    show_tubes(Console(file=io.StringIO()), load_configuration("articulated"), tmp_path, ())
    with open_chromium() as browser:
        page = browser.new_context(viewport=PHONE, is_mobile=True).new_page()
        page.goto((tmp_path / "tube.html").as_uri(), timeout=1e3 * LONGEST)
        yield page


def test_tables_and_pictures_scroll_by_themselves_and_can_be_read(phone):
    assert phone.evaluate("[innerWidth, document.documentElement.scrollWidth]") == [360, 360]
    heights = phone.evaluate(READABLE)
    assert heights
    assert min(heights) >= 9.0  # px

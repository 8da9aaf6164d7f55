"""The pages that are printed from declarations are what the declarations say now."""

import runpy
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[1] / "docs"
PAGES = runpy.run_path(str(DOCS / "pages.py"))["PAGES"]


@pytest.mark.parametrize("page", list(PAGES))
def test_a_printed_page_is_up_to_date(page):
    written = (DOCS / page).read_text("utf-8")
    assert written == PAGES[page](), "run python docs/pages.py"


@pytest.mark.parametrize("page", list(PAGES))
def test_every_field_and_code_has_words(page):
    for line in PAGES[page]().split("\n"):
        assert not line.startswith("{"), line
